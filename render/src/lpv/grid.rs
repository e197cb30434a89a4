//! Where the cells of a light propagation volume are.

use crate::scene::Bounds;
use deepshade_shaders::wgsl::uniforms;
use glam::{BVec3, IVec3, Vec3};

/// Cells around a scene, so that light beside its outermost surfaces has some.
const MARGIN: i32 = 1;

/// Most cells along an axis.
const MOST: i32 = 128;

/// How far from the border a finer grid begins to light what is in it, and from where on it does alone,
/// cells.
const FADES: [f32; 2] = [2.0, 4.0];

/// Fewest cells of a coarser grid that a finer one covers along an axis, if there are so many: with fewer the
/// grid in that one would light points which that one does not yet light alone.
const FEWEST_COVERED: i32 = 7;

/// Where there is no border, cells away.
const NOWHERE: f32 = 1e9;

/// Cubic cells around a scene, or around the camera in a coarser grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightGrid {
    /// The lowest corner, world space, metres.
    pub low: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// Cells along each axis.
    pub size: IVec3,
    /// At which faces, the lower and the upper one along each axis, a coarser grid hands light over: cells
    /// along these are the border. Beyond other faces is nothing.
    pub handed: [BVec3; 2],
}

impl LightGrid {
    /// Of so many cells along the longest edge of a box, margin included.
    pub fn around(bounds: Bounds, cells: usize) -> Self {
        let extent = bounds.size().max(Vec3::ZERO);
        let inner = (cells as i32 - 2 * MARGIN).clamp(1, MOST - 2 * MARGIN);
        let cell = (extent.max_element() / inner as f32).max(1e-6);
        let size = (extent / cell * 0.999).ceil().as_ivec3().max(IVec3::ONE) + 2 * MARGIN;
        let low = bounds.centre() - 0.5 * cell * size.as_vec3();
        Self { low, cell, size, handed: [BVec3::FALSE; 2] }
    }

    /// Cells of half the edge around a point: a cube of half the longest extent, or what of it lies within
    /// this grid, which begins and ends between its cells.
    pub fn nested(&self, focus: Vec3) -> Self {
        let half = (self.size.max_element() + 1) / 2;
        let covers = self.size.min(IVec3::splat(half.max(FEWEST_COVERED)));
        let begin = (self.in_cells(focus) - 0.5 * covers.as_vec3() + 0.5).floor();
        let begin = begin.max(Vec3::ZERO).min((self.size - covers).as_vec3());
        let ends = begin.as_ivec3() + covers;
        Self {
            low: self.low + self.cell * begin,
            cell: 0.5 * self.cell,
            size: 2 * covers,
            handed: [self.handed[0] | begin.cmpgt(Vec3::ZERO), self.handed[1] | ends.cmplt(self.size)],
        }
    }

    /// Where the borders are along each axis, cells from the lowest corner; far away where there are none.
    fn borders(&self) -> [Vec3; 2] {
        let nowhere = Vec3::splat(NOWHERE);
        [
            Vec3::select(self.handed[0], Vec3::ZERO, -nowhere),
            Vec3::select(self.handed[1], self.size.as_vec3(), nowhere),
        ]
    }

    /// Whether a coarser grid hands light over in a cell.
    pub fn is_border(&self, at: IVec3) -> bool {
        let [low, high] = self.handed;
        (low & at.cmpeq(IVec3::ZERO) | high & at.cmpeq(self.size - 1)).any()
    }

