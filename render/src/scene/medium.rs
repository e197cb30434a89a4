//! Participating media: what absorbs and scatters light between surfaces.

use super::Bounds;
use glam::Vec3;

/// What fills the space between surfaces. Its coefficients are those at density 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Absorption coefficient for each colour, 1/m.
    pub absorption: Vec3,
    /// Scattering coefficient for each colour, 1/m.
    pub scattering: Vec3,
    /// `g` of the Henyey-Greenstein phase function, mean cosine of the scattering angle, in (-1, 1).
    pub anisotropy: f32,
    /// How much of it there is where.
    pub density: Density,
}

/// How much of a medium there is where, relative to its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub enum Density {
    /// 1 everywhere.
    Everywhere,
    /// 1 inside a box, 0 outside.
    Within(Bounds),
    /// A grid's values inside its box, 0 outside.
    Grid(DensityGrid),
}

/// Density on a regular grid, trilinear between the middles of its cells.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityGrid {
    bounds: Bounds,
    /// Cells along x, y and z.
    size: [usize; 3],
    /// x fastest, then y, then z.
    values: Vec<f32>,
    /// The largest value.
    largest: f32,
}
