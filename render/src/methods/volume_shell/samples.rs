//! How the samples of a ray are kept, in plain Rust: `shared/intervals_encode_*` and
//! `shared/intervals_decode_*`.

use super::intervals::{Interval, March, Ray};
use crate::scene::Medium;
use glam::Vec3;

/// The largest share that 16 bits hold.
const WHOLE: f32 = 65_535.0;

/// The samples of a ray.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// As 16-bit shares of the way through the medium. Of each interval the albedo times the transmittance
    /// that falls within it is scattered in its middle: no density is looked up, and none is missed.
    Wide(Vec<u16>),
    /// As in the paper: of each interval its length times scattering coefficient and transmittance at its
    /// end.
    Paper {
        /// Steps of the march on the whole way.
        steps: u32,
        /// For each, so many since the one before.
        counts: Vec<u8>,
        /// Densities, over the ray's largest; that one over the medium's in the first one's place.
        densities: Vec<u8>,
    },
}

impl Samples {
    /// Keeps samples that lie at parts of steps.
    pub(super) fn kept(march: &March<'_>, found: &[(u32, f32)], is_wide: bool) -> Self {
        if !is_wide {
            return Self::counted(march, found);
        }
        let share = |(step, part): &(u32, f32)| (*step as f32 + part) / march.steps as f32;
        Self::Wide(found.iter().map(|at| (share(at) * WHOLE + 0.5) as u16).collect())
    }

    fn counted(march: &March<'_>, found: &[(u32, f32)]) -> Self {
        let (mut counts, mut densities, mut counted) = (Vec::new(), Vec::new(), 0);
        for (sample, (step, _)) in found.iter().enumerate() {
            // The first lies before a step, the others at its end.
            let passed = (step + u32::from(sample > 0) - counted).min(255);
            counted += passed;
            counts.push(passed as u8);
            densities.push(march.density(counted.max(1) - 1));
        }
        let whole = march.medium.density.largest();
        let most = densities[1..].iter().copied().fold(0.0, f32::max);
        // Rounded up, so that no density is above it.
        let largest = (255.0 * most / whole.max(1e-30)).ceil();
        let unit = largest * whole / 255.0;
        let mut densities: Vec<u8> =
            densities.iter().map(|density| (255.0 * density / unit.max(1e-30) + 0.5) as u8).collect();
        densities[0] = largest as u8;
        Self::Paper { steps: march.steps, counts, densities }
    }

    /// A sample's distance from the eye, metres.
    pub fn distance(&self, sample: usize, ray: &Ray) -> f32 {
        let way = ray.leaves - ray.enters;
        match self {
            Self::Wide(shares) => ray.enters + way.max(0.0) * f32::from(shares[sample]) / WHOLE,
            Self::Paper { steps, counts, .. } => {
                let passed: u32 = counts[..=sample].iter().copied().map(u32::from).sum();
                // The first step of a march is shorter than the others.
                ray.enters + (passed as f32 - 1.0 + ray.offset).max(0.0) * (way / *steps as f32)
            }
        }
    }

    /// What the intervals between them scatter.
    pub(super) fn intervals(&self, ray: &Ray, medium: &Medium) -> Vec<Interval> {
        match self {
            Self::Wide(shares) => {
                (1..shares.len()).map(|end| self.wide(end, shares.len(), ray, medium)).collect()
            }
            Self::Paper { densities, .. } => {
                let unit = f32::from(densities[0]) * medium.density.largest() / (255.0 * 255.0);
                let interval = |(end, density): (usize, &u8)| {
                    let [begins, distance] = [end - 1, end].map(|sample| self.distance(sample, ray));
                    let scattering = medium.scattering * f32::from(*density) * unit;
                    let passes =
                        (-medium.extinction() * ray.passed_before(medium, end, densities.len())).exp();
                    Interval { distance, weight: scattering * (distance - begins) * passes }
                };
                densities.iter().enumerate().skip(1).map(interval).collect()
            }
        }
    }

    fn wide(&self, end: usize, count: usize, ray: &Ray, medium: &Medium) -> Interval {
        let extinction = medium.extinction();
        let albedo = medium.scattering / extinction.max(Vec3::splat(1e-30));
        let [before, after] =
            [end - 1, end].map(|sample| (-extinction * ray.passed_before(medium, sample, count)).exp());
        let distance = 0.5 * (self.distance(end - 1, ray) + self.distance(end, ray));
        Interval { distance, weight: albedo * (before - after).max(Vec3::ZERO) }
    }
}
