//! The edge-keeping blur that removes the noise of random samples: a Gaussian along rows, then along columns, whose
//! weights fade with a neighbour's distance from the pixel's tangent plane.
//!
//! The bilateral filter of Bavoil, Sainz and Dimitrov 2008, with the plane in place of the depth, so that slanted
//! surfaces are blurred like others. Limits: surfaces in one plane are blurred into each other, and a normal map is not
//! seen.

#[cfg(test)]
mod tests;
pub mod vector;

use super::Surface;
use crate::screen::{GpuGBuffer, MethodStep, View};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::IVec2;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Parameters {
    /// Pixels on either side that are blurred together; 0 is no blur.
    #[schemars(range(min = 0, max = 32), extend("unit" = "pixels"))]
    pub radius: u32,
    /// How much distance from the tangent plane weakens the blur: a neighbour one radius of the effect off the plane has
    /// the weight `exp(-sharpness^2)`.
    #[schemars(range(min = 0.0, max = 65536.0))]
    pub sharpness: f32,
}

impl Parameters {
    /// What the passes along rows and along columns read, for an effect that has a background.
    pub fn settings(&self, view: &View, effect: Effect) -> [uniforms::Blur; 2] {
        let sigma = 0.5 * (self.radius as f32 + 1.0);
        let along = |step_x, step_y| uniforms::Blur {
            width: view.width as u32,
            height: view.height as u32,
            step_x,
            step_y,
            radius: self.radius as i32,
            falloff: 0.5 / (sigma * sigma),
            // Of an effect that reaches nowhere it would be infinite.
            sharpness: (self.sharpness / view.radius).min(1e18),
            background: effect.background().unwrap_or(0.0),
        };
        [along(1, 0), along(0, 1)]
    }
}

/// The compiled pass.
#[derive(Clone, Debug)]
pub struct Blur {
    pass: Pass,
    channels: usize,
}

impl Blur {
    /// Compiles the pass for images of so many channels.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn new(device: &wgpu::Device, channels: usize) -> Result<Self, GpuError> {
        let source = wgsl::BLUR.specialised(&[("CHANNELS", channels as u32)]);
        Ok(Self { pass: Pass::new(device, wgsl::BLUR.name, &source)?, channels })
    }

    /// Blurs `image`, `[channels, height, width]`, along rows and then along columns.
    ///
    /// # Errors
    /// If the device has no room for what lies between.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        [rows, columns]: [&wgpu::Buffer; 2],
        image: &wgpu::Buffer,
    ) -> Result<[MethodStep; 2], GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let half_blurred = gpu::empty::<f32>(device, "blur.half_blurred", self.channels * height * width)?;
        let valid = gbuffer.buffer(Attribute::Valid);
        self.steps_between(device, gbuffer, valid, [rows, columns], &half_blurred, image)
    }

    /// As [`Blur::steps`], only among pixels of which a mask, `[1, height, width]`, says the same and not 0, and with the caller's
    /// room for what lies between the two.
    ///
    /// # Errors
    /// If the device refuses a binding.
    pub fn steps_between(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        mask: &wgpu::Buffer,
        [rows, columns]: [&wgpu::Buffer; 2],
        half_blurred: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<[MethodStep; 2], GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let [position, normal] = [Attribute::Position, Attribute::Normal].map(|a| gbuffer.buffer(a));
        let surface = [position, normal, mask];
        let workgroups = gpu::groups(height, width, TILE);
        let step = |uniform: &wgpu::Buffer, from: &wgpu::Buffer, to: &wgpu::Buffer| {
            let reads = [&[uniform], &surface[..], &[from]].concat();
            MethodStep::bind(device, &self.pass, workgroups, &reads, &[to])
        };
        Ok([step(rows, image, half_blurred)?, step(columns, half_blurred, image)?])
    }
}

/// The blur of `image`, `[channels, height, width]` with one, three or twelve channels, along rows, and of that along columns:
/// what [`Blur::steps`] makes.
pub fn smooth(surface: &Surface, [rows, columns]: &[uniforms::Blur; 2], image: &Planes) -> [Planes; 2] {
    let along_rows = along(surface, rows, image);
    let along_both = along(surface, columns, &along_rows);
    [along_rows, along_both]
}

/// One direction of the blur: `smooth.wgsl`.
fn along(surface: &Surface, blur: &uniforms::Blur, noisy: &Planes) -> Planes {
    match noisy.channels() {
        1 => surface.image(blur.background, |centre| smoothed::<1>(surface, blur, noisy, centre)),
        3 => surface.image(blur.background, |centre| smoothed::<3>(surface, blur, noisy, centre)),
        12 => surface.image(blur.background, |centre| smoothed::<12>(surface, blur, noisy, centre)),
        other => unreachable!("no method blurs {other} channels"),
    }
}

fn smoothed<const CHANNELS: usize>(
    surface: &Surface,
    blur: &uniforms::Blur,
    noisy: &Planes,
    centre: IVec2,
) -> [f32; CHANNELS] {
    let position = surface.position_at(centre);
    let normal = surface.normal_at(centre);
    let mut sums = [0.0; CHANNELS];
    let mut weights = 0.0;
    for i in -blur.radius..=blur.radius {
        let at = centre + i * IVec2::new(blur.step_x, blur.step_y);
        if !surface.contains(at) || !surface.is_alike(at, centre) {
            continue;
        }
        let off_plane = blur.sharpness * normal.dot(surface.position_at(at) - position);
        let weight = (-(blur.falloff * (i * i) as f32 + off_plane * off_plane)).exp();
        for (c, sum) in sums.iter_mut().enumerate() {
            *sum += weight * noisy.at(c, at.y as usize, at.x as usize);
        }
        weights += weight;
    }
    sums.map(|sum| sum / weights)
}
