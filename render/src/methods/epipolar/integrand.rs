//! What a point of a half-plane sends to the eye if light reaches it: the integrand `I(gamma, beta)` of Baran
//! et al. 2010 (equation 3), without what depends on the light ray alone or the view ray alone.
//!
//! Along a view ray at the angle `beta` to the light, a step `d gamma` between light rays is
//! `d gamma / sin beta` metres of a parallel light's, and `r^2 / (R sin beta) d gamma` of that of a light `R`
//! metres away whose ray has come `r` metres. The inverse square cancels, and what has no bound at the
//! epipole, `1 / sin beta`, is the view ray's alone. What is left is smooth: transmittance along both ways,
//! for local lights with the phase function and the light's end. The phase function of a parallel light is
//! the view ray's alone, too.

use super::super::shafts::{Haze, Lamp};
use super::geometry::{Geometry, angle};
use crate::path::medium::HenyeyGreenstein;

/// The integrand of one colour.
#[derive(Clone, Copy, Debug)]
pub struct Integrand<'a> {
    pub geometry: &'a Geometry,
    pub lamp: &'a Lamp<'a>,
    /// 1/m.
    pub extinction: f64,
    pub phase: HenyeyGreenstein,
    pub ways: Ways,
    /// The largest sum of both angles at which a view ray meets a local light's ray, radians. Beyond, where
    /// rays that meet farther away than anything is seen would leave a jump, the integrand goes on smoothly.
    pub widest: f64,
}

/// How far light goes in all before it can be in the medium's box: the unit in which the optical depths of
/// the view ray, the light ray and the rest are stated, so that none of the three factors leaves the range of
/// numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ways {
    /// From the eye to the box, metres.
    pub view: f32,
    /// From a local light to the box.
    pub light: f32,
    /// Both, as they are counted in the integrand: the least that it subtracts.
    pub least: f32,
}

/// Logarithm of a distance at which nothing is left.
const FARTHEST: f64 = 50.0;

impl Ways {
    /// Those of a medium.
    pub fn of(haze: &Haze<'_>, geometry: &Geometry) -> Self {
        let Some(bounds) = haze.bounds() else { return Self::default() };
        let to_box = |point: glam::Vec3| point.distance(point.clamp(bounds.min, bounds.max));
        let view = to_box(geometry.eye);
        if geometry.is_parallel() {
            let along = bounds.corners().map(|corner| (corner - geometry.eye).dot(geometry.axis));
            let highest = along.into_iter().fold(f32::NEG_INFINITY, f32::max);
            return Self { view, light: 0.0, least: (view - highest).max(0.0) };
        }
        let light = to_box(geometry.eye + geometry.axis * geometry.reach);
        Self { view, light, least: view + light }
    }
}

impl Integrand<'_> {
    /// Its value for a light ray and what stands for the view ray's angle.
    pub fn at(&self, gamma: f64, beta: f64) -> f64 {
        let [cosine, sine] = angle(beta);
        if self.geometry.is_parallel() {
            // The way on the view ray less what the light ray is shorter: gamma tan(beta / 2).
            let tangent = if cosine > 0.0 { sine / (1.0 + cosine) } else { (1.0 - cosine) / sine.max(1e-12) };
            return self.transmittance(gamma * tangent);
        }
        let (reach, view) = (f64::from(self.geometry.reach), sine.atan2(cosine));
        let half = 0.5 * (view + gamma);
        let secant = self.secant(half);
        let ways = reach * (0.5 * (view - gamma)).cos() * secant;
        let distance = 0.5 * reach * sine * secant / half.sin();
        let turned = self.phase.evaluate((view + gamma).cos() as f32);
        self.transmittance(ways) * f64::from(turned) * f64::from(self.lamp.fade(distance as f32))
    }

    /// `1 / cos` of half the sum of both angles; from the widest on it grows at the rate that it has there.
    fn secant(&self, half: f64) -> f64 {
        let nearest = half.min(0.5 * self.widest);
        ((half - nearest) * nearest.tan()).min(FARTHEST).exp() / nearest.cos()
    }

    fn transmittance(&self, ways: f64) -> f64 {
        (-self.extinction * (ways - f64::from(self.ways.least)).max(0.0)).exp()
    }
}
