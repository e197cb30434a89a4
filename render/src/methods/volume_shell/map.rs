//! The transmittance interval map on the GPU.

use super::intervals::Division;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{MethodStep, PassDispatch, Resources};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// That of a frame.
#[derive(Clone, Debug)]
pub struct IntervalMap {
    /// `[height, width, 4]` f32: where rays enter and leave, density times length, random offset.
    pub rays: wgpu::Buffer,
    /// `[height, width, samples]` u16: the samples, in one of the encodings.
    pub samples: wgpu::Buffer,
}

/// What the march reads beside the g-buffer.
#[derive(Clone, Copy, Debug)]
pub struct Uniforms<'a> {
    /// [`Intervals`](deepshade_shaders::wgsl::uniforms::Intervals).
    pub march: &'a wgpu::Buffer,
    /// [`FrameView`](deepshade_shaders::wgsl::uniforms::FrameView) of the camera.
    pub view: &'a wgpu::Buffer,
}

impl IntervalMap {
    /// The map and the pass that makes it.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room or refuses the pass.
    pub fn step(
        division: &Division,
        to: &Resources<'_>,
        uniforms: Uniforms<'_>,
    ) -> Result<(Self, MethodStep), GpuError> {
        let (device, world) = (to.device, to.scene()?);
        let shader = match division.is_wide {
            true => Shader::at("methods/volume-shell/intervals"),
            false => Shader::at("methods/volume-shell/paper_intervals"),
        };
        let constants = [("SAMPLES", division.samples as u32), ("MEDIUM", world.medium.kind)];
        let pass = device.pass(shader, &constants)?;
        let [height, width] = to.size();
        let rays = gpu::empty::<[f32; 4]>(device, "volume-shell.rays", height * width)?;
        let count = division.samples * height * width;
        let samples = gpu::empty::<u16>(device, "volume-shell.samples", count)?;
        let MediumOnGpu { record, densities, .. } = &world.medium;
        let [valid, position] = to.seen([Attribute::Valid, Attribute::Position]);
        let bound = pass.bind(
            device,
            &[
                uniforms.march.as_entire_binding(),
                uniforms.view.as_entire_binding(),
                record.as_entire_binding(),
                wgpu::BindingResource::TextureView(densities),
                valid.as_entire_binding(),
                position.as_entire_binding(),
                rays.as_entire_binding(),
                samples.as_entire_binding(),
            ],
        )?;
        let step = PassDispatch { pass: bound, workgroups: to.whole().into() };
        let writes = vec![rays.clone(), samples.clone()];
        Ok((Self { rays, samples }, MethodStep { step, writes }))
    }
}
