//! Steps towards any lamp through any medium: one look into the shadow map and one exponential each.

use super::super::shafts::{Haze, IntegrationInputs, LampPosition};
use super::Ray;
use crate::path::medium::HenyeyGreenstein;
use glam::Vec3;

/// Nearer to a local lamp than this, metres, or than this part of its distance to the eye, it counts as that
/// near: it is infinitely bright there.
const NEAREST: [f32; 2] = [1e-4, 1e-5];

/// Largest angle to the view ray's nearest point, radians: what is endless ends there, almost right.
const WIDEST: f32 = std::f32::consts::FRAC_PI_2 - 1e-4;

/// A lamp and what its light passes.
#[derive(Debug)]
pub(super) struct General<'a> {
    lit: IntegrationInputs<'a>,
    /// The medium if it is no grid.
    haze: Option<Haze<'a>>,
    phase: HenyeyGreenstein,
    light_steps: u32,
}

/// How a view ray is cut: at equal angles from a local lamp, else at equal distances.
enum Cut {
    /// First distance and length.
    Distances([f32; 2]),
    /// First angle and step in radians; where the lamp is nearest, and how near, metres.
    Angles([f32; 2], [f32; 2]),
}

impl Cut {
    /// The middle of step number `at`, and its length.
    fn step(&self, at: f32) -> [f32; 2] {
        match *self {
            Self::Distances([first, length]) => [first + at * length, length],
            Self::Angles([first, step], [nearest, aside]) => {
                let tangent = (first + at * step).tan();
                [nearest + aside * tangent, aside * step * (1.0 + tangent * tangent)]
            }
        }
    }
}

impl<'a> General<'a> {
    pub(super) fn new(lit: &IntegrationInputs<'a>, haze: Option<Haze<'a>>, light_steps: u32) -> Self {
        Self { lit: *lit, haze, phase: HenyeyGreenstein::new(lit.medium.anisotropy), light_steps }
    }

    /// Radiance of a ray.
    pub(super) fn radiance(&self, ray: Ray) -> Vec3 {
        let Ray { direction, span: [near, far], count, jitter } = ray;
        let eye = self.lit.rays.eye;
        let cut = self.cut(direction, [near, far], count);
        let extinction = self.lit.medium.extinction();
        let (mut sum, mut passed) = (Vec3::ZERO, 0.0);
        for i in 0..count {
            let [distance, length] = cut.step(i as f32 + jitter);
            let point = eye + direction * distance;
            let density = self.lit.medium.density.inside(point);
            // In grids half a step is before its middle.
            let before = if self.haze.is_some() { distance - near } else { passed + 0.5 * density * length };
            passed += density * length;
            if density == 0.0 || !self.lit.map.reaches(point) {
                continue;
            }
            let (irradiance, cosine, way) = self.arriving(point, direction);
            let left = (-extinction * (before + way)).exp();
            sum += irradiance * left * (density * length * self.phase.evaluate(cosine));
        }
        sum * self.lit.medium.scattering
    }

    fn cut(&self, direction: Vec3, [near, far]: [f32; 2], count: u32) -> Cut {
        match self.lit.lamp.position {
            LampPosition::Distant(_) => Cut::Distances([near, (far - near) / count as f32]),
            LampPosition::Local(position) => {
                let offset = position - self.lit.rays.eye;
                let nearest = offset.dot(direction);
                let least = NEAREST[0].max(NEAREST[1] * offset.length());
                let aside = (offset - direction * nearest).length().max(least);
                let angle = |distance: f32| ((distance - nearest) / aside).atan().min(WIDEST);
                let [first, last] = [near, far].map(angle);
                Cut::Angles([first, (last - first) / count as f32], [nearest, aside])
            }
        }
    }

    /// Irradiance at a point without the medium, the cosine by which light turns there, and how far it came
    /// through the medium: metres of density 1.
    fn arriving(&self, point: Vec3, direction: Vec3) -> (Vec3, f32, f32) {
        let lamp = self.lit.lamp;
        let power = lamp.power * if lamp.is_even() { Vec3::ONE } else { lamp.tint(point) };
        match lamp.position {
            LampPosition::Distant(towards) => {
                (power, towards.dot(direction), self.way_in(point, towards, f32::INFINITY))
            }
            LampPosition::Local(position) => {
                let offset = position - point;
                let distance = offset.length().max(NEAREST[0]);
                let towards = offset.normalize_or_zero();
                let irradiance = power * lamp.fade(distance) / (distance * distance);
                (irradiance, towards.dot(direction), self.way_in(point, towards, distance))
            }
        }
    }

    fn way_in(&self, point: Vec3, towards: Vec3, way: f32) -> f32 {
        let Some(haze) = &self.haze else { return self.depth_in_grid(point, towards, way) };
        haze.way_in(point, towards, way)
    }

    /// Density summed along the way to the light.
    fn depth_in_grid(&self, point: Vec3, towards: Vec3, way: f32) -> f32 {
        let density = &self.lit.medium.density;
        let Some([near, far]) = density.span(point, towards, way) else { return 0.0 };
        let length = (far - near) / self.light_steps as f32;
        let at = |i: u32| density.inside(point + towards * (near + (i as f32 + 0.5) * length));
        (0..self.light_steps).map(at).sum::<f32>() * length
    }
}
