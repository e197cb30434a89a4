//! Light of the environment that surfaces receive, at once or reflected by others before: a part of
//! [`composed`](crate::methods::composed).

use super::bounces::light_of_path;
use super::directional::{DIRECTIONAL, light_of_sky};
use super::passes::{Arrives, Rays};
use super::reference::{Arriving, PixelRay, shade};
use super::{BouncedZParameters, Matte};
use crate::methods::disks::{DiskEffect, Plain};
use crate::methods::surfel::directional::Sky;
use crate::raster::patches::{self, Reflectance};
use crate::surfels::reference::Disk;
use deepshade_shaders::{Effect, MissingAttribute, Planes};
use glam::Vec3;

/// It, as a method of `gi`: disks are as wide as for other light, since what comes through holes from as far
/// as the sky is much.
pub const SKY_LIGHT: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Gi,
    passes: Rays { arrives: Arrives::OfEnvironment { reflected: true }, ..DIRECTIONAL.passes },
    plain,
    ..DIRECTIONAL
};

/// The image in plain Rust.
fn plain(plain: &Plain<'_, BouncedZParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    let (sky, view, effect) = (Sky::new(plain.environment), plain.view, SKY_LIGHT.effect);
    let bounces = plain.parameters.bounces(effect, view);
    let patches = patches::of_scene(plain.scene.scene(), Reflectance::All);
    let radiance = |direction: Vec3| sky.blocked.radiance(view.camera.rotation * direction);
    let reflected = |met: Option<&Disk>, ray: &PixelRay| {
        let light = |disk| light_of_path(&bounces, (disks, &patches), &radiance, ray, disk);
        met.map_or(Vec3::ZERO, light)
    };
    let (matte, arriving) = (Matte::all_over(plain.surface), Arriving { effect, of: &reflected });
    let mut image = shade(plain.surface, &matte, disks, &arriving, (plain.parameters, view));
    let at_once = light_of_sky(plain, disks, (&sky, effect));
    image.data_mut().iter_mut().zip(at_once.data()).for_each(|(sum, part)| *sum += part);
    Ok(image)
}
