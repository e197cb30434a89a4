//! The integrand as a sum of products (Baran et al. 2010, section 6): `I(gamma, beta) = sum of Gamma_i(gamma) B_i(beta)`,
//! by the singular value decomposition of 64 x 64 samples, for every colour of which there is one in the tree.
//!
//! Samples are denser towards the eye, quadratically in `gamma`, since in dense fog all that counts is there. Between them vectors are interpolated by cubic curves (Catmull and Rom 1974), whose error is far below that of
//! leaving out terms, where straight lines' is not.

use super::integrand::Integrand;
use super::spacing::Spacing;
use super::svd::Svd;

/// Samples along each coordinate.
const SAMPLES: usize = 64;
/// Pieces of the view factors' table, which is read by straight lines.
const PIECES: usize = 2048;

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
    /// Of one integrand a colour (`W` is a multiple of their number), for light rays and for view rays between two
    /// values of `beta`.
    pub fn new(integrands: &[Integrand<'_>], spacing: &Spacing, [low, high]: [f32; 2]) -> Self {
        let terms = W / integrands.len();
        let (low, high) = (f64::from(low), f64::from(high));
        let count = spacing.count;
        let [first, last] = [0.0, count as f32].map(|number| f64::from(spacing.gamma(number)));
        let share = |i: usize| i as f64 / (SAMPLES - 1) as f64;
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
                    let column = |c: usize| {
                        (0..SAMPLES)
                            .map(|r| integrand.at(first + (last - first) * share(r).powi(2), low + (high - low) * share(c)))
                            .collect()
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
                    view[place] = cubic(&svd.columns[term], piece as f64 / PIECES as f64) as f32;
                }
            }
            if colour == 0 {
                factors.values = svd.values.iter().map(|value| value / svd.values[0]).collect();
            }
            previous = Some((integrand.extinction, svd));
        }
        factors
    }

    /// The integral along a view ray of each of `C` colours, from the sums of `Gamma_i` over its lit light rays.
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
    use crate::methods::shafts::{Lamp, Place};
    use crate::path::medium::HenyeyGreenstein;
    use crate::scene::{Light, Scene};
    use glam::Vec3;

    /// Largest error of `W` terms over the largest value, and the fourth singular value over the first.
    fn error<const W: usize>(place: Place, light: Light) -> [f64; 2] {
        let scene = Scene::default();
        let lamp = Lamp::new(&scene, &light);
        let geometry = Geometry::new(Vec3::ZERO, place).expect("away from the light");
        let phase = HenyeyGreenstein::new(0.6);
        let integrand =
            Integrand { geometry: &geometry, lamp: &lamp, extinction: 0.4, phase, ways: Ways::default() };
        let (rays, step, betas) = (500, 4e-3, [0.02, 1.1]);
        let factors = Factors::<W>::new(&[integrand], rays, step, betas);
        let (mut worst, mut largest) = (0f64, 0f64);
        for ray in (0..rays).step_by(7) {
            for part in 0..50 {
                let beta = betas[0] + (betas[1] - betas[0]) * (part as f32 + 0.3) / 50.0;
                let [found] = factors.value::<1>(&factors.light[ray], beta);
                let expected =
                    integrand.at((ray as f64 + 0.5) * f64::from(step), beta.into()) * f64::from(step);
                worst = worst.max((f64::from(found) - expected).abs());
                largest = largest.max(expected);
            }
        }
        [worst / largest, factors.values[3]]
    }

    #[test]
    fn few_products_are_the_integrand() {
        let position = Vec3::new(0.0, 0.0, -2.0);
        let (irradiance, intensity, range) = (Vec3::ONE, Vec3::ONE, 9.0);
        let sun = Light::Directional { direction: Vec3::Z, irradiance, pattern: None };
        let lamp = Light::Point { position, intensity, range };
        for (place, light) in [(Place::Distant(Vec3::NEG_Z), sun), (Place::Local(position), lamp)] {
            let [one, four, twelve] =
                [error::<1>(place, light)[0], error::<4>(place, light)[0], error::<12>(place, light)[0]];
            assert!(one > 0.03 && four < 5e-3 && twelve < 5e-5, "{one:e}, {four:e}, {twelve:e}");
            // Baran et al. 2010, section 6.
            let ratio = error::<4>(place, light)[1];
            assert!(ratio < 1.0 / 40.0, "{ratio:e}");
        }
    }
}
