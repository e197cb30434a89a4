//! The transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.1) in plain Rust: `intervals.wgsl`.

use super::samples::Samples;
use crate::path::medium::Segment;
use crate::scene::Medium;
use crate::screen::View;
use deepshade_shaders::random;
use deepshade_shaders::wgsl::uniforms;
use glam::{UVec2, Vec3};

/// How rays are divided.
#[derive(Clone, Copy, Debug)]
pub struct Division {
    /// Points of the way through the medium at which density is looked up.
    pub steps: u32,
    /// Distances that are kept, one more than intervals.
    pub samples: usize,
    /// Whether they are kept in the wide encoding, not in the paper's.
    pub is_wide: bool,
    /// Chooses random offsets; of no matter to the passes that are bound.
    pub seed: u32,
}

impl Division {
    /// What the march reads.
    pub fn marching(&self, view: &View) -> uniforms::Intervals {
        let (width, height) = (view.width as u32, view.height as u32);
        uniforms::Intervals { width, height, steps: self.steps, seed: self.seed }
    }
}

/// A ray's way through a medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    /// Where it enters it, metres.
    pub enters: f32,
    /// Where it leaves it or ends on a surface; no farther than the beginning where it misses it.
    pub leaves: f32,
    /// Its density times length, metres.
    pub whole: f32,
    /// The pixel's random offset.
    pub offset: f32,
    /// Distances between which the mean transmittance falls by equal parts.
    pub samples: Samples,
}

/// What is scattered in an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where, metres from the eye.
    pub distance: f32,
    /// What of it arrives at the eye, over the phase function and 1/sr.
    pub weight: Vec3,
}

/// A ray's way through the medium in steps.
pub(super) struct March<'a> {
    pub(super) medium: &'a Medium,
    segment: Segment,
    enters: f32,
    step: f32,
    pub(super) steps: u32,
    offset: f32,
}

impl March<'_> {
    /// Density at a step.
    pub(super) fn density(&self, step: u32) -> f32 {
        self.medium.density.inside(self.segment.at(self.enters + (step as f32 + self.offset) * self.step))
    }
}

impl Ray {
    /// Marches a pixel's ray.
    pub fn marched(medium: &Medium, segment: Segment, division: &Division, pixel: UVec2) -> Self {
        let [enters, leaves] = medium.seen_span(segment.origin, segment.direction, segment.length);
        let (steps, count) = (division.steps, division.samples);
        let step = (leaves - enters).max(0.0) / steps as f32;
        let offset = random::random(pixel.x, pixel.y, division.seed, 0);
        let march = March { medium, segment, enters, step, steps, offset };
        let whole = (0..steps).map(|i| march.density(i) * step).fold(0.0, |sum, here| sum + here);
        let least = mean_transmittance(medium, whole);
        let threshold = |sample| threshold(sample, count, least, offset);
        // Steps, and parts of them.
        let (mut found, mut passed) = (Vec::with_capacity(count), 0.0);
        for i in 0..steps {
            let here = march.density(i) * step;
            let before = mean_transmittance(medium, passed);
            passed += here;
            let after = mean_transmittance(medium, passed);
            while here > 0.0 && found.len() < count && after <= threshold(found.len()) {
                // Within a step transmittance falls evenly.
                let part = (before - threshold(found.len())) / (before - after).max(1e-30);
                found.push((i, part.clamp(0.0, 1.0)));
            }
        }
        // What rounding leaves is at the end.
        found.resize(count, (steps - 1, 1.0));
        Self { enters, leaves, whole, offset, samples: Samples::kept(&march, &found, division.is_wide) }
    }

    /// What its intervals scatter.
    pub fn intervals(&self, medium: &Medium) -> Vec<Interval> {
        self.samples.intervals(self, medium)
    }

    /// The density times length in front of one of so many samples.
    pub fn passed_before(&self, medium: &Medium, sample: usize, count: usize) -> f32 {
        if sample == count - 1 {
            return self.whole;
        }
        let least = mean_transmittance(medium, self.whole);
        let extinction = medium.extinction().element_sum() / 3.0;
        -threshold(sample, count, least, self.offset).ln() / extinction.max(1e-30)
    }
}

/// What passes so much density times length by the mean extinction of the colours.
pub fn mean_transmittance(medium: &Medium, passed: f32) -> f32 {
    (-medium.extinction().element_sum() / 3.0 * passed).exp()
}

