//! Light that surfaces send, kept apart by the side to which they send it.
//!
//! A cell keeps one lobe of a kind of light, so that beams which cross in it become one: weak light is turned
//! round by strong, and a dim corner gets too much. Light of six sides, each a kind of its own, superposes as
//! far as walls across the axes send it.
//!
//! Light begins on a surface half a cell before the middle of its cell. On the way from there a beam aside
//! gets half a cell along the wall: half of it reaches its own cell, the other half the next.

use super::Volume;
use super::lattice::{LINKS, Neighbour, SHARES, neighbours};
use super::lobe::MATTE;
use super::propagation::Light;
use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};

/// Along each axis, there and back.
pub const SIDES: usize = 6;

/// Walls that the light of a cell may come from: one that faces its flux, and one across each axis.
const WALLS: usize = 4;

/// What a matte surface sends along itself to a link, over the cosine: of 26 directions those beside the
/// surface stand for what is a little above it.
const ALONG: f32 = 0.1;

/// Light as it sets out from the middles of cells, of each side, and what is shown of the way there.
#[derive(Clone, Debug)]
pub struct Begun {
    /// `[sides, cells]`.
    pub sources: Vec<Vec<Light>>,
    /// Flux and energy times lengths of ways.
    pub halfway: Vec<Light>,
}

/// A wall that faces a direction and sends so much energy.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wall {
    normal: Vec3,
    energy: f32,
}

impl Begun {
    /// That of light which surfaces send, of cells.
    pub fn new(volume: &Volume, sent: &[Light]) -> Self {
        let none = vec![Light::default(); sent.len()];
        let mut begun = Self { sources: vec![none.clone(); SIDES], halfway: none };
        for (cell, light) in sent.iter().enumerate() {
            for (colour, light) in light.iter().enumerate() {
                for wall in walls(*light) {
                    begun.add(volume, (cell, colour), wall);
                }
            }
        }
        begun
    }

    /// Adds what a wall sends into a cell of a colour.
    fn add(&mut self, volume: &Volume, (cell, colour): (usize, usize), wall: Wall) {
        if wall.energy <= 0.0 {
            return;
        }
        let (side, at) = (side_of(wall.normal), volume.grid.at(cell));
        let flight = &volume.flights[cell][colour];
        let all: f32 = neighbours().map(|neighbour| share(&neighbour, wall.normal)).sum();
        for neighbour in neighbours() {
            let energy = wall.energy * share(&neighbour, wall.normal) / all;
            let light = neighbour.direction.extend(1.0);
            let Some(aside) = aside(&neighbour, side) else {
                self.sources[side][cell][colour] += light * energy;
                continue;
            };
            self.halfway[cell][colour] += light * (energy * flight.tracks_in[neighbour.class]);
            let half = light * (0.5 * energy * flight.enters[neighbour.class]);
            self.sources[side][cell][colour] += half;
            if let Some(next) = volume.grid.index(at + aside) {
                self.sources[side][next][colour] += half * passes(volume, cell, next, aside);
            }
        }
    }
}

/// The side to which a direction is nearest: x, -x, y and so on.
pub fn side_of(direction: Vec3) -> usize {
    let axis = direction.abs().max_position();
    2 * axis + usize::from(direction[axis] < 0.0)
}

/// The walls that send light of a flux and, last, an energy. That of matte walls across axes is the sum of
/// what each sends; more flux than that has a wall aslant.
fn walls(light: Vec4) -> [Wall; WALLS] {
    let (flux, energy) = (light.xyz(), light.w.max(0.0));
    let along = flux.abs();
    let sum = along.element_sum();
    if sum <= 0.0 {
        return [Wall { normal: Vec3::Y, energy: 0.0 }; WALLS];
    }
    let aslant = ((sum / (MATTE * energy.max(1e-37)) - 1.02) / 0.2).clamp(0.0, 1.0);
    let across = |axis: usize| Wall {
        normal: Vec3::AXES[axis] * flux[axis].signum(),
        energy: (1.0 - aslant) * energy * along[axis] / sum,
    };
    [Wall { normal: (flux / sum).normalize(), energy: aslant * energy }, across(0), across(1), across(2)]
}

