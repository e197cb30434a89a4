//! Light rays in epipolar slices in plain Rust, one after the other, without sums: the passes of
//! `methods/epipolar`.

use super::lines::Lines;
use crate::bvh::TracedScene;
use crate::methods::epipolar::Geometry;
use crate::methods::fog_march::reference::Ray;
use crate::methods::growing::{growing, growth_at, share_of_parts};
use crate::methods::picture::every_pixel;
use crate::methods::shafts::Lamp;
use crate::methods::single_scattering::{LitMedium, distances};
use crate::scene::Light;
use crate::screen::View;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{GBuffer, MissingAttribute, Planes, random};
use glam::{UVec2, Vec3};

/// Nearer to the line through a lamp than this, metres, or than this part of the lamp's distance, view rays
/// are marched.
const LEAST_ASIDE: [f32; 2] = [1e-4, 1e-5];

/// The image, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    settings: &uniforms::Epipolar,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let distances = distances(gbuffer)?;
    let mut image = Planes::filled(3, height, width, 0.0);
    let Some(lit) = LitMedium::of(scene) else { return Ok(image) };
    for light in lit.lights() {
        let position = Lamp::new(scene.scene(), light).position;
        let geometry = Geometry::new(view.camera.position, position);
        let rays: Vec<PlaneRay> = every_pixel(height, width, |at| {
            let reach = distances[at.y as usize * width + at.x as usize];
            PlaneRay::new(&lit, view, geometry.as_ref(), at.as_uvec2(), reach)
        });
        let seen = rays.iter().filter(|ray| ray.leaves > ray.enters);
        let bounds = seen.fold([f32::MAX, 0.0f32], |[least, largest], ray| {
            [least.min(ray.gamma[0].min(ray.gamma[1])), largest.max(ray.gamma[0].max(ray.gamma[1]))]
        });
        let lamp = geometry.map(|geometry| OneLamp {
            lit: &lit,
            light,
            lines: Lines::new(&geometry, view),
            geometry,
            bounds,
            settings,
            view,
        });
        let radiance = every_pixel(height, width, |at| {
            let ray = &rays[at.y as usize * width + at.x as usize];
            let sent = lamp.as_ref().and_then(|lamp| lamp.sum(ray, at.as_uvec2()));
            lit.medium.scattering * sent.unwrap_or_else(|| ray.marched(&lit, light, settings, at.as_uvec2()))
        });
        for (index, sent) in radiance.iter().enumerate() {
            (0..3).for_each(|channel| image.plane_mut(channel)[index] += sent[channel]);
        }
    }
    Ok(image)
}

/// A view ray in rectified coordinates.
struct PlaneRay {
    eye: Vec3,
    direction: Vec3,
    /// Along the line to the lamp, and away from it.
    in_plane: [f32; 2],
    enters: f32,
    leaves: f32,
    /// The light rays through both ends.
    gamma: [f32; 2],
}

impl PlaneRay {
    fn new(lit: &LitMedium<'_>, view: &View, geometry: Option<&Geometry>, at: UVec2, reach: f32) -> Self {
        let eye = view.camera.position;
        let direction = view.camera.direction(at.as_vec2() + 0.5, view.height, view.width);
        let [enters, leaves] = lit.medium.seen_span(eye, direction, reach);
        let seen = geometry.and_then(|geometry| {
            let ray = geometry.direction(direction);
            let is_apart = geometry.is_parallel()
                || ray.aside * geometry.reach > LEAST_ASIDE[0].max(LEAST_ASIDE[1] * geometry.reach);
            let gamma = [enters, leaves].map(|distance| geometry.gamma(ray, distance));
            is_apart.then_some(([ray.along, ray.aside], gamma))
        });
        let (in_plane, gamma) = seen.unwrap_or_default();
        Self { eye, direction, in_plane, enters, leaves, gamma }
    }

    /// By steps.
    fn marched(&self, lit: &LitMedium<'_>, light: &Light, settings: &uniforms::Epipolar, at: UVec2) -> Vec3 {
        let &Self { eye, direction, enters, leaves, .. } = self;
        if leaves <= enters {
            return Vec3::ZERO;
        }
        let shift = random::random(at.x, at.y, settings.seed, 0);
        Ray { eye, direction, span: [enters, leaves], steps: settings.steps, shift }.scattered(lit, light)
    }
}

