//! Pixels lit by volumes in plain Rust, with exact shadows: what the passes of `methods/lpv` do.

use super::LpvParameters;
use super::lit_volume::{LitVolume, LitVolumes};
use super::passes::{Filled, Pixel};
use crate::methods::picture::every_pixel;
use crate::methods::single_scattering::mean_decay;
use crate::scene::Medium;
use crate::screen::{PlainInputs, View, Written};
use deepshade_shaders::random::random;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{UVec2, Vec2, Vec3};
use std::f32::consts::PI;

/// What `apply.wgsl` calls so.
const TOLERANCE: f32 = 0.02;
const LEAST: f32 = 1e-4;
const POINTS: u32 = 16;

/// Place, normal and diffuse colour of a surface, world space.
type SurfaceAttributes = [Vec3; 3];

/// Place, normal and, if it is asked for, diffuse colour of the surface of each pixel, world space; none
/// where none is seen.
fn seen(
    gbuffer: &GBuffer,
    view: &View,
    colour: bool,
) -> Result<Vec<Option<SurfaceAttributes>>, MissingAttribute> {
    let of = |attribute| gbuffer.select(&[attribute]);
    let (position, normal, valid) = (of(Attribute::Position)?, of(Attribute::Normal)?, of(Attribute::Valid)?);
    let diffuse = if colour { Some(of(Attribute::Diffuse)?) } else { None };
    let camera = &view.camera;
    let pixel = |i: usize| {
        let vector = |planes: &Planes| Vec3::from([0, 1, 2].map(|c| planes.plane(c)[i]));
        shows_surface(valid.plane(0)[i]).then(|| {
            let point = camera.position + camera.rotation * vector(&position);
            [point, camera.rotation * vector(&normal), diffuse.as_ref().map_or(Vec3::ONE, vector)]
        })
    };
    Ok((0..view.height * view.width).map(pixel).collect())
}

/// Irradiance over pi of what a scene is filled with, `[3, height, width]`; nothing without a scene.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn lit_image(
    inputs: &PlainInputs<'_>,
    view: &View,
    parameters: LpvParameters,
    filled: Filled,
) -> Result<Written, MissingAttribute> {
    let shaded = |scene| {
        let volumes = LitVolumes::new(scene, parameters, view, filled, view.radius);
        Ok(lit(inputs.gbuffer, &volumes, view)?.data().to_vec())
    };
    inputs.scene.map(shaded).into_iter().collect()
}

/// Irradiance over pi, `[3, height, width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn lit(gbuffer: &GBuffer, volumes: &LitVolumes, view: &View) -> Result<Planes, MissingAttribute> {
    let seen = seen(gbuffer, view, false)?;
    let light = |surface: &Option<SurfaceAttributes>| {
        surface.map_or(Vec3::ZERO, |[point, normal, _]| volumes.irradiance(point, normal) / PI)
    };
    let pixels: Vec<Vec3> = seen.iter().map(light).collect();
    Ok(Planes::from_fn(3, view.height, view.width, |c, y, x| pixels[y * view.width + x][c]))
}

/// The medium in front of each pixel and the surface behind it, as far as they are shown: radiance,
/// `[3, height, width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    volumes: &LitVolumes,
    medium: &Medium,
    parameters: LpvParameters,
    (shown, view): (Pixel, &View),
) -> Result<Planes, MissingAttribute> {
    let seen = seen(gbuffer, view, true)?;
    let marched = Marched::new(&seen, volumes, medium, parameters, view);
    let pixels = every_pixel(view.height, view.width, |pixel| {
        let pixel = pixel.as_uvec2();
        let scattered = if shown.medium { marched.before(pixel) } else { Vec3::ZERO };
        let surface = seen[(pixel.y as usize) * view.width + pixel.x as usize].filter(|_| shown.surface);
        scattered + surface.map_or(Vec3::ZERO, |surface| lit_through(volumes, medium, surface, view))
    });
    Ok(Planes::from_fn(3, view.height, view.width, |c, y, x| pixels[y * view.width + x][c]))
}

/// What a surface sends to the eye through the medium.
fn lit_through(
    volumes: &LitVolumes,
    medium: &Medium,
    [point, normal, diffuse]: SurfaceAttributes,
    view: &View,
) -> Vec3 {
    let way = point - view.camera.position;
    let passed = medium.passed_share(view.camera.position, way.normalize(), way.length(), POINTS);
    passed * diffuse / PI * volumes.irradiance(point, normal)
}

/// What the medium scatters in front of one pixel of some.
struct Marched {
    scale: u32,
    size: UVec2,
    scattered: Vec<Vec3>,
    /// How far away the surfaces of all pixels are, metres.
    distances: Vec<f32>,
    width: usize,
}

impl Marched {
    fn new(
        seen: &[Option<SurfaceAttributes>],
        volumes: &LitVolumes,
        medium: &Medium,
        LpvParameters { steps, scale, .. }: LpvParameters,
        view: &View,
    ) -> Self {
        let eye = view.camera.position;
        let distance =
            |surface: &Option<SurfaceAttributes>| surface.map_or(1e30, |[point, ..]| point.distance(eye));
        let distances: Vec<f32> = seen.iter().map(distance).collect();
        let [rows, columns] = [view.height, view.width].map(|edge| edge.div_ceil(scale));
        let scattered = every_pixel(rows, columns, |small| {
            let pixel = small.as_uvec2() * scale as u32;
            let reach = distances[pixel.y as usize * view.width + pixel.x as usize];
            volumes.0.iter().map(|volume| march(volume, medium, steps, (pixel, reach), view)).sum()
        });
        let size = UVec2::new(columns as u32, rows as u32);
        Self { scale: scale as u32, size, scattered, distances, width: view.width }
    }

