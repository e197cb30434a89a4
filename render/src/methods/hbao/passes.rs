//! What runs on the GPU: the march, the blur along rows, the blur along columns.

use super::{Settings, Surface};
use crate::method::Repeats;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu, GpuError, Pass, Timing};
use deepshade_shaders::wgsl::{self, TILE};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    occlusion: Pass,
    blur: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let compile = |shader: &wgsl::Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self { occlusion: compile(&wgsl::HBAO_OCCLUSION)?, blur: compile(&wgsl::HBAO_BLUR)? })
    }

    /// Openness, `[1, height, width]`, and how long the passes took.
    ///
    /// # Errors
    /// If the device has no room for the surface or fails.
    pub fn shade(
        &self,
        gpu: &Gpu,
        surface: &Surface,
        settings: &Settings,
        repeats: Repeats,
    ) -> Result<(Planes, Timing), GpuError> {
        let Gpu { device, queue, .. } = gpu;
        let (height, width) = (surface.height, surface.width);
        let position = gpu::storage(device, "hbao.position", surface.position.data())?;
        let normal = gpu::storage(device, "hbao.normal", surface.normal.data())?;
        let valid = gpu::storage(device, "hbao.valid", surface.valid.data())?;
        let march = gpu::uniform(device, "hbao.settings", &settings.occlusion)?;
        let along_rows = gpu::uniform(device, "hbao.blur_rows", &settings.blurs[0])?;
        let along_columns = gpu::uniform(device, "hbao.blur_columns", &settings.blurs[1])?;
        // Each [1, height, width]; the second blur writes where the march wrote.
        let openness = gpu::empty::<f32>(device, "hbao.openness", height * width)?;
        let half_blurred = gpu::empty::<f32>(device, "hbao.half_blurred", height * width)?;

        let bind = |pass: &Pass, uniform: &wgpu::Buffer, planes: &[&wgpu::Buffer]| {
            let buffers = [&[uniform, &position, &normal, &valid], planes].concat();
            let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
            pass.bind(device, &resources)
        };
        let passes = [
            bind(&self.occlusion, &march, &[&openness])?,
            bind(&self.blur, &along_rows, &[&openness, &half_blurred])?,
            bind(&self.blur, &along_columns, &[&half_blurred, &openness])?,
        ];
        let groups = gpu::groups(height, width, TILE);
        let timing = gpu::time(device, queue, "hbao", repeats.warm_up, repeats.timed, |encoder| {
            for pass in &passes {
                pass.dispatch(encoder, groups);
            }
        })?;
        let image = gpu::read(device, queue, &openness)?;
        Ok((Planes::from_data(1, height, width, image), timing))
    }
}