/// One of the lamps, and its light rays.
struct OneLamp<'a> {
    lit: &'a LitMedium<'a>,
    light: &'a Light,
    geometry: Geometry,
    lines: Lines,
    bounds: [f32; 2],
    settings: &'a uniforms::Epipolar,
    view: &'a View,
}

impl OneLamp<'_> {
    /// Which fractional light ray is at a value of `gamma`.
    fn number(&self, gamma: f32) -> f32 {
        let [first, last] = self.bounds;
        let passed = ((gamma - first) / (last - first).max(1e-30)).clamp(0.0, 1.0);
        self.settings.light_rays as f32 * share_of_parts(passed)
    }

    /// The `gamma` of a fractional light ray, and how much it grows there from one to the next.
    fn gamma(&self, number: f32) -> [f32; 2] {
        let ([first, last], count) = (self.bounds, self.settings.light_rays as f32);
        let share = number / count;
        [first + (last - first) * growing(share), (last - first) / count * growth_at(share)]
    }

    /// What a view ray receives by all light rays that it crosses; `None` if these are too few.
    fn sum(&self, ray: &PlaneRay, at: UVec2) -> Option<Vec3> {
        let [from, to] = ray.gamma.map(|gamma| self.number(gamma));
        if ray.leaves <= ray.enters || to - from < self.settings.least as f32 {
            return None;
        }
        let line = self.lines.through(at.as_vec2() + 0.5);
        let before = line.floor().min(self.lines.count() - 1.0);
        let on = line - before;
        let outwards = [before, before + 1.0].map(|line| {
            let view = self.view;
            let end = self.lines.end(line);
            self.geometry.outwards(view.camera.direction(end, view.height, view.width))
        });
        let (mut sum, mut begins) = (Vec3::ZERO, from);
        while begins < to {
            let ends = (begins.floor() + 1.0).min(to);
            let [first, second] =
                outwards.map(|outwards| f32::from(self.lights(ray, outwards, begins.floor() + 0.5)));
            let share = (first + (second - first) * on) * (ends - begins);
            if share > 0.0 {
                sum += share * self.integrand(ray, 0.5 * (begins + ends));
            }
            begins = ends;
        }
        Some(sum)
    }

    /// How far along a view ray a fractional light ray is.
    fn distance(&self, ray: &PlaneRay, number: f32) -> f32 {
        let [gamma, _] = self.gamma(number);
        let [along, aside] = ray.in_plane;
        if self.geometry.is_parallel() {
            return gamma / aside;
        }
        self.geometry.reach * gamma.sin() / (aside * gamma.cos() + along * gamma.sin()).max(1e-20)
    }

    /// Whether a light ray of a slice gets as far as a view ray.
    fn lights(&self, ray: &PlaneRay, outwards: Vec3, number: f32) -> bool {
        let [along, aside] = ray.in_plane;
        let direction = self.geometry.axis * along + outwards * aside;
        let point = ray.eye + direction * self.distance(ray, number);
        !self.lit.is_hidden(self.light, point)
    }

    /// What a view ray would receive by a light ray if that is lit, over the scattering coefficient.
    fn integrand(&self, ray: &PlaneRay, number: f32) -> Vec3 {
        let [_, growth] = self.gamma(number);
        let distance = self.distance(ray, number).clamp(ray.enters, ray.leaves);
        let point = ray.eye + ray.direction * distance;
        let [_, aside] = ray.in_plane;
        let metres = match self.geometry.is_parallel() {
            true => 1.0 / aside,
            false => {
                let lamp = self.geometry.eye + self.geometry.axis * self.geometry.reach;
                lamp.distance_squared(point) / (self.geometry.reach * aside)
            }
        };
        let left = (-self.lit.medium.extinction() * (distance - ray.enters)).exp();
        left * self.lit.unhidden(self.light, point, ray.direction) * (metres * growth)
    }
}
