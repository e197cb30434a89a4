//! Volume shells in plain Rust: shells without a tree.

use super::improvements::Improvement;
use super::intervals::{Interval, Ray, mean_transmittance};
use super::pyramid::Image;
use super::{VolumeShellParameters, far_reaching};
use crate::bvh::TracedScene;
use crate::methods::surfel::reference::{facing, sent};
use crate::methods::surfel::shells;
use crate::path::medium::{HenyeyGreenstein, Segment};
use crate::scene::Medium;
use crate::screen::View;
use crate::surfels::reference::{Disk, laid};
use crate::surfels::{self, SurfelLight};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{UVec2, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::PI;

/// What pixels see through.
pub struct Sight<'a> {
    view: &'a View,
    position: Planes,
    valid: Planes,
}

impl<'a> Sight<'a> {
    /// Of a view of a g-buffer.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn new(gbuffer: &GBuffer, view: &'a View) -> Result<Self, MissingAttribute> {
        let position = gbuffer.select(&[Attribute::Position])?;
        Ok(Self { view, position, valid: gbuffer.select(&[Attribute::Valid])? })
    }

    /// A pixel's way from the eye to the surface, if it sees one.
    pub fn of(&self, pixel: UVec2) -> Segment {
        let [x, y] = [pixel.x as usize, pixel.y as usize];
        let surface = Vec3::from([0, 1, 2].map(|c| self.position.at(c, y, x))).length();
        let length = if shows_surface(self.valid.at(0, y, x)) { surface } else { 1e30 };
        let View { camera, height, width, .. } = *self.view;
        let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
        Segment { origin: camera.position, direction, length }
    }
}

/// The rays of an image's pixels.
pub struct Rays<'a> {
    medium: &'a Medium,
    parameters: &'a VolumeShellParameters,
    sight: Sight<'a>,
}

/// A pixel's ray, with what its intervals scatter.
pub struct PixelRay {
    /// Unit direction, world space.
    pub direction: Vec3,
    /// In order.
    pub intervals: Vec<Interval>,
    /// How much of what falls on it from behind is scattered or absorbed.
    scatters: f32,
}

impl<'a> Rays<'a> {
    /// Of a view of a medium.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn new(
        gbuffer: &GBuffer,
        medium: &'a Medium,
        parameters: &'a VolumeShellParameters,
        view: &'a View,
    ) -> Result<Self, MissingAttribute> {
        Ok(Self { medium, parameters, sight: Sight::new(gbuffer, view)? })
    }

    /// That of a pixel.
    pub fn of(&self, pixel: UVec2) -> PixelRay {
        let segment = self.sight.of(pixel);
        let direction = segment.direction;
        let division = self.parameters.division(self.sight.view.seed);
        let ray = Ray::marched(self.medium, segment, &division, pixel);
        let scatters = match self.parameters.improvements.has(Improvement::Silhouettes) {
            true => 1.0 - mean_transmittance(self.medium, ray.whole),
            false => 1.0,
        };
        PixelRay { direction, intervals: ray.intervals(self.medium), scatters }
    }
}

/// The medium of a scene as the method sees it.
pub fn seen_medium(scene: &TracedScene, parameters: &VolumeShellParameters) -> Option<Medium> {
    let medium = scene.scene().medium.as_deref()?;
    Some(if parameters.is_grey() { medium.in_grey() } else { medium.clone() })
}

/// The image of a scene's surfels, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &VolumeShellParameters,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let mut image = Planes::filled(3, height, width, 0.0);
    let Some(medium) = seen_medium(scene, parameters) else { return Ok(image) };
    let rays = Rays::new(gbuffer, &medium, parameters, view)?;
    let disks = lit_disks(scene, parameters, view);
    for level in 0..parameters.levels {
        let settings = parameters.level(level, view);
        let scattering = Scattering { medium: &medium, parameters, view, level: &settings };
        let mut sums = Image { size: [width, height], texels: vec![Vec4::ZERO; width * height] };
        for (pixel, sum) in scattering.over_pixels(&disks, &rays, &|disks, ray| scattering.sum(disks, ray)) {
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

/// What splatting a frame takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatCounts {
    /// Pairs of a pixel and a surfel whose shell its ray meets.
    pub pairs: u64,
    /// Intervals that these pairs visit.
    pub visits: u64,
}

/// What splatting a scene's frame takes; nothing without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn work(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &VolumeShellParameters,
    view: &View,
) -> Result<SplatCounts, MissingAttribute> {
    let Some(medium) = seen_medium(scene, parameters) else { return Ok(SplatCounts::default()) };
    let rays = Rays::new(gbuffer, &medium, parameters, view)?;
    let disks = lit_disks(scene, parameters, view);
    let mut work = SplatCounts::default();
    for level in 0..parameters.levels {
        let settings = parameters.level(level, view);
        let scattering = Scattering { medium: &medium, parameters, view, level: &settings };
        for (_, its) in scattering.over_pixels(&disks, &rays, &|disks, ray| scattering.work(disks, ray)) {
            work = SplatCounts { pairs: work.pairs + its.pairs, visits: work.visits + its.visits };
        }
    }
    Ok(work)
}

