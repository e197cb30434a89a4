//! The bounced z-buffer of a medium in plain Rust: every ray against every disk, without a tree, and the
//! filter.

use super::{FogRaysParameters, LIGHT, SAMPLES, far_reaching};
use crate::bvh::TracedScene;
use crate::methods::bounced_z::reference::{self, IN_SQUARE, SQUARE, number_in_square, place_on_disk};
use crate::methods::surfel::reference::sent;
use crate::methods::volume_shell::intervals::{Ray, mean_transmittance};
use crate::methods::volume_shell::reference::Sight;
use crate::path::medium::{HenyeyGreenstein, Segment};
use crate::scene::Medium;
use crate::screen::View;
use crate::surfels::reference::{Disk, laid};
use deepshade_shaders::random::{hash, random};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{GBuffer, MissingAttribute, Planes};
use glam::{IVec2, UVec2, Vec3};
use rayon::prelude::*;

/// One over the root of x^4 = x + 1.
const STEP: f32 = 0.819_172_5;

/// A place on a view ray.
struct Place {
    /// From the eye, metres.
    distance: f32,
    /// Density times length before it.
    passed: f32,
}

/// What a ray has brought.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Of the place where it starts from the eye, metres.
    distance: f32,
    /// Radiance that comes from there, were the transmittance's whole loss 1.
    arrived: Vec3,
}

/// A pixel's view ray and its samples.
struct Traced {
    ray: Ray,
    samples: Vec<Sample>,
}

/// What rays are traced through.
struct Tracing<'a> {
    medium: &'a Medium,
    disks: &'a [Disk],
    parameters: &'a FogRaysParameters,
    bounces: uniforms::Bounces,
    view: &'a View,
}

/// The image of a scene's surfels, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &FogRaysParameters,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let Some(medium) = scene.scene().medium.as_deref() else {
        return Ok(Planes::filled(3, height, width, 0.0));
    };
    let disks = laid(scene, &parameters.density(view), &far_reaching(view), Some(LIGHT));
    let (sight, bounces) = (Sight::new(gbuffer, view)?, parameters.bounces(view));
    let tracing = Tracing { medium, disks: &disks, parameters, bounces, view };
    let pixel = |index: usize| UVec2::new((index % width) as u32, (index / width) as u32);
    let traced = |index: usize| tracing.traced(sight.of(pixel(index)), pixel(index));
    let traced: Vec<Traced> = (0..height * width).into_par_iter().map(traced).collect();
    let window = parameters.window(view);
    let gathered = |index: usize| gathered(&traced, &window, medium, pixel(index).as_ivec2());
    let image: Vec<Vec3> = (0..height * width).into_par_iter().map(gathered).collect();
    Ok(Planes::from_fn(3, height, width, |c, y, x| image[y * width + x][c]))
}

impl Tracing<'_> {
    fn traced(&self, segment: Segment, pixel: UVec2) -> Traced {
        let uniforms::Bounces { directions, seed, .. } = self.bounces;
        let ray = Ray::marched(self.medium, segment, &self.parameters.division(seed), pixel);
        let along = self.view.camera.direction_to_camera(segment.direction);
        let sample = |number| {
            if ray.leaves <= ray.enters || mean_transmittance(self.medium, ray.whole) >= 1.0 {
                return Sample { distance: ray.enters, arrived: Vec3::ZERO };
            }
            let place = place_at(&ray, self.medium, share_of(pixel, number, seed));
            let turned = place_on_disk(pixel, number, [directions, seed]);
            let direction = HenyeyGreenstein::new(self.medium.anisotropy).sample(along, turned);
            Sample { distance: place.distance, arrived: self.arriving(&place, along, direction) }
        };
        let samples = (0..directions).map(sample).collect();
        Traced { ray, samples }
    }

    /// The radiance that scatters to the eye at a place, over the density of such places and directions.
    fn arriving(&self, place: &Place, along: Vec3, direction: Vec3) -> Vec3 {
        let origin = place.distance * along;
        let way = reference::Ray { origin, normal: Vec3::ZERO, direction };
        let Some(disk) = reference::met(&self.bounces, self.disks, &way) else { return Vec3::ZERO };
        let distance = way.distance(disk, self.bounces.cover).unwrap_or_default();
        let camera = &self.view.camera;
        let (from, towards) = (camera.position + camera.rotation * origin, camera.rotation * direction);
        let share = self.medium.passed_share(from, towards, distance, self.parameters.points);
        let extinction = self.medium.extinction();
        let usual = extinction.element_sum() / 3.0;
        let scattered = self.medium.scattering / usual * ((usual - extinction) * place.passed).exp();
        sent(direction, disk) * scattered * share
    }
}

/// A number in [0, 1) for each ray of a pixel, which those of a square fill evenly.
fn share_of(pixel: UVec2, number: u32, seed: u32) -> f32 {
    let which = IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(seed));
    (STEP * which as f32 + random(pixel.x >> SQUARE, pixel.y >> SQUARE, seed, 2)).fract()
}

/// The place before which a share of the transmittance's whole loss lies. Within an interval density is taken
/// to be even.
fn place_at(ray: &Ray, medium: &Medium, share: f32) -> Place {
    let interval = ((share * (SAMPLES - 1) as f32 + ray.offset) as usize).min(SAMPLES - 2);
    let [begins, ends] = [interval, interval + 1].map(|sample| ray.samples.distance(sample, ray));
    let [before, after] = [interval, interval + 1].map(|sample| ray.passed_before(medium, sample, SAMPLES));
    let (least, extinction) =
        (mean_transmittance(medium, ray.whole), medium.extinction().element_sum() / 3.0);
    let passed = (-(1.0 - share * (1.0 - least)).ln() / extinction.max(1e-30)).clamp(before, after);
    let part = (passed - before) / (after - before).max(1e-30);
    Place { distance: begins + part * (ends - begins), passed }
}

/// What the samples of a pixel and of those around it say of it: `fog_filter.wgsl`.
fn gathered(traced: &[Traced], window: &uniforms::FogWindow, medium: &Medium, centre: IVec2) -> Vec3 {
    let size = IVec2::new(window.width as i32, window.height as i32);
    let of = |at: IVec2| &traced[(at.y * size.x + at.x) as usize];
    let loss = |at: IVec2| 1.0 - mean_transmittance(medium, of(at).ray.whole);
    let seen = of(centre).ray.enters..=of(centre).ray.leaves;
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    let reach = -window.radius..=window.radius;
    for step in reach.clone().flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y))) {
        let at = centre + step;
        let near = 1.0 - window.falloff * step.length_squared() as f32;
        if at.cmplt(IVec2::ZERO).any() || at.cmpge(size).any() || near <= 0.0 {
            continue;
        }
        let weight = near * near * loss(at);
        for sample in of(at).samples.iter().filter(|sample| seen.contains(&sample.distance)) {
            sum += weight * sample.arrived;
            weights += weight;
        }
    }
    loss(centre) * sum / f32::max(weights, 1e-30)
}
