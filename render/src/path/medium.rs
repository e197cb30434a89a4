//! Light on its way through a scene's medium: what passes, and where it is scattered.
//!
//! Where density is the same everywhere, transmittance and free flights have closed forms; through grids
//! there is ratio tracking (Novak, Selle and Jarosz 2014) and spectral delta tracking (Kutz et al. 2017).
//! Flights are sampled for all three colours at once: the colours' densities are mixed in proportion to what
//! light there is left of each, so that the sum over the colours of what is left never grows.
//!
//! A path tracer asks two questions of [`Media`]: how much light of a lamp passes to a point
//! ([`Media::transmittance`]), and whether a ray passes to the surface ahead or is scattered before
//! ([`Media::flight`]). Absorption is never sampled: it is in the weights.

mod lamps;
mod phase;
#[cfg(test)]
mod tests;
mod tracking;
mod uniform;

pub use phase::HenyeyGreenstein;
pub(super) use uniform::FreeFlight;

use crate::bvh::TracedScene;
use crate::intersection::SurfacePoint;
use crate::sampler::Stream;
use crate::scene::{Density, Light, Medium};
use glam::Vec3;
use lamps::Lamps;

/// Coordinates from which on their rounding is looked after, metres: below, it is some micrometres.
const COARSE: f32 = 100.0;

/// How far a wall is looked for, in parts of the way to a point: it may lie in the wall.
const BEYOND: f32 = 1.0001;

/// What fills a scene, if anything does.
#[derive(Clone, Copy, Debug)]
pub struct Media<'a> {
    medium: Option<&'a Medium>,
}

/// A piece of a ray that nothing but the medium is on.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// World space, metres.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Metres; infinite where no surface is ahead.
    pub length: f32,
}

/// What became of light that was followed along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Distance at which it was scattered; `None` where it passed to the end.
    pub scattered: Option<f32>,
    /// What it must be multiplied by, for each colour: the scattering coefficient and the transmittance up to
    /// there, over the probability density of being scattered there; or the transmittance of the segment over
    /// the probability of passing.
    pub weight: Vec3,
}

impl Segment {
    /// The point at a distance.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }

    /// The point at a distance, from which rays start. Far from the world's origin its coordinates are
    /// rounded so much that it may lie in or behind a wall that is near: there rays start before that wall.
    pub fn start_at(&self, distance: f32, scene: &TracedScene) -> Vec3 {
        let point = self.at(distance);
        let way = point - self.origin;
        if point.abs().max_element() < COARSE || way == Vec3::ZERO {
            return point;
        }
        let wall = scene.opaque_hit(self.origin, way, BEYOND);
        wall.map_or(point, |hit| SurfacePoint::new(scene, &hit, way.normalize()).ray_origin())
    }
}

impl Flight {
    /// Light that passed to the end.
    pub const fn passed(weight: Vec3) -> Self {
        Self { scattered: None, weight }
    }

    /// Light that was scattered at a distance.
    const fn scattered(distance: f32, weight: Vec3) -> Self {
        Self { scattered: Some(distance), weight }
    }
}

impl<'a> Media<'a> {
    /// What fills a scene.
    pub fn of(scene: &'a TracedScene) -> Self {
        Self { medium: scene.scene().medium.as_deref() }
    }

    /// How light is scattered; alike in all directions where there is nothing to scatter it.
    pub fn phase(&self) -> HenyeyGreenstein {
        HenyeyGreenstein::new(self.medium.map_or(0.0, |medium| medium.anisotropy))
    }

    /// Unbiased share of light that passes a segment, for each colour; exact where density is uniform.
    pub fn transmittance(&self, segment: &Segment, stream: &mut Stream) -> Vec3 {
        let Some((medium, [near, far])) = self.inside(segment) else { return Vec3::ONE };
        match &medium.density {
            Density::Grid(grid) => tracking::transmittance(
                medium,
                tracking::Walk::new(medium, grid, segment, [near, far], stream),
            ),
            _ => uniform::attenuation(medium.extinction(), far - near),
        }
    }

    /// Follows light along a segment until it is scattered or passes. `throughput` is what it was multiplied
    /// by before: colours of which little is left count little in the choice.
    pub fn flight(&self, segment: &Segment, throughput: Vec3, stream: &mut Stream) -> Flight {
        let Some((medium, [near, far])) = self.inside(segment) else { return Flight::passed(Vec3::ONE) };
        if medium.scattering == Vec3::ZERO || throughput == Vec3::ZERO {
            return Flight::passed(self.transmittance(segment, stream));
        }
        match &medium.density {
            Density::Grid(grid) => {
                let walk = tracking::Walk::new(medium, grid, segment, [near, far], stream);
                tracking::flight(medium, walk, throughput)
            }
            _ => uniform::flight(medium, [near, far], throughput, stream.next_2d()),
        }
    }

    /// Follows light that is scattered on a segment, with certainty: the weight is the scattering coefficient
    /// and the transmittance up to there over the density of the distance; nothing passes where nothing
    /// scatters. For effects that only want scattered light, of which there is little in thin fog.
    pub fn scattering(&self, segment: &Segment, throughput: Vec3, stream: &mut Stream) -> Flight {
        let Some((medium, [near, far])) = self.inside(segment) else { return Flight::passed(Vec3::ZERO) };
        match &medium.density {
            Density::Grid(grid) => {
                let walk = tracking::Walk::new(medium, grid, segment, [near, far], stream);
                tracking::scattering(medium, walk, throughput)
            }
            _ => uniform::scattering(medium, [near, far], throughput, stream.next_2d()),
        }
    }

    /// As [`Media::scattering`], for light that comes straight from `lights`: half of the distances are drawn
    /// by what lamps send there, and all are weighed by the balance heuristic (Veach 1997, 9.2.4). Of a grid
    /// the density of the other half is not known; that of a uniform medium with the grid's mean density
    /// stands for it, since any weights that add up to 1 keep the mean.
    pub fn scattering_of_lamps(
        &self,
        lights: &[Light],
        segment: &Segment,
        throughput: Vec3,
        stream: &mut Stream,
    ) -> Flight {
        let Some((medium, span)) = self.inside(segment) else { return Flight::passed(Vec3::ZERO) };
        let by_flight = uniform::Scattering::new(medium, medium.density.mean(), span, throughput);
        let (Some(by_flight), Some(by_lamps)) = (by_flight, Lamps::beside(lights, segment, span)) else {
            return self.scattering(segment, throughput, stream);
        };
        let at = stream.next_2d();
        if at.x < 0.5 {
            let distance = by_lamps.distance(at.y);
            let densities = 0.5 * (by_lamps.density(distance) + by_flight.density(distance));
            let before = Segment { length: distance, ..*segment };
            let density = medium.density.inside(segment.at(distance));
            let passing = self.transmittance(&before, stream);
            return Flight::scattered(distance, medium.scattering * density * passing / densities);
        }
        let flight = self.scattering(segment, throughput, stream);
        let Some(distance) = flight.scattered else { return flight };
        let density = by_flight.density(distance);
        let share = density / (0.5 * (by_lamps.density(distance) + density));
        Flight { weight: flight.weight * share, ..flight }
    }

    /// The part of a segment that is inside the medium.
    fn inside(&self, segment: &Segment) -> Option<(&'a Medium, [f32; 2])> {
        let medium = self.medium?;
        let span = medium.density.span(segment.origin, segment.direction, segment.length)?;
        Some((medium, span))
    }
}

/// Sum over the colours of light after a step, by which steps are chosen.
fn sum(light: Vec3) -> f32 {
    light.element_sum()
}
