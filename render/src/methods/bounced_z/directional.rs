//! Directional occlusion by a bounced z-buffer: light of the environment from directions in which no surfel
//! is near.
//!
//! Few directions meet much or little of a bright part of the sky by chance, whatever hides it. So what is
//! seen of the light in a pixel's directions and its neighbours' is taken as a share of all light in them, and
//! that of the irradiance that an open surface has. Where nothing is hidden nothing is noise.

use super::passes::{Arrives, Rays, TracedRays};
use super::reference::{Arriving, shade};
use super::{BouncedZParameters, Matte};
use crate::methods::disks::{DiskEffect, Plain, SURFACE};
use crate::methods::surfel::directional::Sky;
use crate::raster::groups;
use crate::screen::{MethodStep, Resources};
use crate::surfels::reference::Disk;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Effect, MissingAttribute, Planes};
use glam::Vec3;

/// The effect `do`.
pub const DIRECTIONAL: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Do,
    attributes: SURFACE,
    lit: None,
    passes: Rays {
        trace: Shader::at("methods/bounced-z/trace"),
        arrives: Arrives::OfEnvironment,
        filter: Shader::at("methods/bounced-z/filter"),
    },
    plain,
    on_processor: None,
};

/// The passes from what rays have met to the image; `view` is the camera's.
///
/// # Errors
/// If the device has no room for what lies between them, or refuses a pass.
pub fn steps(
    traced: &TracedRays<'_>,
    view: &wgpu::Buffer,
    to: &Resources<'_>,
) -> Result<Vec<MethodStep>, GpuError> {
    let device = to.device;
    let [sky, open] = Sky::new(to.environment).upload(device)?;
    let whole = gpu::empty::<u32>(device, "bounced-z.whole", traced.count)?;
    let channels = Effect::Do.channels() * to.size().iter().product::<usize>();
    let all = gpu::empty::<f32>(device, "bounced-z.all", channels)?;
    let arrive = device.pass(Shader::at("methods/bounced-z/environment"), &[])?;
    let share = device.pass(Shader::at("methods/bounced-z/share"), &[])?;
    let [_, normal, valid] = traced.surface;
    let reads = [view, &sky, &traced.directions];
    Ok(vec![
        MethodStep::bind(device, &arrive, groups(traced.count), &reads, &[&traced.arrived, &whole])?,
        traced.filtered(to, &traced.arrived, to.output)?,
        traced.filtered(to, &whole, &all)?,
        MethodStep::bind(device, &share, to.whole(), &[view, normal, valid, &open, &all], &[to.output])?,
    ])
}

/// The image in plain Rust.
fn plain(plain: &Plain<'_, BouncedZParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    let (sky, camera) = (Sky::new(plain.environment), &plain.view.camera);
    let radiance = |direction: Vec3| sky.blocked.radiance(camera.rotation * direction);
    let seen = |met: Option<&Disk>, direction| if met.is_some() { Vec3::ZERO } else { radiance(direction) };
    let all = |_: Option<&Disk>, direction| radiance(direction);
    let matte = Matte::all_over(plain.surface);
    let image = |of: &(dyn Fn(Option<&Disk>, Vec3) -> Vec3 + Sync)| {
        let arriving = Arriving { effect: Effect::Do, of };
        shade(plain.surface, &matte, disks, &arriving, (plain.parameters, plain.view))
    };
    let (seen, all) = (image(&seen), image(&all));
    Ok(plain.surface.image(0.0, |at| {
        let of =
            |image: &Planes| Vec3::from_array([0, 1, 2].map(|c| image.at(c, at.y as usize, at.x as usize)));
        let open = sky.open.radiance(camera.rotation * plain.surface.normal_at(at));
        (open * of(&seen) / of(&all).max(Vec3::splat(f32::MIN_POSITIVE))).to_array()
    }))
}
