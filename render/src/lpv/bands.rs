//! Spherical harmonics by themselves: how light goes from cell to cell in two bands, as in Billeter, Sintorn and
//! Assarsson 2012, and in three, which they tried and left for the ringing. A study beside [`lobe`](super::lobe), which
//! is nowhere negative: here, where light is directed, some of what goes to neighbours is less than nothing.

use super::LightGrid;
use super::lattice::{Neighbour, SHARES, neighbours};
use glam::{IVec3, Mat3, Vec3};
use rayon::prelude::*;

/// How many bands there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bands {
    /// Energy and flux, four numbers.
    Two,
    /// With the second moments, nine numbers.
    Three,
}

/// Light in a cell: its moments.
#[derive(Clone, Copy, Debug)]
struct Moments {
    energy: f32,
    flux: Vec3,
    /// The mean of `w w^T - 1/3` over its energy, times that.
    second: Mat3,
}

/// What light of a point has come to without a medium.
#[derive(Clone, Copy, Debug)]
pub struct Ringing {
    /// Of all light that was handed on, the share that is negative.
    pub negative: f64,
    /// Flux along an axis, across an edge and across a corner, times `4 pi r^2`: 1 where light goes alike everywhere.
    pub flux: [f64; 3],
}

impl Moments {
    const NONE: Self = Self { energy: 0.0, flux: Vec3::ZERO, second: Mat3::ZERO };

    /// Those of light that has gone to a neighbour: of a cone as wide as its share of all directions.
    fn along(energy: f32, neighbour: &Neighbour) -> Self {
        let way = neighbour.direction;
        let [first, second] = cone(neighbour.class);
        let outer = Mat3::from_cols(way * way.x, way * way.y, way * way.z) - Mat3::IDENTITY * (1.0 / 3.0);
        Self { energy, flux: way * (first * energy), second: outer * (second * energy) }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            energy: self.energy + other.energy,
            flux: self.flux + other.flux,
            second: self.second + other.second,
        }
    }

    /// Energy towards a neighbour.
    fn towards(&self, bands: Bands, neighbour: &Neighbour) -> f32 {
        let way = neighbour.direction;
        let [first, second] = cone(neighbour.class);
        let third = if bands == Bands::Three { 7.5 * second * way.dot(self.second * way) } else { 0.0 };
        SHARES[neighbour.class] * (self.energy + 3.0 * first * self.flux.dot(way) + third)
    }
}

/// The means of the first two Legendre polynomials over a cone of a neighbour's share of all directions.
fn cone(class: usize) -> [f32; 2] {
    let end = 1.0 - 2.0 * SHARES[class];
    [0.5 * (1.0 + end), 0.5 * end * (1.0 + end)]
}

/// Hands the light of a point that sends alike in all directions on in a grid of `2 half + 1` cells to a side.
pub fn ringing(bands: Bands, half: i32) -> Ringing {
    let grid = LightGrid { low: Vec3::ZERO, cell: 1.0, size: IVec3::splat(2 * half + 1) };
    let mut light = vec![Moments::NONE; grid.cells()];
    let mut shown = vec![Vec3::ZERO; grid.cells()];
    if let Some(middle) = grid.index(IVec3::splat(half)) {
        light[middle].energy = 1.0;
    }
    let (mut negative, mut all) = (0.0, 0.0);
    for _ in 0..3 * half {
        let arriving = |cell: usize| {
            let (mut sum, mut lengths, mut handed) = (Moments::NONE, Vec3::ZERO, [0.0; 2]);
            for neighbour in neighbours() {
                let Some(from) = grid.index(grid.at(cell) - neighbour.offset) else { continue };
                let energy = light[from].towards(bands, &neighbour);
                let arrived = Moments::along(energy, &neighbour);
                sum = sum.plus(arrived);
                // Half of the way there is in the cell.
                lengths += arrived.flux * (0.5 * neighbour.offset.as_vec3().length());
                handed[0] += f64::from(energy.min(0.0).abs());
                handed[1] += f64::from(energy.abs());
            }
            for neighbour in neighbours() {
                let leaves = light[cell].towards(bands, &neighbour);
                lengths +=
                    Moments::along(leaves, &neighbour).flux * (0.5 * neighbour.offset.as_vec3().length());
            }
            (sum, lengths, handed)
        };
        let arrived: Vec<_> = (0..grid.cells()).into_par_iter().map(arriving).collect();
        for (cell, (moments, lengths, handed)) in arrived.into_iter().enumerate() {
            light[cell] = moments;
            shown[cell] += lengths;
            negative += handed[0];
            all += handed[1];
        }
    }
    let r = f64::from(half) * 0.6;
    let flux = [IVec3::X, IVec3::new(1, 1, 0), IVec3::ONE].map(|way| {
        let offset = (way.as_dvec3().normalize() * r).round().as_ivec3();
        let flux = grid.index(half + offset).map_or(0.0, |index| f64::from(shown[index].length()));
        4.0 * std::f64::consts::PI * offset.as_dvec3().length_squared() * flux
    });
    Ringing { negative: negative / all, flux }
}