/// What a wall sends to a neighbour, up to a factor.
fn share(neighbour: &Neighbour, normal: Vec3) -> f32 {
    let cosine = neighbour.direction.dot(normal);
    if cosine < -0.01 { 0.0 } else { SHARES[neighbour.class] * cosine.max(ALONG) }
}

/// By which cells along the wall of a side a link that leaves it goes aside; none of a link along it.
fn aside(neighbour: &Neighbour, side: usize) -> Option<IVec3> {
    let (axis, forward) = (side / 2, 1 - 2 * (side % 2) as i32);
    let mut aside = neighbour.offset;
    aside[axis] = 0;
    (neighbour.offset[axis] == forward).then_some(aside)
}

/// What passes between cells that are an offset apart, which may be none.
fn passes(volume: &Volume, from: usize, to: usize, offset: IVec3) -> f32 {
    match neighbours().position(|neighbour| neighbour.offset == offset) {
        None => 1.0,
        Some(link) if link < LINKS => volume.passing[to][LINKS - 1 - link],
        Some(link) => volume.passing[from][link - LINKS],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpv::studies::alike;
    use crate::lpv::{Flight, Scheme};

    fn matte(normal: Vec3, energy: f32) -> Vec4 {
        (MATTE * normal).extend(1.0) * energy
    }

    #[test]
    fn walls_across_axes_are_told_apart_and_one_aslant_is_one() {
        let walls_of = |light| walls(light).into_iter().filter(|wall| wall.energy > 1e-6);
        let both: Vec<_> = walls_of(matte(Vec3::X, 2.0) + matte(Vec3::NEG_Z, 1.0)).collect();
        assert_eq!(both.len(), 2, "{both:?}");
        assert!(both[0].normal == Vec3::X && (both[0].energy - 2.0).abs() < 1e-5, "{both:?}");
        assert!(both[1].normal == Vec3::NEG_Z && (both[1].energy - 1.0).abs() < 1e-5, "{both:?}");
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let one: Vec<_> = walls_of(matte(normal, 3.0)).collect();
        assert!(one.len() == 1 && one[0].normal.distance(normal) < 1e-6, "{one:?}");
        assert_eq!(walls_of(Vec4::ZERO).count(), 0);
    }

    #[test]
    fn all_light_sets_out_to_its_side_where_nothing_is_in_its_way() {
        let volume = alike(Scheme::OURS, IVec3::splat(5), Flight::new(0.0, 0.0));
        let mut sent = vec![Light::default(); volume.grid.cells()];
        sent[volume.grid.index(IVec3::splat(2)).expect("a cell")][1] = matte(Vec3::NEG_Y, 2.0);
        let begun = Begun::new(&volume, &sent);
        for (side, source) in begun.sources.iter().enumerate() {
            let energy: f32 = source.iter().map(|of| of[1].w).sum();
            assert!((energy - if side == 3 { 2.0 } else { 0.0 }).abs() < 1e-5, "{side}: {energy}");
            assert!(source.iter().all(|of| of[0] == Vec4::ZERO && of[2] == Vec4::ZERO));
        }
        let flux: Vec4 = begun.sources[3].iter().map(|of| of[1]).sum();
        assert!(flux.x.abs() < 1e-5 && flux.z.abs() < 1e-5 && flux.y < -1.2, "{flux}");
    }

    #[test]
    fn light_aside_is_stopped_by_what_is_beside_its_cell() {
        let mut volume = alike(Scheme::OURS, IVec3::splat(5), Flight::new(0.0, 0.0));
        volume.passing.fill([0.0; LINKS]);
        let mut sent = vec![Light::default(); volume.grid.cells()];
        let cell = volume.grid.index(IVec3::splat(2)).expect("a cell");
        sent[cell][0] = matte(Vec3::X, 1.0);
        let begun = Begun::new(&volume, &sent);
        let elsewhere = begun.sources[0].iter().enumerate().filter(|(at, _)| *at != cell);
        assert!(elsewhere.map(|(_, of)| of[0].w).sum::<f32>() == 0.0);
        assert!(begun.sources[0][cell][0].w > 0.3);
    }
}