    fn distance(&self, pixel: UVec2) -> f32 {
        self.distances[pixel.y as usize * self.width + pixel.x as usize]
    }

    /// In front of a pixel, from those around it whose surfaces are as far away.
    fn before(&self, pixel: UVec2) -> Vec3 {
        let (low, reach) = (pixel / self.scale, self.distance(pixel));
        let part = (pixel - low * self.scale).as_vec2() / self.scale as f32;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for corner in [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE] {
            let tap = (low + corner).min(self.size - 1);
            let near = Vec2::select(corner.cmpeq(UVec2::ONE), part, 1.0 - part).element_product();
            let off = (self.distance(tap * self.scale) - reach) / (TOLERANCE * reach);
            let weight = near * (1.0 / (1.0 + off * off)).max(LEAST);
            sum += weight * self.scattered[(tap.y * self.size.x + tap.x) as usize];
            weights += weight;
        }
        sum / weights
    }
}

/// What the medium scatters to the eye in front of a pixel, up to a distance.
fn march(volume: &LitVolume, medium: &Medium, steps: u32, (pixel, reach): (UVec2, f32), view: &View) -> Vec3 {
    let (eye, extinction) = (view.camera.position, medium.extinction());
    let direction = view.camera.direction(pixel.as_vec2() + 0.5, view.height, view.width);
    let [begins, ends] = medium.seen_span(eye, direction, reach);
    let [begins, ends] = volume.span(eye, direction, [begins, begins.max(ends)]);
    let step = (ends - begins) / steps as f32;
    let shift = random(pixel.x, pixel.y, view.seed, 0);
    let mut passed = medium.passed_share(eye, direction, begins, 8);
    let mut sum = Vec3::ZERO;
    for i in 0..steps {
        let point = eye + direction * (begins + (i as f32 + shift) * step);
        let here = medium.density.inside(point) * step;
        let scattered = volume.scattered_along(point, -direction, medium.anisotropy);
        sum += passed * mean_decay(extinction * here) * here * scattered;
        passed *= (-extinction * here).exp();
    }
    sum * medium.scattering
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image of pixels whose surfaces are so far away, of which the marched ones have what `light` says of
    /// their place.
    fn marched(
        scale: u32,
        size: UVec2,
        distance: impl Fn(UVec2) -> f32,
        light: impl Fn(UVec2) -> f32,
    ) -> Marched {
        let pixels = |size: UVec2| (0..size.x * size.y).map(move |i| UVec2::new(i % size.x, i / size.x));
        let small = (size + scale - 1) / scale;
        Marched {
            scale,
            size: small,
            scattered: pixels(small).map(|at| Vec3::splat(light(at * scale))).collect(),
            distances: pixels(size).map(distance).collect(),
            width: size.x as usize,
        }
    }

    #[test]
    fn what_is_linear_before_one_surface_is_what_it_was() {
        let (size, plane) = (UVec2::new(13, 9), |at: UVec2| 2.0 + 0.3 * at.x as f32 - 0.1 * at.y as f32);
        for scale in [1, 2, 3, 4] {
            let image = marched(scale, size, |_| 5.0, plane);
            // Up to the last pixel that was marched.
            let last = (image.size - 1) * scale;
            for at in (0..=last.x).flat_map(|x| (0..=last.y).map(move |y| UVec2::new(x, y))) {
                let is = image.before(at).x;
                assert!((is - plane(at)).abs() < 1e-5, "scale {scale}, {at}: {is}");
            }
        }
    }

    #[test]
    fn light_before_one_surface_does_not_spread_to_another() {
        let size = UVec2::new(24, 16);
        // A post before a wall; its edges are between pixels that are marched.
        let distance = |at: UVec2| if (9..15).contains(&at.x) { 1.0 } else { 8.0 };
        let lerped = |scale: u32, at: UVec2| {
            let (low, part) = (at.x / scale * scale, (at.x % scale) as f32 / scale as f32);
            let next = distance(UVec2::new((low + scale).min((size.x - 1) / scale * scale), at.y));
            distance(UVec2::new(low, at.y)) * (1.0 - part) + next * part
        };
        for scale in [2, 3, 4] {
            let image = marched(scale, size, distance, distance);
            let (mut worst, mut worst_without) = (0.0f32, 0.0f32);
            for at in (0..size.x).flat_map(|x| (0..size.y).map(move |y| UVec2::new(x, y))) {
                let is = image.before(at).x;
                worst = worst.max((is - distance(at)).abs() / distance(at));
                worst_without = worst_without.max((lerped(scale, at) - distance(at)).abs() / distance(at));
            }
            assert!(worst < 0.02 && worst_without > 1.0, "scale {scale}: {worst}, without {worst_without}");
        }
    }
}
