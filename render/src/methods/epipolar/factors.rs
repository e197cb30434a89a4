//! The integrand as a sum of products (Baran et al. 2010, section 6):
//! `I(gamma, beta) = sum of Gamma_i(gamma) B_i(beta)`, by the singular value decomposition of 64 x 64
//! samples, for every colour of which there is one in the tree.
//!
//! Samples are denser towards the eye, quadratically in `gamma`, since in dense fog all that counts is there,
//! and denser opposite to the light, where the ways that light goes grow without bound ([`steepness`]).
//! Between them vectors are interpolated by cubic curves (Catmull and Rom 1974), whose error is far below
//! that of leaving out terms, where straight lines' is not.

use super::geometry::angle;
use super::integrand::Integrand;
use super::spacing::Spacing;
use super::svd::Svd;

/// Samples along each coordinate.
const SAMPLES: usize = 64;
/// Pieces of the view factors' table, which is read by straight lines.
const PIECES: usize = 4096;

/// Factors of `W` numbers: the terms of the first colour, of the second, and so on.
#[derive(Debug)]
pub struct Factors<const W: usize> {
    /// `Gamma_i`, times the step, of each light ray.
    pub light: Vec<[f32; W]>,
    /// `B_i` at equal steps of `beta`.
    view: Vec<[f32; W]>,
    first_beta: f32,
    pieces_per_beta: f32,
    /// Singular values over the first one, of the first colour.
    pub values: Vec<f64>,
}

