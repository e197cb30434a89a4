//! What runs on the GPU: luma, then the blend along edges.

use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    luma: Pass,
    smooth: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let compile = |shader: &wgsl::Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self { luma: compile(&wgsl::FXAA_LUMA)?, smooth: compile(&wgsl::FXAA_SMOOTH)? })
    }

    /// The passes bound to a g-buffer. They write radiance, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        uniforms: &[wgpu::Buffer],
        smoothed: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        // [1, height, width]
        let luma = gpu::empty::<f32>(device, "fxaa.luma", height * width)?;
        let [light, valid] = [Attribute::Light, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let [settings, lengths] = uniforms else { unreachable!("the method has two uniform buffers") };
        let workgroups = gpu::groups(height, width, TILE);
        let step = |pass: &Pass, reads: &[&wgpu::Buffer], to: &wgpu::Buffer| {
            MethodStep::bind(device, pass, workgroups, reads, &[to])
        };
        Ok(vec![
            step(&self.luma, &[settings, light, valid], &luma)?,
            step(&self.smooth, &[settings, light, valid, &luma, lengths], smoothed)?,
        ])
    }
}
