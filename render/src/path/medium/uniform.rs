//! Closed forms where density is 1 all along a ray.

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

/// A free flight: the colour whose path length it has is chosen in proportion to `throughput`, and the weight is that
/// of all colours' densities together (the balance heuristic of one sample, Veach 1997, 9.2.4).
pub(super) fn flight(medium: &Medium, [near, far]: [f32; 2], throughput: Vec3, at: Vec2) -> Flight {
    let extinction = medium.extinction();
    let chosen = extinction[colour(throughput, at.x)];
    let distance = -(-at.y).ln_1p() / chosen;
    if distance < far - near {
        let passing = attenuation(extinction, distance);
        let density = sum(throughput * extinction * passing) / sum(throughput);
        Flight::scattered(near + distance, medium.scattering * passing / density)
    } else {
        let passing = attenuation(extinction, far - near);
        Flight::passed(passing * sum(throughput) / sum(throughput * passing))
    }
}

/// A distance at which light is scattered, from the density of free flights that end before `far`; colours count as
/// much as of them is scattered.
pub(super) fn scattering(medium: &Medium, [near, far]: [f32; 2], throughput: Vec3, at: Vec2) -> Flight {
    let extinction = medium.extinction();
    let ending = depth(extinction, far - near).map(|depth| -(-depth).exp_m1());
    // Where a colour is only absorbed it needs no samples.
    let shares = throughput * ending * medium.scattering.map(|scattering| f32::from(scattering > 0.0));
    if sum(shares) <= 0.0 {
        return Flight::passed(Vec3::ZERO);
    }
    let chosen = colour(shares, at.x);
    let distance = -(-at.y * ending[chosen]).ln_1p() / extinction[chosen];
    let passing = attenuation(extinction, distance);
    let density =
        sum(shares * extinction * passing * ending.map(|ending| 1.0 / ending.max(f32::MIN_POSITIVE)));
    Flight::scattered(near + distance.min(far - near), medium.scattering * passing * sum(shares) / density)
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
