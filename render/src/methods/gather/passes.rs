//! What runs on the GPU: the areas that pixels show, then the gather.

use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    areas: Pass,
    gather: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let compile = |shader: &wgsl::Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self { areas: compile(&wgsl::GATHER_AREAS)?, gather: compile(&wgsl::GATHER_GATHER)? })
    }

    /// The passes bound to a g-buffer. They write radiance, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        settings: &wgpu::Buffer,
        scattered: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        // [1, height, width]
        let areas = gpu::empty::<f32>(device, "gather.areas", height * width)?;
        let [light, valid, position, length] =
            [Attribute::Light, Attribute::Valid, Attribute::Position, Attribute::MeanFreePath]
                .map(|a| gbuffer.buffer(a));
        let workgroups = gpu::groups(height, width, TILE);
        let step = |pass: &Pass, reads: &[(u32, &wgpu::Buffer)], writes: (u32, &wgpu::Buffer)| {
            MethodStep::bind_at(device, pass, workgroups, reads, &[writes])
        };
        Ok(vec![
            step(&self.areas, &[(0, settings), (2, valid), (3, position)], (5, &areas))?,
            step(
                &self.gather,
                &[(0, settings), (1, light), (2, valid), (3, position), (4, length), (5, &areas)],
                (6, scattered),
            )?,
        ])
    }
}