    /// The indices of the cells in which one does.
    pub fn border(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells()).filter(|index| self.is_border(self.at(*index)))
    }

    /// The first and the last cells along each axis that are not of the border.
    pub fn inner(&self) -> [IVec3; 2] {
        let [low, high] = self.handed.map(|faces| IVec3::select(faces, IVec3::ONE, IVec3::ZERO));
        [low, self.size - 1 - high]
    }

    /// How much a point of a grid is lit by it, and not by the one around it: nothing beside the border,
    /// where light of the other is handed over, and all farther in.
    pub fn share_of(&self, point: Vec3) -> f32 {
        let (at, [low, high]) = (self.in_cells(point), self.borders());
        let depth = (at - low).min(high - at).min_element();
        ((depth - FADES[0]) / (FADES[1] - FADES[0])).clamp(0.0, 1.0)
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// The index of a cell, x fastest; none outside.
    pub fn index(&self, at: IVec3) -> Option<usize> {
        let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(self.size).all();
        inside.then(|| ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize)
    }

    /// Where the cell of an index is.
    pub fn at(&self, index: usize) -> IVec3 {
        let index = index as i32;
        IVec3::new(
            index % self.size.x,
            index / self.size.x % self.size.y,
            index / (self.size.x * self.size.y),
        )
    }

    /// A point of world space in cells from the lowest corner.
    pub fn in_cells(&self, point: Vec3) -> Vec3 {
        (point - self.low) / self.cell
    }

    /// The middle of a cell, world space.
    pub fn middle(&self, at: IVec3) -> Vec3 {
        self.low + self.cell * (at.as_vec3() + 0.5)
    }

    /// As the passes read it.
    pub fn record(&self) -> uniforms::LightGrid {
        let [begins, ends] = self.borders().map(|border| border.extend(0.0).to_array());
        uniforms::LightGrid {
            low: self.low.extend(self.cell).to_array(),
            size: self.size.as_vec3().extend(self.cells() as f32).to_array(),
            begins,
            ends,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_holds_its_box_with_a_cell_to_spare() {
        let bounds = Bounds { min: Vec3::new(-3.0, 0.0, 1.0), max: Vec3::new(5.0, 2.0, 4.0) };
        let grid = LightGrid::around(bounds, 34);
        assert_eq!((grid.size, grid.cell), (IVec3::new(34, 10, 14), 0.25));
        let inner = |corner: Vec3| grid.in_cells(corner).cmpge(Vec3::splat(0.99)).all();
        assert!(inner(bounds.min) && (grid.size.as_vec3() - grid.in_cells(bounds.max)).min_element() > 0.99);
        assert!((0..grid.cells()).all(|i| grid.index(grid.at(i)) == Some(i)));
        assert_eq!(grid.index(IVec3::new(-1, 0, 0)), None);
        let nested = grid.nested(bounds.centre());
        assert_eq!((nested.size, nested.cell), (IVec3::new(34, 20, 28), 0.125), "a cube, cut off");
        assert_eq!(nested.handed, [BVec3::new(true, false, false); 2]);
        for focus in [bounds.min - 9.0, bounds.centre(), bounds.max + 9.0, Vec3::new(0.3, 1.1, 2.2)] {
            let nested = grid.nested(focus);
            let corners =
                [nested.low, nested.low + nested.cell * nested.size.as_vec3()].map(|at| grid.in_cells(at));
            assert!(corners.iter().all(|at| (at - at.round()).length() < 1e-4), "between cells: {corners:?}");
            assert!(
                corners[0].min_element() > -1e-4 && (grid.size.as_vec3() - corners[1]).min_element() > -1e-4
            );
        }
        let share = |x: f32| nested.share_of(nested.low + Vec3::new(x, 0.1, 0.8));
        assert_eq!([0.1, 0.375, 0.6, 2.0].map(share), [0.0, 0.5, 1.0, 1.0]);
        assert_eq!(grid.share_of(grid.low), 1.0, "the coarsest");
        let borders: Vec<_> = nested.border().collect();
        assert!(borders.len() == 2 * 20 * 28 && borders.iter().all(|i| nested.at(*i).x % 33 == 0));
        assert_eq!(nested.inner(), [IVec3::X, nested.size - 1 - IVec3::X]);
        let flat = LightGrid::around(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }, 1);
        assert!(flat.cells() == 27 && flat.cell > 0.0);
    }

    /// Where a grid has a share, the one around it has all of the rest.
    #[test]
    fn shares_of_any_number_of_grids_add_up_to_one() {
        let size = Vec3::new(9.0, 2.0, 6.0);
        let bounds = Bounds { min: -size, max: size };
        for cells in [4, 7, 11, 14, 15, 32, 33] {
            for focus in [Vec3::ZERO, size, 3.0 * size, Vec3::new(-8.0, 0.4, 2.9), Vec3::new(2.1, 9.0, 5.0)] {
                let coarsest = LightGrid::around(bounds, cells);
                let finer = |grid: &LightGrid| Some(grid.nested(focus));
                let grids: Vec<_> = std::iter::successors(Some(coarsest), finer).take(6).collect();
                for i in 0..6000 {
                    let at = IVec3::new(i % 20, i / 20 % 20, i / 400).as_vec3() + 0.5;
                    // Points ever nearer to the camera.
                    let near = focus.clamp(-size, size) + 0.5f32.powi(i % 7) * (at / 10.0 - 1.0) * size;
                    let shares: Vec<f32> = grids.iter().map(|grid| grid.share_of(near)).collect();
                    let apart = |pair: &[f32]| pair[1] * (1.0 - pair[0]) < 1e-3;
                    assert!(shares[0] == 1.0 && shares.windows(2).all(apart), "{cells} {focus}: {shares:?}");
                }
                let [low, high] = [Vec3::ZERO, coarsest.size.as_vec3()];
                let nearest = coarsest.low + coarsest.cell * coarsest.in_cells(focus).clamp(low, high);
                let finest = grids[5].share_of(nearest);
                assert!(finest == 1.0, "{cells} {focus}: {finest}");
            }
        }
    }
}
