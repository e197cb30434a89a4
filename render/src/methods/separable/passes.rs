//! What runs on the GPU: the blur along rows, the blur along columns.

use super::MOST_TAPS;
use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};

/// The compiled pass.
#[derive(Clone, Debug)]
pub struct Passes {
    blur: Pass,
}

impl Passes {
    /// Compiles it.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let shader = &wgsl::SEPARABLE_BLUR;
        let source = shader.specialised(&[("MOST_TAPS", MOST_TAPS as u32)]);
        Ok(Self { blur: Pass::new(device, shader.name, &source)? })
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
        scattered: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        // [3, height, width]
        let half_blurred = gpu::empty::<f32>(device, "separable.half_blurred", 3 * height * width)?;
        let [light, valid, position, mean_free_path] =
            [Attribute::Light, Attribute::Valid, Attribute::Position, Attribute::MeanFreePath]
                .map(|a| gbuffer.buffer(a));
        let [rows, columns, taps] = uniforms else { unreachable!("the method has three uniform buffers") };
        let workgroups = gpu::groups(height, width, TILE);
        let step = |settings: &wgpu::Buffer, from: &wgpu::Buffer, to: &wgpu::Buffer| {
            let reads = [settings, from, valid, position, mean_free_path, taps];
            MethodStep::bind(device, &self.blur, workgroups, &reads, &[to])
        };
        Ok(vec![step(rows, light, &half_blurred)?, step(columns, &half_blurred, scattered)?])
    }
}
