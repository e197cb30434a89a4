//! Volume shells in plain Rust: shells without a tree.

use super::intervals::{Ray, SAMPLES, mean_transmittance};
use super::pyramid::Image;
use super::{Parameters, far_reaching};
use crate::bvh::TracedScene;
use crate::methods::surfel::reference::{facing, sent};
use crate::methods::surfel::shells;
use crate::path::medium::{HenyeyGreenstein, Segment};
use crate::scene::Medium;
use crate::screen::View;
use crate::surfels::reference::{Disk, laid};
use crate::surfels::{self, Lit};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{UVec2, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::PI;

/// A pixel's ray, camera space, with where its samples are and what of the light that is scattered behind each arrives.
struct LitRay {
    direction: Vec3,
    ends: [f32; SAMPLES],
    weights: [Vec3; SAMPLES - 1],
    /// How much of what falls on it from behind is scattered or absorbed.
    scatters: f32,
}

/// The image of a scene's surfels, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &Parameters,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let position = gbuffer.select(&[Attribute::Position])?;
    let valid = gbuffer.select(&[Attribute::Valid])?;
    let mut image = Planes::filled(3, height, width, 0.0);
    let Some(medium) = scene.scene().medium.as_deref() else { return Ok(image) };
    let far = far_reaching(view);
    let settings = surfels::Parameters {
        near: parameters.surfels.near * view.radius / far.radius,
        ..parameters.surfels
    };
    let disks = laid(scene, &settings, &far, Some(Lit::Dimmed));
    let ray_of = |pixel: UVec2| {
        let [x, y] = [pixel.x as usize, pixel.y as usize];
        let surface = Vec3::from([0, 1, 2].map(|c| position.at(c, y, x))).length();
        let length = if shows_surface(valid.at(0, y, x)) { surface } else { 1e30 };
        let camera = &view.camera;
        let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
        let segment = Segment { origin: camera.position, direction, length };
        let ray = Ray::marched(medium, segment, parameters.steps, pixel, view.seed);
        lit_ray(medium, &ray, camera.direction_to_camera(direction))
    };
    for level in 0..parameters.levels {
        let settings = parameters.level(level, view);
        let scattering = Scattering { medium, parameters, view, level: &settings };
        let mut sums = Image { size: [width, height], texels: vec![Vec4::ZERO; width * height] };
        for (pixel, sum) in scattering.sums(&disks, &ray_of) {
            sums.texels[pixel.y as usize * width + pixel.x as usize] = sum;
        }
        let smooth = sums.smooth(level);
        for (index, (own, smooth)) in sums.texels.iter().zip(&smooth.texels).enumerate() {
            let light = smooth.truncate() * (own.w / smooth.w.max(1e-30));
            (0..3).for_each(|c| image.plane_mut(c)[index] += light[c]);
        }
    }
    Ok(image)
}

fn lit_ray(medium: &Medium, ray: &Ray, direction: Vec3) -> LitRay {
    let extinction = medium.extinction();
    let albedo = medium.scattering / extinction.max(Vec3::splat(1e-30));
    let passes = |sample: usize| match sample {
        0 => Vec3::ONE,
        sample => (-extinction * ray.passed_before(medium, sample)).exp(),
    };
    LitRay {
        direction,
        ends: std::array::from_fn(|sample| ray.distance(sample)),
        scatters: 1.0 - mean_transmittance(medium, ray.whole),
        weights: std::array::from_fn(|i| albedo * (passes(i) - passes(i + 1)).max(Vec3::ZERO)),
    }
}

/// What is the same for all pairs of a level.
struct Scattering<'a> {
    medium: &'a Medium,
    parameters: &'a Parameters,
    view: &'a View,
    level: &'a uniforms::SplatLevel,
}

impl Scattering<'_> {
    /// What is scattered to each pixel.
    fn sums(&self, disks: &[Disk], ray_of: &(dyn Fn(UVec2) -> LitRay + Sync)) -> Vec<(UVec2, Vec4)> {
        let &uniforms::SplatLevel { width, height, level, seed, .. } = self.level;
        let places = UVec2::new(width.div_ceil(1 << level), height.div_ceil(1 << level));
        let in_sub_buffer = |sub_buffer: u32| {
            (0..places.x * places.y)
                .map(move |i| (sub_buffer, UVec2::new(i % places.x, i / places.x)))
                .map(move |(sub_buffer, place)| (sub_buffer, shells::pixel(sub_buffer, place, level, seed)))
                .filter(move |(_, pixel)| pixel.x < width && pixel.y < height)
        };
        let pixels = (0..1u32 << (2 * level)).into_par_iter().flat_map_iter(in_sub_buffer);
        pixels.map(|(sub_buffer, pixel)| (pixel, self.sum(disks, sub_buffer, &ray_of(pixel)))).collect()
    }

    /// What the disks of a sub-buffer scatter to a pixel of it.
    fn sum(&self, disks: &[Disk], sub_buffer: u32, ray: &LitRay) -> Vec4 {
        let its = disks.iter().skip(sub_buffer as usize).step_by(1 << (2 * self.level.level));
        let scattered = its.filter(|disk| disk.sent != [Vec3::ZERO; 2]).map(|disk| {
            let at = |i: usize| ray.weights[i] * self.at(disk, 0.5 * (ray.ends[i] + ray.ends[i + 1]), ray);
            (0..SAMPLES - 1).map(at).sum::<Vec3>()
        });
        (scattered.sum::<Vec3>() * self.level.stands_for).extend(ray.scatters)
    }

    fn at(&self, disk: &Disk, distance: f32, ray: &LitRay) -> Vec3 {
        let point = distance * ray.direction;
        let way = disk.place - point;
        let squared = way.length_squared();
        let outer = match self.level.last {
            1 => self.level.reach,
            _ => self.level.reach.min(disk.radius * self.level.farthest),
        };
        let facing = facing(way, disk);
        if squared < (disk.radius * self.level.nearest).powi(2) || squared >= outer * outer || facing <= 0.0 {
            return Vec3::ZERO;
        }
        let distance = squared.sqrt();
        let nearest = self.parameters.nearest * self.view.radius;
        let area = disk.radius * disk.radius;
        let solid_angle = PI * area * facing / (distance * (squared.max(nearest * nearest) + area));
        let phase = HenyeyGreenstein::new(self.medium.anisotropy).evaluate(way.dot(ray.direction) / distance);
        sent(way, disk) * self.arriving(point, way / distance, distance) * (solid_angle * phase)
    }

    fn arriving(&self, point: Vec3, direction: Vec3, distance: f32) -> Vec3 {
        if !self.parameters.attenuated {
            return Vec3::ONE;
        }
        let camera = &self.view.camera;
        let origin = camera.position + camera.rotation * point;
        self.medium.passed_share(origin, camera.rotation * direction, distance, self.parameters.points)
    }
}