/// The transmittance down to which one of so many samples is: 1 for the first, the least for the last, evenly
/// between, moved by a random part of an interval. (The paper counts from 1 and divides i, not i - 1, by n -
/// 1, so that the first would not be at 1.)
pub fn threshold(sample: usize, count: usize, least: f32, offset: f32) -> f32 {
    match sample {
        0 => 1.0,
        last if last == count - 1 => least,
        inner => 1.0 - (inner as f32 - offset) * (1.0 - least) / (count - 1) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Bounds, Density, DensityGrid};

    const COUNT: usize = 16;
    const BOX: Bounds = Bounds { min: Vec3::new(1.0, -1.0, -1.0), max: Vec3::new(4.0, 1.0, 1.0) };
    const ALONG: Segment = Segment { origin: Vec3::ZERO, direction: Vec3::X, length: f32::INFINITY };

    fn medium(extinction: Vec3, density: Density) -> Medium {
        Medium::new(0.25 * extinction, 0.75 * extinction, 0.0, density).expect("a medium")
    }

    fn marched(medium: &Medium, steps: u32, is_wide: bool) -> Ray {
        let division = Division { steps, samples: COUNT, is_wide, seed: 7 };
        Ray::marched(medium, ALONG, &division, UVec2::new(3, 5))
    }

    #[test]
    fn transmittance_of_a_slab_falls_by_equal_steps() {
        for sigma in [0.01, 0.5, 3.0] {
            let slab = medium(Vec3::splat(sigma), Density::Within(BOX));
            for is_wide in [true, false] {
                let steps = 250;
                let ray = marched(&slab, steps, is_wide);
                let least = (-3.0 * sigma).exp();
                assert!((ray.whole - 3.0).abs() < 1e-4, "{ray:?}");
                // 16 bits of the way; or a march's step.
                let exact = if is_wide { 2e-4 * 3.0 } else { 3.0 / steps as f32 };
                for sample in 0..COUNT {
                    // exp(-sigma (d - 1)) is the threshold.
                    let right = 1.0 - threshold(sample, COUNT, least, ray.offset).ln() / sigma;
                    let found = ray.samples.distance(sample, &ray);
                    assert!(
                        (found - right).abs() < exact,
                        "{sigma}, {is_wide}, {sample}: {found}, not {right}"
                    );
                    assert!((ray.passed_before(&slab, sample, COUNT) - (right - 1.0)).abs() < 1e-4);
                }
            }
        }
    }

    /// Light that is the same everywhere: a slab scatters albedo times (1 - exp(-sigma length)) of it to the
    /// eye.
    #[test]
    fn intervals_scatter_what_the_slab_does() {
        let sigma = Vec3::new(0.1, 0.5, 1.5);
        let slab = medium(sigma, Density::Within(BOX));
        let right = 0.75 * (Vec3::ONE - (-3.0 * sigma).exp());
        let sum = |is_wide| {
            marched(&slab, 250, is_wide).intervals(&slab).iter().map(|interval| interval.weight).sum::<Vec3>()
        };
        assert!((sum(true) - right).abs().max_element() < 1e-5, "{} and {right}", sum(true));
        // The paper's takes the transmittance at an interval's end, one in fifteen darker at most on the mean
        // of the colours.
        let paper = sum(false) / right;
        assert!(paper.max_element() < 1.0 && paper.min_element() > 0.85, "{paper}");
    }

    /// A layer of a thirtieth of the way, as thick as a slab: the paper's encoding, which counts steps,
    /// misses most of what it scatters, ours nothing.
    #[test]
    fn thin_layers_want_the_wide_encoding() {
        let layer = |x: usize| f32::from(u8::from(x == 15)) * 30.0;
        let grid = DensityGrid::new(BOX, [31, 1, 1], (0..31).map(layer).collect()).expect("a grid");
        let thin = medium(Vec3::ONE, Density::Grid(grid));
        let scattered = |is_wide: bool| -> f32 {
            let ray = marched(&thin, 60, is_wide);
            let right = 0.75 * (1.0 - (-ray.whole).exp());
            ray.intervals(&thin).iter().map(|interval| interval.weight.x).sum::<f32>() / right
        };
        assert!((scattered(true) - 1.0).abs() < 1e-4, "{}", scattered(true));
        assert!((scattered(false) - 1.0).abs() > 0.1, "{}", scattered(false));
    }

    #[test]
    fn more_than_255_steps_apart_the_paper_s_samples_fall_short() {
        // Nothing until four fifths of the way.
        let late = |x: usize| f32::from(u8::from(x >= 24));
        let grid = DensityGrid::new(BOX, [30, 1, 1], (0..30).map(late).collect()).expect("a grid");
        let late = medium(Vec3::ONE, Density::Grid(grid));
        let first = |steps, is_wide| {
            let ray = marched(&late, steps, is_wide);
            ray.samples.distance(0, &ray)
        };
        assert!((first(200, false) - 3.35).abs() < 0.05, "{}", first(200, false));
        assert!((first(1000, true) - 3.35).abs() < 0.05, "{}", first(1000, true));
        assert!((first(1000, false) - 1.765).abs() < 0.01, "{}", first(1000, false));
    }

    #[test]
    fn samples_are_where_density_is() {
        // Nothing in the first and the last third.
        let middle = |x: usize| f32::from(u8::from((10..20).contains(&x)));
        let grid = DensityGrid::new(BOX, [30, 1, 1], (0..30).map(middle).collect()).expect("a grid");
        let ray = marched(&medium(Vec3::ONE, Density::Grid(grid)), 512, true);
        let distance = |sample| ray.samples.distance(sample, &ray);
        assert!((ray.whole - 1.0).abs() < 0.02, "{ray:?}");
        assert!((distance(0) - 1.95).abs() < 0.02 && (distance(COUNT - 1) - 3.05).abs() < 0.02, "{ray:?}");
        assert!((0..COUNT - 1).all(|i| distance(i) <= distance(i + 1)));
        let thick = (0..COUNT).filter(|i| (2.0..3.0).contains(&distance(*i))).count();
        assert!(thick >= COUNT - 3, "{thick}");
    }

    #[test]
    fn rays_that_meet_nothing_have_no_intervals() {
        let away = Bounds { min: Vec3::new(1.0, 2.0, -1.0), max: Vec3::new(4.0, 3.0, 1.0) };
        for (extinction, density) in [(Vec3::ONE, Density::Within(away)), (Vec3::ZERO, Density::Within(BOX))]
        {
            let nothing = medium(extinction, density);
            for is_wide in [true, false] {
                let intervals = marched(&nothing, 16, is_wide).intervals(&nothing);
                assert!(intervals.iter().all(|interval| interval.weight == Vec3::ZERO), "{intervals:?}");
            }
        }
    }

    #[test]
    fn a_medium_without_an_end_is_marched_as_far_as_it_is_seen() {
        let ray = marched(&medium(Vec3::new(1.0, 2.0, 4.0), Density::Everywhere), 512, true);
        assert!((ray.leaves - 16.0).abs() < 1e-3 && ray.samples.distance(8, &ray) < 1.0, "{ray:?}");
    }
}
