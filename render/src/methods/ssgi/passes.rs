//! What runs on the GPU: the march, the blur along rows, the blur along columns.

use crate::methods::blur::Blur;
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
        let light = Pass::new(device, wgsl::SSGI_LIGHT.name, &wgsl::SSGI_LIGHT.source())?;
        Ok(Self { light, blur: Blur::new(device, Effect::Gi)? })
    }

    /// The passes bound to a g-buffer. They write irradiance over pi, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        uniforms: &[wgpu::Buffer],
        indirect: &wgpu::Buffer,
    ) -> Result<Vec<Step>, GpuError> {
        let read = [Attribute::Position, Attribute::Normal, Attribute::Valid, Attribute::DiffuseLight];
        let read = read.map(|attribute| gbuffer.buffer(attribute));
        let buffers = [&[&uniforms[0]], &read[..], &[indirect]].concat();
        let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let light = Step { pass: self.light.bind(device, &resources)?, workgroups };
        let [rows, columns] = self.blur.steps(device, gbuffer, [&uniforms[1], &uniforms[2]], indirect)?;
        Ok(vec![light, rows, columns])
    }
}
