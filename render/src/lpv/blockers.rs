//! Fuzzy blockers: how much of the light between neighbouring cells surfaces hold back.
//!
//! Kaplanyan and Dachsbacher 2010 keep what a cube's surfaces hide in each direction. Here each link from the
//! middle of a cell to that of a neighbour has a tube, whose section is what light along the link has to
//! itself: the tubes of all parallel links fill space once. A surface counts for the links in whose tubes it
//! lies, by the share of the section that it covers. So a wall that ends at another one hides all of a link
//! beside it, and of a link across the edge of both each hides its part; of one across a corner of three they
//! hide three quarters.

use super::LightGrid;
use super::lattice::{LINKS, neighbours};
use glam::{IVec3, Vec3};
use rayon::prelude::*;

/// What of a link's light passes is kept in so many steps.
const STEPS: f32 = 255.0;

/// The surfaces of a scene as cells see them.
#[derive(Clone, Debug)]
pub struct Blockers {
    grid: LightGrid,
    /// Of each cell and each link of which it is the first, the share of the tube's section that surfaces
    /// cover, one upon the other.
    covered: Vec<[f32; LINKS]>,
    /// Cubes between the middles of cells.
    cubes: LightGrid,
    /// Of each cube `sum A colour / s^2` and, last, `sum A / s^2`, of areas and the edge of a cell.
    colours: Vec<[f32; 4]>,
}

impl Blockers {
    /// None yet, between the cells of a grid.
    pub fn new(grid: &LightGrid) -> Self {
        let cubes = LightGrid { low: grid.low - 0.5 * grid.cell, size: grid.size + 1, ..*grid };
        let (covered, colours) = (vec![[0.0; LINKS]; grid.cells()], vec![[0.0; 4]; cubes.cells()]);
        Self { grid: *grid, covered, cubes, colours }
    }

    /// Adds a surface at a point, of an area, a unit normal, world space, and a diffuse reflectance.
    pub fn add(&mut self, point: Vec3, normal: Vec3, area: f32, colour: Vec3) {
        let share = area / (self.grid.cell * self.grid.cell);
        let at = self.grid.in_cells(point) - 0.5;
        for (link, neighbour) in neighbours().skip(LINKS).enumerate() {
            if let Some(cell) = self.grid.index(first_cell(at, normal, neighbour.offset)) {
                self.covered[cell][link] += share * normal.dot(neighbour.offset.as_vec3()).abs();
            }
        }
        if let Some(cube) = self.cubes.index(self.cubes.in_cells(point).floor().as_ivec3()) {
            let added = (share * colour).extend(share).to_array();
            self.colours[cube].iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
        }
    }

    /// What passes between cells and the neighbours of which each link counts one: `[cells, 13]`.
    pub fn passing(&self) -> Vec<[f32; LINKS]> {
        let passing = |covered: f32| (STEPS * (1.0 - covered.min(1.0)) + 0.5).floor() / STEPS;
        self.covered.iter().map(|covered| covered.map(passing)).collect()
    }

    /// Mean reflectance of the surfaces around each cell, by their areas: red, green and blue.
    pub fn reflectances(&self) -> Vec<[f32; 3]> {
        let of_cell = |index: usize| {
            let corners = (0..8).map(|i| IVec3::new(i & 1, i >> 1 & 1, i >> 2));
            let cubes = corners.filter_map(|corner| self.cubes.index(self.grid.at(index) + corner));
            let mut sums = [0.0; 4];
            for cube in cubes {
                sums.iter_mut().zip(self.colours[cube]).for_each(|(sum, of_cube)| *sum += of_cube);
            }
            let colour = Vec3::from_slice(&sums[..3]) / sums[3].max(1e-30);
            ((STEPS * colour.clamp(Vec3::ZERO, Vec3::ONE) + 0.5).floor() / STEPS).to_array()
        };
        (0..self.grid.cells()).into_par_iter().map(of_cell).collect()
    }
}

/// The cell from which the link of an offset goes whose tube a surface lies in, which may be outside of the
/// grid; the surface is at a place in cells of which the middles are whole numbers. Tubes are cut across the
/// axis that the surface faces most, so that a wall across an axis lies in one tube alone.
fn first_cell(at: Vec3, normal: Vec3, offset: IVec3) -> IVec3 {
    let (way, facing) = (offset.as_vec3(), normal.abs() * offset.abs().as_vec3());
    let axis = facing.max_position();
    let axis = if offset[axis] == 0 { way.abs().max_position() } else { axis };
    let along = at[axis] * way[axis];
    let gone = along - along.floor();
    let mut first = (at - gone * way + 0.5).floor().as_ivec3();
    first[axis] = along.floor() as i32 * offset[axis];
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: LightGrid = LightGrid { low: Vec3::ZERO, cell: 1.0, size: IVec3::new(6, 5, 4) };

    /// A wall across an axis at a height in cells, from a place on along the other axes.
    fn wall(blockers: &mut Blockers, axis: usize, height: f32, from: f32) {
        const FINE: i32 = 20;
        for i in 0..(9 * FINE) * (9 * FINE) {
            let (u, v) = (i % (9 * FINE), i / (9 * FINE));
            let [u, v] = [u, v].map(|i| from + (i as f32 + 0.5) / FINE as f32);
            let mut point = Vec3::splat(height);
            (point[(axis + 1) % 3], point[(axis + 2) % 3]) = (u, v);
            blockers.add(point, Vec3::AXES[axis], 1.0 / (FINE * FINE) as f32, Vec3::ONE);
        }
    }

    #[test]
    fn a_wall_hides_the_links_that_cross_it_and_no_others() {
        for (axis, height) in [(0, 3.0), (1, 1.8), (2, 2.3)] {
            let mut blockers = Blockers::new(&GRID);
            wall(&mut blockers, axis, height, -2.0);
            for (cell, passing) in blockers.passing().iter().enumerate() {
                for (neighbour, passes) in neighbours().skip(LINKS).zip(passing) {
                    let begins = GRID.at(cell)[axis] as f32 + 0.5 - height;
                    let crosses = begins * (begins + neighbour.offset[axis] as f32) < 0.0;
                    // Of small pieces one may lie in the next tube.
                    assert!(
                        (passes - if crosses { 0.0 } else { 1.0 }).abs() < 0.06,
                        "{axis} {neighbour:?} {passes}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_link_beside_the_end_of_a_wall_is_hidden_and_both_hide_that_across_their_edge() {
        let mut blockers = Blockers::new(&GRID);
        (0..3).for_each(|axis| wall(&mut blockers, axis, 2.0, 2.0));
        let passing = blockers.passing();
        let outside = IVec3::splat(1);
        for (link, neighbour) in
            neighbours().skip(LINKS).enumerate().filter(|(_, n)| n.offset.min_element() >= 0)
        {
            // From beside a wall into the room; from beyond an edge or its corner into its first cell.
            let from = IVec3::splat(2) - neighbour.offset;
            let passes = passing[GRID.index(from).expect("a cell")][link];
            let most = if neighbour.class == 2 { 0.28 } else { 0.06 };
            assert!(passes < most, "{neighbour:?}: {passes}");
        }
        // Where no wall is light passes.
        let ahead = neighbours().skip(LINKS).position(|neighbour| neighbour.offset == IVec3::X);
        assert_eq!(passing[GRID.index(outside).expect("a cell")][ahead.expect("a link")], 1.0);
    }
}
