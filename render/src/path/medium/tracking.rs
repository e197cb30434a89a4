//! Tracking through density grids. The medium is filled up to its largest extinction with fictitious matter
//! that changes nothing: collisions with both together are free flights through a uniform medium, and what
//! they were with is decided when they happen (Woodcock et al. 1965).

use super::{Flight, Segment, sum};
use crate::sampler::{Stream, hash};
use crate::scene::{DensityGrid, Medium};
use glam::Vec3;

/// Transmittance below which light goes on only with a probability, so that thick grids do not take for ever.
const FAINT: f32 = 0.05;

/// Tentative collisions along a ray: distances, with the density there in parts of the largest extinction.
pub(super) struct Walk<'a> {
    grid: &'a DensityGrid,
    segment: Segment,
    /// How far along the segment it is.
    distance: f32,
    /// Where it leaves the grid.
    far: f32,
    /// Largest extinction coefficient of all colours and cells, 1/m.
    majorant: f32,
    numbers: Numbers,
}

/// One collision with the medium or fictitious matter.
pub(super) struct Collision {
    /// Along the segment, metres.
    distance: f32,
    /// Probability, for each colour, that it scatters.
    scatters: Vec3,
    /// Probability, for each colour, that it was with fictitious matter.
    passes: Vec3,
}

impl<'a> Walk<'a> {
    /// The collisions between two distances on a segment.
    pub(super) fn new(
        medium: &Medium,
        grid: &'a DensityGrid,
        segment: &Segment,
        [near, far]: [f32; 2],
        stream: &mut Stream,
    ) -> Self {
        let majorant = medium.extinction().max_element() * grid.largest();
        Self { grid, segment: *segment, distance: near, far, majorant, numbers: Numbers::new(stream) }
    }

    /// The next collision before the end.
    fn next(&mut self, medium: &Medium) -> Option<Collision> {
        if self.majorant == 0.0 {
            return None;
        }
        self.distance -= (-self.numbers.next()).ln_1p() / self.majorant;
        if self.distance >= self.far {
            return None;
        }
        let density = self.grid.at(self.segment.at(self.distance)) / self.majorant;
        // Rounding may lift density above the largest by its last digit.
        let passes = (Vec3::ONE - medium.extinction() * density).max(Vec3::ZERO);
        Some(Collision { distance: self.distance, scatters: medium.scattering * density, passes })
    }

    /// Ends faint light with a probability; what goes on is as much brighter. Whether it goes on.
    fn roulette(&mut self, light: &mut Vec3) -> bool {
        let largest = light.max_element();
        if largest >= FAINT {
            return true;
        }
        *light *= 2.0;
        largest > 0.0 && self.numbers.next() < 0.5
    }
}

/// Ratio tracking: what is left after each collision that may have been with fictitious matter (Novak et al.
/// 2014).
pub(super) fn transmittance(medium: &Medium, mut walk: Walk<'_>) -> Vec3 {
    let mut left = Vec3::ONE;
    while let Some(collision) = walk.next(medium) {
        left *= collision.passes;
        if !walk.roulette(&mut left) {
            return Vec3::ZERO;
        }
    }
    left
}

/// Spectral tracking (Kutz et al. 2017): at each collision light is scattered or not in proportion to what it
/// would be in either case, summed over the colours, so that the sum of the weighted throughput never grows.
pub(super) fn flight(medium: &Medium, mut walk: Walk<'_>, throughput: Vec3) -> Flight {
    let mut weight = Vec3::ONE;
    while let Some(Collision { distance, scatters, passes }) = walk.next(medium) {
        let light = throughput * weight;
        let (scattered, passed) = (sum(light * scatters), sum(light * passes));
        let both = scattered + passed;
        if both <= 0.0 {
            return Flight::passed(Vec3::ZERO);
        }
        if walk.numbers.next() * both < scattered {
            return Flight::scattered(distance, weight * scatters * (both / scattered));
        }
        weight *= passes * (both / passed);
    }
    Flight::passed(weight)
}

/// One of all collisions of ratio tracking, chosen in proportion to the light that it scatters by a reservoir
/// of one (Chao 1982); weighed so that it stands for all of them.
pub(super) fn scattering(medium: &Medium, mut walk: Walk<'_>, throughput: Vec3) -> Flight {
    let mut left = Vec3::ONE;
    let mut total = 0.0;
    let mut chosen = Flight::passed(Vec3::ZERO);
    while let Some(Collision { distance, scatters, passes }) = walk.next(medium) {
        let weight = left * scatters;
        let light = sum(throughput * weight);
        total += light;
        if walk.numbers.next() * total < light {
            chosen = Flight::scattered(distance, weight / light);
        }
        left *= passes;
        if !walk.roulette(&mut left) {
            break;
        }
    }
    Flight { weight: chosen.weight * total, ..chosen }
}

/// Uniform numbers of one walk, which may take many: hashes of a number of the stream, so that what comes
/// after on a path keeps its place in the low-discrepancy sequence however many collisions there were.
struct Numbers {
    key: u32,
    taken: u32,
}

impl Numbers {
    fn new(stream: &mut Stream) -> Self {
        Self { key: hash(stream.next_1d().to_bits()), taken: 0 }
    }

    /// The next number, in [0, 1).
    fn next(&mut self) -> f32 {
        self.taken += 1;
        (hash(self.key ^ hash(self.taken)) >> 8) as f32 / 16_777_216.0
    }
}
