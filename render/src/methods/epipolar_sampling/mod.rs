//! `epipolar-sampling`: single scattering marched at few places along epipolar lines, interpolated between
//! them.
//!
//! Engelhardt and Dachsbacher 2010, "Epipolar Sampling for Shadows and Crepuscular Rays in Participating
//! Media with Single Scattering": along a line through the epipole scattered light varies little but where
//! the depth of what is seen jumps. Pixels are sorted into the slices of [`epipolar`](super::epipolar), each
//! into the nearest, and marched where a slice begins and ends, every few pixels between, and on both sides
//! of jumps; the others are between the two marched ones before and behind them. Lines are one pixel apart,
//! so that every pixel has its own place and depth in one: the authors' bilateral filter between coarser
//! lines is not needed.
//!
//! Why it: cheap where depths seldom jump. Why not: a shadow's edge that crosses a line where no depth jumps,
//! such as that of a narrow beam before a wall, is missed (Baran et al. 2010, Figure 13), and leaves make
//! depths jump everywhere.

use super::Quality;
use super::epipolar::{Geometry, Lines, beta};
use super::ray_march::March;
use super::shafts::{Integration, IntegrationInputs};
use glam::Vec3;
use rayon::prelude::*;

/// What it may take.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct EpipolarSamplingParameters {
    /// Pixels from one that is marched to the next along a line without jumps.
    #[schemars(range(min = 1, max = 256), extend("unit" = "pixels"))]
    pub spacing: usize,
    /// Share of a depth by which neighbours differ where it jumps.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub jump: f32,
    /// Steps of a march.
    #[schemars(range(min = 1, max = 8192))]
    pub steps: u32,
    /// Texels along an edge of a shadow map; the nested maps of a sun have as many together.
    #[schemars(range(min = 64, max = 8192), extend("unit" = "texels", "multipleOf" = 64))]
    pub shadow_size: usize,
}

/// Steps from each step of a march to the light, through grids.
const LIGHT_STEPS: u32 = 16;

impl EpipolarSamplingParameters {
    /// More time is more marched pixels and more steps.
    pub const fn of(quality: Quality) -> Self {
        let (spacing, steps, shadow_size) = match quality {
            Quality::Low => (32, 64, 1024),
            Quality::Medium => (16, 128, 1024),
            Quality::High => (16, 512, 2048),
            Quality::Ultra => (4, 2048, 4096),
        };
        Self { spacing, jump: 0.05, steps, shadow_size }
    }
}

impl Integration for EpipolarSamplingParameters {
    const NAME: &'static str = "epipolar-sampling";
    const WANTS_EVEN_FOG: bool = false;

    fn shadow_size(&self) -> usize {
        self.shadow_size
    }

    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]) {
        let march = March::new(lit, LIGHT_STEPS);
        let marched = |ray: usize| march.shifted(ray, self.steps);
        let Some(geometry) = Geometry::new(lit.rays.eye, lit.lamp.position) else {
            return march.add(self.steps, radiance);
        };
        let lines = Lines::new(lit.rays, &geometry);
        let found: Vec<_> =
            lines.all().map(|line| (line, self.line(line, lit, &geometry, marched))).collect();
        for (line, found) in found {
            for (ray, found) in line.iter().zip(found) {
                radiance[*ray as usize] += found;
            }
        }
    }
}

impl EpipolarSamplingParameters {
    /// Radiance of the pixels of a line, in its order.
    ///
    /// Towards a local lamp radiance grows as one over the sine of the angle to it: what is interpolated is
    /// its product with that.
    fn line(
        &self,
        line: &[u32],
        lit: &IntegrationInputs<'_>,
        geometry: &Geometry,
        marched: impl Fn(usize) -> Vec3,
    ) -> Vec<Vec3> {
        let of_pixel = |place: usize| geometry.direction(lit.rays.directions[line[place] as usize]);
        let sine = |place: usize| {
            if geometry.is_parallel() { 1.0 } else { of_pixel(place).aside.max(f32::MIN_POSITIVE) }
        };
        let angle = |place: usize| {
            let direction = of_pixel(place);
            beta(direction.along, direction.aside)
        };
        let mut found = vec![Vec3::ZERO; line.len()];
        let mut before: Option<usize> = None;
        for place in 0..line.len() {
            if !self.is_marched(line, place, before, lit) {
                continue;
            }
            found[place] = marched(line[place] as usize);
            if let Some(before) = before {
                let [first, last] = [before, place].map(|end| found[end] * sine(end));
                let [begin, end] = [before, place].map(angle);
                for (step, between) in found[before + 1..place].iter_mut().enumerate() {
                    let at = before + 1 + step;
                    let share = (angle(at) - begin) / (end - begin).max(f32::MIN_POSITIVE);
                    *between = first.lerp(last, share.min(1.0)) / sine(at);
                }
            }
            before = Some(place);
        }
        found
    }

    /// Whether a pixel is marched, `before` being the last that was.
    fn is_marched(
        &self,
        line: &[u32],
        place: usize,
        before: Option<usize>,
        lit: &IntegrationInputs<'_>,
    ) -> bool {
        let jumps = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|place| lit.rays.spans[line[place] as usize][1]);
            (a - b).abs() > self.jump * a.min(b)
        };
        let last = place + 1 == line.len();
        before.is_none_or(|before| place - before >= self.spacing)
            || last
            || jumps(place, place + 1)
            || jumps(place - 1, place)
    }
}
