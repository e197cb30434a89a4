//! The transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.1) in plain Rust: `intervals.wgsl`.

use crate::path::medium::Segment;
use crate::scene::Medium;
use deepshade_shaders::random;
use glam::UVec2;

/// Distances of a ray.
pub const SAMPLES: usize = 16;
/// The largest share that 16 bits hold.
const WHOLE: f32 = 65_535.0;

/// A ray's way through a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it enters it, metres.
    pub enters: f32,
    /// Where it leaves it or ends on a surface; no farther than the beginning where it misses it.
    pub leaves: f32,
    /// Its density times length, metres.
    pub whole: f32,
    /// The pixel's random offset.
    pub offset: f32,
    /// Distances between which the mean transmittance falls by equal parts, as 16-bit shares of the way.
    pub shares: [u16; SAMPLES],
}

impl Ray {
    /// Marches a pixel's ray in so many steps.
    pub fn marched(medium: &Medium, segment: Segment, steps: u32, pixel: UVec2, seed: u32) -> Self {
        let Segment { origin, direction, length } = segment;
        let [enters, leaves] = medium.seen_span(origin, direction, length);
        let step = (leaves - enters).max(0.0) / steps as f32;
        let offset = random::random(pixel.x, pixel.y, seed, 0);
        let density = |i: u32| medium.density.inside(segment.at(enters + (i as f32 + offset) * step)) * step;
        let whole = (0..steps).map(density).fold(0.0, |sum, here| sum + here);
        let least = mean_transmittance(medium, whole);
        let (mut shares, mut next, mut passed) = ([u16::MAX; SAMPLES], 0, 0.0);
        for i in 0..steps {
            let here = density(i);
            let before = mean_transmittance(medium, passed);
            passed += here;
            let after = mean_transmittance(medium, passed);
            while here > 0.0 && next < SAMPLES && after <= threshold(next, least, offset) {
                // Within a step transmittance falls evenly.
                let part = (before - threshold(next, least, offset)) / (before - after).max(1e-30);
                let share = (i as f32 + part.clamp(0.0, 1.0)) / steps as f32;
                shares[next] = (share * WHOLE + 0.5) as u16;
                next += 1;
            }
        }
        Self { enters, leaves, whole, offset, shares }
    }

    /// A sample's distance from the eye, metres.
    pub fn distance(&self, sample: usize) -> f32 {
        self.enters + (self.leaves - self.enters).max(0.0) * f32::from(self.shares[sample]) / WHOLE
    }

    /// The density times length in front of a sample.
    pub fn passed_before(&self, medium: &Medium, sample: usize) -> f32 {
        if sample == SAMPLES - 1 {
            return self.whole;
        }
        let least = mean_transmittance(medium, self.whole);
        let extinction = medium.extinction().element_sum() / 3.0;
        -threshold(sample, least, self.offset).ln() / extinction.max(1e-30)
    }
}

/// What passes so much density times length by the mean extinction of the colours.
pub fn mean_transmittance(medium: &Medium, passed: f32) -> f32 {
    (-medium.extinction().element_sum() / 3.0 * passed).exp()
}

/// The transmittance down to which a sample is: 1 for the first, the least for the last, evenly between, moved by a random
/// part of an interval. (The paper counts from 1 and divides i, not i - 1, by n - 1, so that the first would not be at 1.)
pub fn threshold(sample: usize, least: f32, offset: f32) -> f32 {
    match sample {
        0 => 1.0,
        last if last == SAMPLES - 1 => least,
        inner => 1.0 - (inner as f32 - offset) * (1.0 - least) / (SAMPLES - 1) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Bounds, Density, DensityGrid};
    use glam::Vec3;

    const BOX: Bounds = Bounds { min: Vec3::new(1.0, -1.0, -1.0), max: Vec3::new(4.0, 1.0, 1.0) };
    const ALONG: Segment = Segment { origin: Vec3::ZERO, direction: Vec3::X, length: f32::INFINITY };

    fn marched(extinction: Vec3, density: Density, steps: u32) -> Ray {
        let medium = Medium::new(Vec3::ZERO, extinction, 0.0, density).expect("a medium");
        Ray::marched(&medium, ALONG, steps, UVec2::new(3, 5), 7)
    }

    #[test]
    fn transmittance_of_a_slab_falls_by_equal_steps() {
        for sigma in [0.01, 0.5, 3.0] {
            let ray = marched(Vec3::splat(sigma), Density::Within(BOX), 256);
            let least = (-3.0 * sigma).exp();
            assert!((ray.whole - 3.0).abs() < 1e-4, "{ray:?}");
            let medium =
                Medium::new(Vec3::ZERO, Vec3::splat(sigma), 0.0, Density::Within(BOX)).expect("a medium");
            for sample in 0..SAMPLES {
                // exp(-sigma (d - 1)) is the threshold.
                let right = 1.0 - threshold(sample, least, ray.offset).ln() / sigma;
                let found = ray.distance(sample);
                assert!((found - right).abs() < 2e-4 * 3.0, "{sigma}, {sample}: {found}, not {right}");
                assert!((ray.passed_before(&medium, sample) - (right - 1.0)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn samples_are_where_density_is() {
        // Nothing in the first and the last third.
        let grid = DensityGrid::new(
            BOX,
            [30, 1, 1],
            (0..30).map(|x| f32::from(u8::from((10..20).contains(&x)))).collect(),
        );
        let ray = marched(Vec3::ONE, Density::Grid(grid.expect("a grid")), 512);
        assert!((ray.whole - 1.0).abs() < 0.02, "{ray:?}");
        assert!(
            (ray.distance(0) - 1.95).abs() < 0.02 && (ray.distance(SAMPLES - 1) - 3.05).abs() < 0.02,
            "{ray:?}"
        );
        assert!((0..SAMPLES - 1).all(|i| ray.distance(i) <= ray.distance(i + 1)));
        let thick = (0..SAMPLES).filter(|i| (2.0..3.0).contains(&ray.distance(*i))).count();
        assert!(thick >= SAMPLES - 3, "{thick}");
    }

    #[test]
    fn rays_that_meet_nothing_have_no_intervals() {
        let away = Bounds { min: Vec3::new(1.0, 2.0, -1.0), max: Vec3::new(4.0, 3.0, 1.0) };
        let ray = marched(Vec3::ONE, Density::Within(away), 16);
        assert_eq!((ray.whole, ray.distance(0), ray.distance(SAMPLES - 1)), (0.0, 0.0, 0.0));
        let nothing = marched(Vec3::ZERO, Density::Within(BOX), 16);
        assert_eq!((nothing.distance(0), nothing.whole), (1.0, nothing.whole));
    }

    #[test]
    fn a_medium_without_an_end_is_marched_as_far_as_it_is_seen() {
        let ray = marched(Vec3::new(1.0, 2.0, 4.0), Density::Everywhere, 512);
        assert!((ray.leaves - 16.0).abs() < 1e-3 && ray.distance(8) < 1.0, "{ray:?}");
    }
}
