//! Closed forms where density is the same all along a ray.

use super::{Flight, sum};
use crate::scene::Medium;
use glam::{Vec2, Vec3};

/// Share of light that passes a distance (Beer and Lambert); 1 where nothing stops it, however far.
pub(super) fn attenuation(extinction: Vec3, distance: f32) -> Vec3 {
    depth(extinction, distance).map(|depth| (-depth).exp())
}

/// Optical depth; 0 where nothing stops light, however far.
fn depth(extinction: Vec3, distance: f32) -> Vec3 {
    extinction.map(|extinction| if extinction > 0.0 { extinction * distance } else { 0.0 })
}

/// A flight as long as one colour chooses it, for all colours. The colour is chosen in proportion to the
/// throughput, and the weight is that of all colours' densities together (the balance heuristic of one
/// sample, Veach 1997, 9.2.4; Chiang, Kutz and Burley 2016, "Practical and controllable subsurface scattering
/// for production path tracing").
pub(in crate::path) struct FreeFlight {
    /// How far light flies if nothing is in the way, metres.
    pub(in crate::path) distance: f32,
    extinction: Vec3,
    throughput: Vec3,
}

impl FreeFlight {
    /// A flight of light that was multiplied by `throughput` before, from two uniform numbers.
    pub(in crate::path) fn new(extinction: Vec3, throughput: Vec3, at: Vec2) -> Self {
        let distance = -(-at.y).ln_1p() / extinction[colour(throughput, at.x)];
        Self { distance, extinction, throughput }
    }

    /// Weight of light that met something else at a distance: transmittance over the probability of flying so
    /// far.
    pub(in crate::path) fn passed(&self, distance: f32) -> Vec3 {
        let passing = attenuation(self.extinction, distance);
        passing * sum(self.throughput) / sum(self.throughput * passing)
    }

    /// Weight of light that collided at its end: transmittance over the density of the distance. Times the
    /// scattering coefficient it is that of light that goes on.
    pub(in crate::path) fn collided(&self) -> Vec3 {
        let passing = attenuation(self.extinction, self.distance);
        passing * sum(self.throughput) / sum(self.throughput * self.extinction * passing)
    }
}

/// A free flight on a part of a segment.
pub(super) fn flight(medium: &Medium, [near, far]: [f32; 2], throughput: Vec3, at: Vec2) -> Flight {
    let flight = FreeFlight::new(medium.extinction(), throughput, at);
    if flight.distance < far - near {
        Flight::scattered(near + flight.distance, medium.scattering * flight.collided())
    } else {
        Flight::passed(flight.passed(far - near))
    }
}

/// Distances at which light is scattered on a part of a segment, with the density of free flights that end
/// there; colours count as much as of them is scattered.
pub(super) struct Scattering {
    extinction: Vec3,
    span: [f32; 2],
    /// Share of light that collides, for each colour.
    colliding: Vec3,
    /// The colours' parts of the choice, not normalised.
    shares: Vec3,
}

impl Scattering {
    /// In a medium of that density; `None` where nothing is scattered.
    pub(super) fn new(medium: &Medium, density: f32, span: [f32; 2], throughput: Vec3) -> Option<Self> {
        let extinction = medium.extinction() * density;
        let colliding = depth(extinction, span[1] - span[0]).map(|depth| -(-depth).exp_m1());
        // Where a colour is only absorbed it needs no samples.
        let shares = throughput * colliding * medium.scattering.map(|scattering| f32::from(scattering > 0.0));
        (sum(shares) > 0.0).then_some(Self { extinction, span, colliding, shares })
    }

    /// A distance along the segment, from two uniform numbers.
    pub(super) fn distance(&self, at: Vec2) -> f32 {
        let chosen = colour(self.shares, at.x);
        let distance = -(-at.y * self.colliding[chosen]).ln_1p() / self.extinction[chosen];
        (self.span[0] + distance).min(self.span[1])
    }

    /// Density with which [`Scattering::distance`] takes a distance, 1/m.
    pub(super) fn density(&self, distance: f32) -> f32 {
        let ending = self.extinction * attenuation(self.extinction, distance - self.span[0]);
        sum(self.shares * ending / self.colliding.max(Vec3::splat(f32::MIN_POSITIVE))) / sum(self.shares)
    }
}

/// Light that is scattered on a part of a segment.
pub(super) fn scattering(medium: &Medium, span: [f32; 2], throughput: Vec3, at: Vec2) -> Flight {
    let Some(scattering) = Scattering::new(medium, 1.0, span, throughput) else {
        return Flight::passed(Vec3::ZERO);
    };
    let distance = scattering.distance(at);
    let passing = attenuation(medium.extinction(), distance - span[0]);
    Flight::scattered(distance, medium.scattering * passing / scattering.density(distance))
}

/// One of three colours, with probabilities in proportion to `shares`.
fn colour(shares: Vec3, at: f32) -> usize {
    let at = at * sum(shares);
    if at < shares.x {
        0
    } else if at < shares.x + shares.y || shares.z <= 0.0 {
        if shares.y > 0.0 { 1 } else { 0 }
    } else {
        2
    }
}
