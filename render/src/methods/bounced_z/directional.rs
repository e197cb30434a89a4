//! Directional occlusion by a bounced z-buffer: light of the environment from directions in which no surfel
//! is near.
//!
//! Few directions meet much or little of a bright part of the sky by chance, whatever hides it. So what is
//! seen of the light in a pixel's directions and its neighbours' is taken as a share of all light in them,
//! and that of the irradiance that an open surface has. Where nothing is hidden nothing is noise.

use super::passes::{Arrives, Rays, TracedRays};
use super::reference::{Arriving, PixelRay, shade};
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

/// Less light is none.
const LEAST: f32 = 1e-30;

/// The effect `do`.
pub const DIRECTIONAL: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Do,
    attributes: SURFACE,
    lit: None,
    passes: Rays {
        trace: Shader::at("methods/bounced-z/trace"),
        arrives: Arrives::OfEnvironment { reflected: false },
        filter: Shader::at("methods/bounced-z/filter"),
    },
    plain,
    on_processor: None,
};

/// Light of the environment along pixels' rays.
#[derive(Debug)]
pub struct SkyAtOnce {
    /// What is seen of it, and all, radiance as `pack_radiance` has it, `[directions, height, width]`.
    along_rays: [wgpu::Buffer; 2],
    /// The environment's irradiance over pi for every normal.
    open: wgpu::Buffer,
}

impl SkyAtOnce {
    /// It, and the pass that makes it of what the rays meet; `view` is the camera's, and the maps are of
    /// [`Sky::upload`].
    ///
    /// # Errors
    /// If the device has no room, or refuses the pass.
    pub fn new(
        traced: &TracedRays<'_>,
        view: &wgpu::Buffer,
        [sky, open]: [&wgpu::Buffer; 2],
        to: &Resources<'_>,
    ) -> Result<(Self, MethodStep), GpuError> {
        let device = to.device;
        let radiance = || gpu::empty::<u32>(device, "bounced-z.radiance", traced.count);
        let along_rays = [radiance()?, radiance()?];
        let arrive = device.pass(Shader::at("methods/bounced-z/environment"), &[])?;
        let reads = [view, sky, &traced.directions, &traced.met];
        let writes = along_rays.each_ref();
        let step = MethodStep::bind(device, &arrive, groups(traced.count), &reads, &writes)?;
        Ok((Self { along_rays, open: open.clone() }, step))
    }

    /// The passes that make the image of it, or add it to what is there if there is `other` light.
    ///
    /// # Errors
    /// If the device has no room, or refuses a pass.
    pub fn image_steps(
        &self,
        traced: &TracedRays<'_>,
        view: &wgpu::Buffer,
        other: bool,
        to: &Resources<'_>,
    ) -> Result<[MethodStep; 3], GpuError> {
        let Self { along_rays: [seen, whole], open } = self;
        let channels = Effect::Do.channels() * to.size().iter().product::<usize>();
        let image = || gpu::empty::<f32>(to.device, "bounced-z.image", channels);
        let [seen_image, whole_image] = [image()?, image()?];
        let share = to.device.pass(Shader::at("methods/bounced-z/share"), &[("OTHER", u32::from(other))])?;
        let [_, normal, valid] = traced.surface;
        let reads = [view, normal, valid, open, &seen_image, &whole_image];
        Ok([
            traced.filtered(to, seen, &seen_image)?,
            traced.filtered(to, whole, &whole_image)?,
            MethodStep::bind(to.device, &share, to.whole(), &reads, &[to.output])?,
        ])
    }
}

fn plain(plain: &Plain<'_, BouncedZParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    Ok(light_of_sky(plain, disks, (&Sky::new(plain.environment), Effect::Do)))
}

/// The image in plain Rust, of disks as wide as an effect has them.
pub fn light_of_sky(
    plain: &Plain<'_, BouncedZParameters>,
    disks: &[Disk],
    (sky, effect): (&Sky, Effect),
) -> Planes {
    let camera = &plain.view.camera;
    let radiance = |direction: Vec3| sky.blocked.radiance(camera.rotation * direction);
    let seen = |met: Option<&Disk>, ray: &PixelRay| match met {
        Some(_) => Vec3::ZERO,
        None => radiance(ray.direction),
    };
    let whole = |_: Option<&Disk>, ray: &PixelRay| radiance(ray.direction);
    let matte = Matte::all_over(plain.surface);
    let image = |of: &(dyn Fn(Option<&Disk>, &PixelRay) -> Vec3 + Sync)| {
        let arriving = Arriving { effect, of };
        shade(plain.surface, &matte, disks, &arriving, (plain.parameters, plain.view))
    };
    let (seen, whole) = (image(&seen), image(&whole));
    plain.surface.image(0.0, |at| {
        let of =
            |image: &Planes| Vec3::from_array([0, 1, 2].map(|c| image.at(c, at.y as usize, at.x as usize)));
        let open = sky.open.radiance(camera.rotation * plain.surface.normal_at(at));
        (open * of(&seen) / of(&whole).max(Vec3::splat(LEAST))).to_array()
    })
}
