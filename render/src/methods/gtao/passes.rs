//! What runs on the GPU: the march, the blur along rows, the blur along columns.

use crate::methods::blur::Blur;
use crate::screen::{GpuGBuffer, Step};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};
use deepshade_shaders::{Attribute, Effect};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    occlusion: Pass,
    blur: Blur,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let occlusion = Pass::new(device, wgsl::GTAO_OCCLUSION.name, &wgsl::GTAO_OCCLUSION.source())?;
        Ok(Self { occlusion, blur: Blur::new(device, Effect::Ao)? })
    }

    /// The passes bound to a g-buffer. They write openness, `[1, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        uniforms: &[wgpu::Buffer],
        openness: &wgpu::Buffer,
    ) -> Result<Vec<Step>, GpuError> {
        let surface = [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let buffers = [&[&uniforms[0]], &surface[..], &[openness]].concat();
        let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let occlusion = Step { pass: self.occlusion.bind(device, &resources)?, workgroups };
        let [rows, columns] = self.blur.steps(device, gbuffer, [&uniforms[1], &uniforms[2]], openness)?;
        Ok(vec![occlusion, rows, columns])
    }
}