/// The surfels of a scene with the light that they send through its medium.
fn lit_disks(scene: &TracedScene, parameters: &VolumeShellParameters, view: &View) -> Vec<Disk> {
    let far = far_reaching(view);
    let near = parameters.surfels.near * view.radius / far.radius;
    let settings = surfels::SurfelDensity { near, ..parameters.surfels };
    laid(scene, &settings, &far, Some(SurfelLight::Dimmed { is_grey: parameters.is_grey() }))
}

/// What is the same for all pairs of a level.
struct Scattering<'a> {
    medium: &'a Medium,
    parameters: &'a VolumeShellParameters,
    view: &'a View,
    level: &'a uniforms::SplatLevel,
}

/// What is asked of a sub-buffer's disks and a ray of its pixels.
type Asked<'a, T> = dyn Fn(&mut dyn Iterator<Item = &Disk>, &PixelRay) -> T + Sync + 'a;

impl Scattering<'_> {
    /// What is asked, of each pixel.
    fn over_pixels<T: Send>(&self, disks: &[Disk], rays: &Rays<'_>, asked: &Asked<'_, T>) -> Vec<(UVec2, T)> {
        let &uniforms::SplatLevel { width, height, level, seed, .. } = self.level;
        let places = UVec2::new(width.div_ceil(1 << level), height.div_ceil(1 << level));
        let in_sub_buffer = |sub_buffer: u32| {
            (0..places.x * places.y)
                .map(move |i| (sub_buffer, UVec2::new(i % places.x, i / places.x)))
                .map(move |(sub_buffer, place)| (sub_buffer, shells::pixel(sub_buffer, place, level, seed)))
                .filter(move |(_, pixel)| pixel.x < width && pixel.y < height)
        };
        let answer = |(sub_buffer, pixel): (u32, UVec2)| {
            let all = disks.iter().skip(sub_buffer as usize).step_by(1 << (2 * level));
            let mut its = all.filter(|disk| disk.sent != [Vec3::ZERO; 2]);
            (pixel, asked(&mut its, &rays.of(pixel)))
        };
        (0..1u32 << (2 * level)).into_par_iter().flat_map_iter(in_sub_buffer).map(answer).collect()
    }

    /// What disks scatter to a pixel.
    fn sum(&self, disks: &mut dyn Iterator<Item = &Disk>, ray: &PixelRay) -> Vec4 {
        let direction = self.view.camera.direction_to_camera(ray.direction);
        let scattered = disks.map(|disk| {
            let by = |interval: &Interval| interval.weight * self.at(disk, interval.distance, direction);
            ray.intervals.iter().map(by).sum::<Vec3>()
        });
        (scattered.sum::<Vec3>() * self.level.stands_for).extend(ray.scatters)
    }

    fn work(&self, disks: &mut dyn Iterator<Item = &Disk>, ray: &PixelRay) -> SplatCounts {
        let direction = self.view.camera.direction_to_camera(ray.direction);
        let mut work = SplatCounts::default();
        for disk in disks {
            let along = disk.place.dot(direction);
            let aside = (disk.place - along * direction).length_squared();
            let half = |radius: f32| radius * radius - aside;
            let [hole, reach] = [disk.radius * self.level.nearest, self.outer(disk)].map(half);
            if reach <= 0.0 {
                continue;
            }
            let is_touched = |interval: &&Interval| {
                let squared = (interval.distance - along).powi(2);
                !self.parameters.improvements.has(Improvement::TouchedOnly)
                    || (squared < reach && squared >= hole)
            };
            work.pairs += 1;
            work.visits += ray.intervals.iter().filter(is_touched).count() as u64;
        }
        work
    }

    /// How far a disk's shell reaches.
    fn outer(&self, disk: &Disk) -> f32 {
        match self.level.last {
            1 => self.level.reach,
            _ => self.level.reach.min(disk.radius * self.level.farthest),
        }
    }

    fn at(&self, disk: &Disk, distance: f32, direction: Vec3) -> Vec3 {
        let point = distance * direction;
        let way = disk.place - point;
        let squared = way.length_squared();
        let outer = self.outer(disk);
        let facing = facing(way, disk);
        if squared < (disk.radius * self.level.nearest).powi(2) || squared >= outer * outer || facing <= 0.0 {
            return Vec3::ZERO;
        }
        let distance = squared.sqrt();
        let nearest = self.parameters.nearest * self.view.radius;
        let area = disk.radius * disk.radius;
        let solid_angle = PI * area * facing / (distance * (squared.max(nearest * nearest) + area));
        let phase = HenyeyGreenstein::new(self.medium.anisotropy).evaluate(way.dot(direction) / distance);
        sent(way, disk) * self.arriving(point, way / distance, distance) * (solid_angle * phase)
    }

    fn arriving(&self, point: Vec3, direction: Vec3, distance: f32) -> Vec3 {
        if !self.parameters.improvements.has(Improvement::Attenuation) {
            return Vec3::ONE;
        }
        let camera = &self.view.camera;
        let origin = camera.position + camera.rotation * point;
        self.medium.passed_share(origin, camera.rotation * direction, distance, self.parameters.points)
    }
}
