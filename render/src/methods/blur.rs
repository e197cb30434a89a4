//! The edge-keeping blur that removes the noise of random samples: a Gaussian along rows, then along columns,
//! whose weights fade with a neighbour's distance from the pixel's tangent plane.
//!
//! The bilateral filter of Bavoil, Sainz and Dimitrov 2008, with the plane in place of the depth, so that
//! slanted surfaces are blurred like others. Limits: surfaces in one plane are blurred into each other, and a
//! normal map is not seen.

#[cfg(test)]
mod tests;
pub mod vector;

use super::Surface;
use crate::screen::{Device, GpuGBuffer, MethodStep, View, host};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::host::{Extent, HostBinding, HostPass};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::IVec2;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct BlurParameters {
    /// Pixels on either side that are blurred together; 0 is no blur.
    #[schemars(range(min = 0, max = 32), extend("unit" = "pixels"))]
    pub radius: u32,
    /// How much distance from the tangent plane weakens the blur: a neighbour one radius of the effect off
    /// the plane has the weight `exp(-sharpness^2)`.
    #[schemars(range(min = 0.0, max = 65536.0))]
    pub sharpness: f32,
}

impl BlurParameters {
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

/// What is blurred.
#[derive(Clone, Copy, Debug)]
pub struct Blurred<'a> {
    /// `[channels, height, width]`.
    pub image: &'a wgpu::Buffer,
    /// Its channels.
    pub channels: usize,
    /// Room of the same size.
    pub half_blurred: &'a wgpu::Buffer,
    /// `[1, height, width]`: what is blurred together is the same here, and not 0.
    pub mask: &'a wgpu::Buffer,
}

/// The passes that blur an image along rows and then along columns.
///
/// # Errors
/// If the device refuses the pass or a binding.
pub fn steps(
    device: &Device,
    gbuffer: &GpuGBuffer,
    Blurred { image, channels, half_blurred, mask }: Blurred<'_>,
    [rows, columns]: [&wgpu::Buffer; 2],
) -> Result<[MethodStep; 2], GpuError> {
    let pass = device.pass(Shader::at("methods/blur/smooth"), &[("CHANNELS", channels as u32)])?;
    let [position, normal] = [Attribute::Position, Attribute::Normal].map(|a| gbuffer.buffer(a));
    let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
    let step = |uniform: &wgpu::Buffer, from: &wgpu::Buffer, to: &wgpu::Buffer| {
        MethodStep::bind(device, &pass, workgroups, &[uniform, position, normal, mask, from], &[to])
    };
    Ok([step(rows, image, half_blurred)?, step(columns, half_blurred, image)?])
}

/// The buffer between the two passes of [`host_passes`].
pub const HALF_BLURRED: &str = "half_blurred";

/// The two passes as an engine runs them from files, from one buffer of an effect's image to another.
pub fn host_passes(blur: &BlurParameters, effect: Effect, from: &str, to: &str) -> Option<[HostPass; 2]> {
    let source = Shader::at("methods/blur/smooth").specialised(&[("CHANNELS", effect.channels() as u32)]);
    let pass = |name: &str, index: usize, from: &str, to: &str| {
        let layout = &uniforms::Blur::LAYOUT;
        let told =
            host::values(layout, |view| bytemuck::bytes_of(&blur.settings(view, effect)[index]).to_vec())?;
        let mut pass =
            HostPass::new(name, source.clone(), Extent::IMAGE, TILE).told(layout, |field| told[field]);
        for (binding, attribute) in (1..).zip([Attribute::Position, Attribute::Normal, Attribute::Valid]) {
            pass = pass.bind(binding, HostBinding::read(attribute.name()));
        }
        Some(pass.bind(4, HostBinding::read(from)).bind(5, HostBinding::written(to)))
    };
    Some([pass("blur_rows", 0, from, HALF_BLURRED)?, pass("blur_columns", 1, HALF_BLURRED, to)?])
}

/// The blur of `image`, `[channels, height, width]` with one, three or twelve channels, along rows, and of
/// that along columns: what [`steps`] makes.
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