impl<const W: usize> Factors<W> {
    /// Of one integrand a colour (`W` is a multiple of their number), for light rays and for view rays
    /// between two values of `beta`.
    pub fn new(integrands: &[Integrand<'_>], spacing: &Spacing, [low, high]: [f32; 2]) -> Self {
        let terms = W / integrands.len();
        let (low, high) = (f64::from(low), f64::from(high));
        let count = spacing.count;
        let [first, last] = [0.0, count as f32].map(|number| f64::from(spacing.gamma(number)));
        let share = |i: usize| i as f64 / (SAMPLES - 1) as f64;
        let [nearest, farthest] = [low, high].map(steepness);
        let mut factors = Self {
            light: vec![[0.0; W]; count],
            view: vec![[0.0; W]; PIECES + 1],
            first_beta: low as f32,
            pieces_per_beta: PIECES as f32 / ((high - low) as f32).max(f32::MIN_POSITIVE),
            values: Vec::new(),
        };
        let mut previous: Option<(f64, Svd)> = None;
        for (colour, integrand) in integrands.iter().enumerate() {
            // Grey media have one decomposition.
            let svd = match previous.take() {
                Some((extinction, svd)) if extinction == integrand.extinction => svd,
                _ => {
                    let gamma = |r: usize| first + (last - first) * share(r).powi(2);
                    let column = |c: usize| {
                        let beta = of_steepness(nearest + (farthest - nearest) * share(c));
                        (0..SAMPLES).map(|r| integrand.at(gamma(r), beta)).collect()
                    };
                    Svd::of((0..SAMPLES).map(column).collect())
                }
            };
            for term in 0..terms {
                let place = colour * terms + term;
                for (ray, light) in factors.light.iter_mut().enumerate() {
                    let share = (f64::from(spacing.middles[ray]) - first) / (last - first);
                    let width = f64::from(spacing.width(ray));
                    light[place] = (cubic(&svd.rows[term], share.sqrt()) * width) as f32;
                }
                for (piece, view) in factors.view.iter_mut().enumerate() {
                    let beta = low + (high - low) * piece as f64 / PIECES as f64;
                    let share = (steepness(beta) - nearest) / (farthest - nearest).max(f64::MIN_POSITIVE);
                    view[place] = cubic(&svd.columns[term], share) as f32;
                }
            }
            if colour == 0 {
                factors.values = svd.values.iter().map(|value| value / svd.values[0]).collect();
            }
            previous = Some((integrand.extinction, svd));
        }
        factors
    }

    /// The integral along a view ray of each of `C` colours, from the sums of `Gamma_i` over its lit light
    /// rays.
    #[inline(always)]
    pub fn value<const C: usize>(&self, sums: &[f32; W], beta: f32) -> [f32; C] {
        let view = self.view(beta);
        std::array::from_fn(|colour| {
            let terms = W / C * colour..W / C * (colour + 1);
            sums[terms.clone()].iter().zip(&view[terms]).map(|(sum, view)| sum * view).sum()
        })
    }

    /// `B_i` of a view ray.
    #[inline(always)]
    fn view(&self, beta: f32) -> [f32; W] {
        let at = ((beta - self.first_beta) * self.pieces_per_beta).max(0.0);
        let piece = (at as i32).clamp(0, PIECES as i32 - 1) as usize;
        let on = at - piece as f32;
        let [before, after] = [&self.view[piece], &self.view[piece + 1]];
        std::array::from_fn(|i| before[i] + (after[i] - before[i]) * on)
    }
}

/// What grows evenly from one sample of `beta` to the next: `ln(1 + tan(angle / 2))`.
fn steepness(beta: f64) -> f64 {
    let [cosine, sine] = angle(beta);
    (0.5 * sine.atan2(cosine)).tan().ln_1p()
}

/// The value of `beta` that has a steepness.
fn of_steepness(steepness: f64) -> f64 {
    let (sine, cosine) = (2.0 * steepness.exp_m1().atan()).sin_cos();
    1.0 - cosine / (cosine.abs() + sine)
}

/// A cubic curve through equally spaced values, at a share of the way from the first to the last.
fn cubic(values: &[f64], share: f64) -> f64 {
    let last = values.len() - 1;
    let at = share * last as f64;
    let piece = (at as usize).min(last - 1);
    let x = at - piece as f64;
    let [b, c] = [values[piece], values[piece + 1]];
    // Beyond the ends the parabola through the three last values.
    let a = if piece > 0 { values[piece - 1] } else { 3.0 * b - 3.0 * c + values[piece + 2] };
    let d = if piece + 2 <= last { values[piece + 2] } else { 3.0 * c - 3.0 * b + a };
    let (first, second) = (0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d);
    b + x * (first + x * (second + x * (1.5 * (b - c) + 0.5 * (d - a))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::epipolar::geometry::Geometry;
    use crate::methods::epipolar::integrand::Ways;
    use crate::methods::shafts::{Lamp, LampPosition};
    use crate::path::medium::HenyeyGreenstein;
    use crate::scene::{Light, Scene};
    use glam::Vec3;

    /// Largest error of `W` terms over the largest value, where rays meet, and the fourth singular value over
    /// the first.
    fn error<const W: usize>(place: LampPosition, light: Light, anisotropy: f32) -> [f64; 2] {
        let scene = Scene::default();
        let lamp = Lamp::new(&scene, &light);
        let geometry = Geometry::new(Vec3::ZERO, place).expect("away from the light");
        let (phase, widest) = (HenyeyGreenstein::new(anisotropy), 2.6);
        let ways = Ways::default();
        let integrand = Integrand { geometry: &geometry, lamp: &lamp, extinction: 0.4, phase, ways, widest };
        let (spacing, betas) = (Spacing::between([0.0, 2.0], 500), [0.02, 1.1]);
        let factors = Factors::<W>::new(&[integrand], &spacing, betas);
        let (mut worst, mut largest) = (0f64, 0f64);
        for ray in (0..spacing.count).step_by(7) {
            let (gamma, width) = (f64::from(spacing.middles[ray]), f64::from(spacing.width(ray)));
            for part in 0..50 {
                let beta = betas[0] + (betas[1] - betas[0]) * (part as f32 + 0.3) / 50.0;
                let [cosine, sine] = angle(beta.into());
                if !geometry.is_parallel() && sine.atan2(cosine) + gamma > widest {
                    continue;
                }
                let [found] = factors.value::<1>(&factors.light[ray], beta);
                let expected = integrand.at(gamma, beta.into());
                worst = worst.max((f64::from(found) / width - expected).abs());
                largest = largest.max(expected);
            }
        }
        [worst / largest, factors.values[3]]
    }

    /// Baran et al. 2010, section 6, of the fourth singular value; they scatter alike in all directions.
    const PAPER: f64 = 1.0 / 40.0;

    #[test]
    fn few_products_are_the_integrand() {
        let position = Vec3::new(0.0, 0.0, -2.0);
        let (irradiance, intensity) = (Vec3::ONE, Vec3::ONE);
        let sun = Light::Directional { direction: Vec3::Z, irradiance, pattern: None };
        let lamp = |range: f32| Light::Point { position, intensity, range };
        let (distant, local) = (LampPosition::Distant(Vec3::NEG_Z), LampPosition::Local(position));
        let all = [
            (distant, sun, 0.0, [1e-3, 5e-6, PAPER]),
            (local, lamp(f32::INFINITY), 0.6, [5e-3, 5e-4, PAPER]),
            (local, lamp(f32::INFINITY), 0.0, [2e-2, 5e-4, PAPER]),
            (local, lamp(f32::INFINITY), -0.5, [5e-2, 2e-3, 0.06]),
            (local, lamp(30.0), 0.0, [2e-2, 5e-4, PAPER]),
        ];
        for (place, light, anisotropy, [most_of_four, most_of_twelve, most_of_ratio]) in all {
            let [one, four, twelve] = [
                error::<1>(place, light, anisotropy)[0],
                error::<4>(place, light, anisotropy)[0],
                error::<12>(place, light, anisotropy)[0],
            ];
            let are_right = one > 0.03 && four < most_of_four && twelve < most_of_twelve;
            assert!(are_right, "{light:?}, {anisotropy}: {one:e}, {four:e}, {twelve:e}");
            let ratio = error::<4>(place, light, anisotropy)[1];
            assert!(ratio < most_of_ratio, "{light:?}, {anisotropy}: {ratio:e}");
        }
    }

    #[test]
    fn steepness_is_found_again() {
        for i in 0..=1000 {
            let beta = 1.999 * f64::from(i) / 1000.0;
            assert!((of_steepness(steepness(beta)) - beta).abs() < 1e-12, "{beta}");
        }
    }
}
