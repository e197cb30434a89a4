//! What runs on the GPU: the march, the blur along rows, the blur along columns.

use crate::methods::blur::Blur;
use crate::methods::environment_map::EnvironmentMap;
use crate::screen::{GpuGBuffer, Step};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};
use deepshade_shaders::{Attribute, Effect};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    light: Pass,
    blur: Blur,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let light = Pass::new(device, wgsl::SSDO_LIGHT.name, &wgsl::SSDO_LIGHT.source())?;
        Ok(Self { light, blur: Blur::new(device, Effect::Do)? })
    }

    /// The passes bound to a g-buffer. They write irradiance over pi, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for the environment and what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        environment: &EnvironmentMap,
        uniforms: &[wgpu::Buffer],
        irradiance: &wgpu::Buffer,
    ) -> Result<Vec<Step>, GpuError> {
        let texels: Vec<[f32; 4]> = environment.padded().collect();
        let environment = gpu::storage(device, "ssdo.environment", &texels)?;
        let surface = [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let buffers = [&[&uniforms[0]], &surface[..], &[&environment, irradiance]].concat();
        let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let light = Step { pass: self.light.bind(device, &resources)?, workgroups };
        let [rows, columns] = self.blur.steps(device, gbuffer, [&uniforms[1], &uniforms[2]], irradiance)?;
        Ok(vec![light, rows, columns])
    }
}
