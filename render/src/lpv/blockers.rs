//! Fuzzy blockers: how much of the light between neighbouring cells surfaces hold back.
//!
//! As in Kaplanyan and Dachsbacher 2010 they lie on a lattice of their own, shifted by half a cell, so that
//! what stands between the middles of cells is in one of its cubes. A cube keeps the matrix
//! `sum A n n^T / s^2` of its surfels' areas, unit normals and its edge, from which follows what they hide
//! along a direction, whichever way they face.

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
    /// `sum A colour / s^2`.
    colours: Vec<Vec3>,
}

impl Blockers {
    /// None yet, between the cells of a grid.
    pub fn new(grid: &LightGrid) -> Self {
        let cubes = LightGrid { low: grid.low - 0.5 * grid.cell, size: grid.size + 1, ..*grid };
        Self { cubes, matrices: vec![Mat3::ZERO; cubes.cells()], colours: vec![Vec3::ZERO; cubes.cells()] }
    }

    /// Adds a surface at a point, of an area, a unit normal, world space, and a diffuse reflectance.
    pub fn add(&mut self, point: Vec3, normal: Vec3, area: f32, colour: Vec3) {
        let at = self.cubes.in_cells(point).floor().as_ivec3();
        if let Some(index) = self.cubes.index(at) {
            let share = area / (self.cubes.cell * self.cubes.cell);
            self.colours[index] += share * colour;
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
                let passes = 1.0 - self.hidden(at, links[link].offset);
                (STEPS * passes + 0.5).floor() / STEPS
            };
            std::array::from_fn(passing)
        };
        (0..grid.cells()).into_par_iter().map(of_cell).collect()
    }

    /// Mean reflectance of the surfaces around each cell, by their areas: red, green and blue.
    pub fn reflectances(&self, grid: &LightGrid) -> Vec<[f32; 3]> {
        let of_cell = |index: usize| {
            let cubes = corners().filter_map(|corner| self.cubes.index(grid.at(index) + corner));
            let (mut colour, mut area) = (Vec3::ZERO, 0.0);
            for cube in cubes {
                colour += self.colours[cube];
                area += trace(self.matrices[cube]);
            }
            let colour = (colour / area.max(1e-30)).clamp(Vec3::ZERO, Vec3::ONE);
            ((STEPS * colour + 0.5).floor() / STEPS).to_array()
        };
        (0..grid.cells()).into_par_iter().map(of_cell).collect()
    }

    /// What is hidden between a cell and a neighbour: the mean of the cubes around the way.
    fn hidden(&self, at: IVec3, offset: IVec3) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for corner in corners() {
            // Along an axis of the way the cube between both cells, across it those on both sides.
            let around = offset.cmpeq(IVec3::ZERO) | corner.cmpeq((offset + 1) / 2);
            if around.all() {
                let matrix = self.cubes.index(at + corner).map_or(Mat3::ZERO, |index| self.matrices[index]);
                sum += opacity(matrix, offset.as_vec3());
                count += 1.0;
            }
        }
        sum / count
    }
}

/// The cubes around a cell, or around a link's way.
fn corners() -> impl Iterator<Item = IVec3> {
    (0..8).map(|i| IVec3::new(i & 1, i >> 1 & 1, i >> 2))
}

fn trace(matrix: Mat3) -> f32 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}

/// What surfaces of such a matrix hide on a way through their cube, in cells: of a plane how often it is
/// crossed, `A |n . way| / s^2`, exactly; of surfaces that face all ways alike 1.15 times that.
fn opacity(matrix: Mat3, way: Vec3) -> f32 {
    (trace(matrix) * way.dot(matrix * way)).max(0.0).sqrt().min(1.0)
}
