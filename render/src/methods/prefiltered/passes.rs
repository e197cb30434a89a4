//! What runs on the GPU: one pass that looks up what the CPU filtered.

use super::Filtered;
use super::filter::LEVELS;
use super::lobe::{ANGLES, EXPONENTS};
use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};

/// What the pass reads, in the order of its bindings.
pub const ATTRIBUTES: [Attribute; 6] = [
    Attribute::WorldNormal,
    Attribute::ToCamera,
    Attribute::Diffuse,
    Attribute::Specular,
    Attribute::Glossiness,
    Attribute::Valid,
];

/// The compiled pass.
#[derive(Clone, Debug)]
pub struct Passes {
    shade: Pass,
}

impl Passes {
    /// Compiles it.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let sizes = [("LEVELS", LEVELS), ("EXPONENTS", EXPONENTS), ("ANGLES", ANGLES)];
        let source = wgsl::PREFILTERED_SHADE.specialised(&sizes.map(|(name, size)| (name, size as u32)));
        Ok(Self { shade: Pass::new(device, wgsl::PREFILTERED_SHADE.name, &source)? })
    }

    /// The pass bound to a g-buffer and an environment. It writes radiance, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for the environment.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        environment: &Filtered,
        uniform: &wgpu::Buffer,
        radiance: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let environment = gpu::storage(device, "prefiltered.environment", &packed(environment))?;
        let attributes = ATTRIBUTES.map(|attribute| gbuffer.buffer(attribute));
        let reads = [&[uniform], &attributes[..], &[&environment]].concat();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        Ok(vec![MethodStep::bind(device, &self.shade, workgroups, &reads, &[radiance])?])
    }
}

/// First texel and height of each map, the table of lobes, the maps' texels: one buffer, since a stage may have eight.
fn packed(environment: &Filtered) -> Vec<[f32; 4]> {
    let mut first = LEVELS + EXPONENTS * ANGLES;
    let mut packed = Vec::new();
    for map in &environment.maps {
        // Whole numbers below 2^24, which floats hold.
        packed.push([first as f32, map.height() as f32, 0.0, 0.0]);
        first += map.texels().len();
    }
    packed.extend(environment.table.iter().map(|lobe| lobe.extend(0.0).to_array()));
    packed.extend(environment.maps.iter().flat_map(|map| map.padded()));
    packed
}
