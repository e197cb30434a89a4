//! Froxels in plain Rust: the passes of `methods/froxel`.

use crate::bvh::TracedScene;
use crate::methods::growing::{growing, share_of_parts};
use crate::methods::picture::every_pixel;
use crate::methods::single_scattering::{LitMedium, distances, mean_decay};
use crate::scene::Medium;
use crate::screen::View;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{GBuffer, MissingAttribute, Planes};
use glam::{UVec2, UVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Nearer to a lamp than this part of a step it counts as that near.
const NEAREST: f32 = 0.25;
/// Steps of a sequence that fills a cube evenly (Roberts 2018).
const STRIDE: Vec3 = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);

/// The slices of a ray.
struct Slices {
    count: f32,
    near: f32,
    far: f32,
}

impl Slices {
    fn new(medium: &Medium, count: u32, eye: Vec3, direction: Vec3) -> Self {
        let [near, far] = medium.seen_span(eye, direction, 1e30);
        Self { count: count as f32, near, far }
    }

    /// Where a slice begins.
    fn distance(&self, slice: u32) -> f32 {
        self.near + (self.far - self.near) * growing(slice as f32 / self.count)
    }

    /// Which fractional slice is at a distance.
    fn at(&self, distance: f32) -> f32 {
        let passed = ((distance - self.near) / (self.far - self.near).max(1e-30)).clamp(0.0, 1.0);
        self.count * share_of_parts(passed)
    }
}

/// Where in their columns froxels are lit, and where in their steps.
fn shift(froxels: &uniforms::Froxels) -> Vec3 {
    (0.5 + froxels.frame as f32 * STRIDE).fract()
}

/// The image, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    froxels: &uniforms::Froxels,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let distances = distances(gbuffer)?;
    let Some(lit) = LitMedium::of(scene) else { return Ok(Planes::filled(3, height, width, 0.0)) };
    let &uniforms::Froxels { columns, rows, tile, .. } = froxels;
    let column = |i: u32| sums(&lit, froxels, view, UVec2::new(i % columns, i / columns));
    let all: Vec<Vec<Vec3>> = (0..columns * rows).into_par_iter().map(column).collect();
    let last = UVec2::new(columns - 1, rows - 1);
    let pixels = every_pixel(height, width, |pixel| {
        let direction = view.camera.direction(pixel.as_vec2() + 0.5, height, width);
        let slices = Slices::new(lit.medium, froxels.slices, view.camera.position, direction);
        let slice = slices.at(distances[pixel.y as usize * width + pixel.x as usize]);
        let first = (slice as usize).min(froxels.slices as usize - 1);
        let at = ((pixel.as_vec2() + 0.5) / tile as f32 - shift(froxels).truncate())
            .max(Vec2::ZERO)
            .min(last.as_vec2());
        let part = at - at.floor();
        let corner = |corner: UVec2| {
            let beside = (at.as_uvec2() + corner).min(last);
            let weights = Vec2::select(corner.cmpeq(UVec2::ONE), part, 1.0 - part);
            let sums = &all[(beside.y * columns + beside.x) as usize];
            weights.element_product() * sums[first].lerp(sums[first + 1], slice - first as f32)
        };
        [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(corner).into_iter().sum::<Vec3>()
    });
    Ok(Planes::from_fn(3, height, width, |channel, y, x| pixels[y * width + x][channel]))
}

/// What a column sends to the eye up to the beginning of each slice and to the end of the last.
fn sums(lit: &LitMedium<'_>, froxels: &uniforms::Froxels, view: &View, column: UVec2) -> Vec<Vec3> {
    let extinction = lit.medium.extinction();
    let (mut all, mut sum, mut before) = (vec![Vec3::ZERO], Vec3::ZERO, 0.0);
    for slice in 0..froxels.slices {
        let (light, here) = scattered(lit, froxels, view, column.extend(slice));
        let left = (-extinction * before).exp() * here * mean_decay(extinction * here);
        sum += lit.medium.scattering * light * left;
        before += here;
        all.push(sum);
    }
    all
}

/// Radiance that a metre of density 1 sends to the eye, over its scattering coefficient, and density times
/// length.
fn scattered(lit: &LitMedium<'_>, froxels: &uniforms::Froxels, view: &View, cell: UVec3) -> (Vec3, f32) {
    let (eye, shift) = (view.camera.position, shift(froxels));
    let pixel = (cell.truncate().as_vec2() + shift.truncate()) * froxels.tile as f32;
    let direction = view.camera.direction(pixel, view.height, view.width);
    let slices = Slices::new(lit.medium, froxels.slices, eye, direction);
    let [begins, ends] = [cell.z, cell.z + 1].map(|slice| slices.distance(slice));
    let step = (ends - begins) / froxels.samples as f32;
    let (mut light, mut passed) = (Vec3::ZERO, 0.0);
    for i in 0..froxels.samples {
        let point = eye + direction * (begins + (i as f32 + shift.z) * step);
        let here = lit.medium.density.inside(point) * step;
        if here > 0.0 {
            let of = |lamp| lit.scattered_of(lamp, point, direction, NEAREST * step);
            light += here * lit.lights().iter().map(of).sum::<Vec3>();
        }
        passed += here;
    }
    (light / passed.max(1e-30), passed)
}
