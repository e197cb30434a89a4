//! Fuzzy blockers: how much of the light between neighbouring cells surfaces hold back.
//!
//! As in Kaplanyan and Dachsbacher 2010 they lie on a lattice of their own, shifted by half a cell, so that what stands between
//! the middles of cells is in one of its cubes. A cube keeps the matrix `sum A n n^T / s^2` of its surfels' areas, unit normals and
//! its edge: bands 0 and 2 of `sum A |n . w| / s^2`, what they hide along a direction, whose odd bands are 0 whichever way
//! surfaces face.

use super::LightGrid;
use super::lattice::{LINKS, neighbours};
use glam::{IVec3, Mat3, Vec3};
use rayon::prelude::*;

/// What of a link's light passes is kept in so many steps.
const STEPS: f32 = 255.0;

/// The surfaces of a scene as cells see them.
#[derive(Clone, Debug)]
pub struct Blockers {
    cubes: LightGrid,
    matrices: Vec<Mat3>,
}

impl Blockers {
    /// None yet, between the cells of a grid.
    pub fn new(grid: &LightGrid) -> Self {
        let cubes = LightGrid { low: grid.low - 0.5 * grid.cell, size: grid.size + 1, ..*grid };
        Self { cubes, matrices: vec![Mat3::ZERO; cubes.cells()] }
    }

    /// Adds a surface at a point, of an area and a unit normal, world space.
    pub fn add(&mut self, point: Vec3, normal: Vec3, area: f32) {
        let at = self.cubes.in_cells(point).floor().as_ivec3();
        if let Some(index) = self.cubes.index(at) {
            let share = area / (self.cubes.cell * self.cubes.cell);
            self.matrices[index] +=
                Mat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z) * share;
        }
    }

    /// What passes between cells and the neighbours of which each link counts one: `[cells, 13]`.
    pub fn passing(&self, grid: &LightGrid) -> Vec<[f32; LINKS]> {
        let links: Vec<_> = neighbours().skip(LINKS).collect();
        let of_cell = |index: usize| {
            let at = grid.at(index);
            let passing = |link: usize| {
                let passes = 1.0 - self.hidden(at, links[link].offset, links[link].direction);
                (STEPS * passes + 0.5).floor() / STEPS
            };
            std::array::from_fn(passing)
        };
        (0..grid.cells()).into_par_iter().map(of_cell).collect()
    }

    /// What is hidden between a cell and a neighbour: the mean of the cubes around the way.
    fn hidden(&self, at: IVec3, offset: IVec3, direction: Vec3) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for corner in 0..8 {
            let corner = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            // Along an axis of the way the cube between both cells, across it those on both sides.
            let around = offset.cmpeq(IVec3::ZERO) | corner.cmpeq((offset + 1) / 2);
            if around.all() {
                let matrix = self.cubes.index(at + corner).map_or(Mat3::ZERO, |index| self.matrices[index]);
                sum += opacity(matrix, direction);
                count += 1.0;
            }
        }
        sum / count
    }
}

/// What surfaces of such a matrix hide along a direction: `|c|` in bands 0 and 2 is `3/16 + 15/16 c^2`.
fn opacity(matrix: Mat3, direction: Vec3) -> f32 {
    let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    (3.0 / 16.0 * trace + 15.0 / 16.0 * direction.dot(matrix * direction)).clamp(0.0, 1.0)
}
