//! Where the cells of a light propagation volume are.

use crate::scene::Bounds;
use deepshade_shaders::wgsl::uniforms;
use glam::{IVec3, Vec3};

/// Cells around a scene, so that light beside its outermost surfaces has some.
const MARGIN: i32 = 1;

/// Most cells along an axis.
const MOST: i32 = 128;

/// How far from the border a finer grid begins to light what is in it, and from where on it does alone,
/// cells.
pub const FADES: [f32; 2] = [2.0, 4.0];

/// Cubic cells around a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightGrid {
    /// The lowest corner, world space, metres.
    pub low: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// Cells along each axis.
    pub size: IVec3,
}

impl LightGrid {
    /// Of so many cells along the longest edge of a box, margin included.
    pub fn around(bounds: Bounds, cells: usize) -> Self {
        let extent = bounds.size().max(Vec3::ZERO);
        let inner = (cells as i32 - 2 * MARGIN).clamp(1, MOST - 2 * MARGIN);
        let cell = (extent.max_element() / inner as f32).max(1e-6);
        let size = (extent / cell * 0.999).ceil().as_ivec3().max(IVec3::ONE) + 2 * MARGIN;
        let low = bounds.centre() - 0.5 * cell * size.as_vec3();
        Self { low, cell, size }
    }

    /// As many cells of half the edge around a point: a box of half the extent, which begins and ends between
    /// cells of this grid and lies within it.
    pub fn nested(&self, focus: Vec3) -> Self {
        let covers = (self.size + 1) / 2;
        let begin = (self.in_cells(focus) - 0.5 * covers.as_vec3() + 0.5).floor();
        let begin = begin.max(Vec3::ZERO).min((self.size - covers).as_vec3());
        Self { low: self.low + self.cell * begin, cell: 0.5 * self.cell, size: 2 * covers }
    }

    /// The cells along the border.
    pub fn border(&self) -> impl Iterator<Item = usize> {
        let is_at_border = |at: IVec3| at.min(self.size - 1 - at).min_element() == 0;
        (0..self.cells()).filter(move |cell| is_at_border(self.at(*cell)))
    }

    /// How much a point of a finer grid is lit by it, and not by the one around it: nothing beside the
    /// border, where light of the other is handed over, and all farther in.
    pub fn share_of(&self, point: Vec3) -> f32 {
        let at = self.in_cells(point);
        let depth = at.min(self.size.as_vec3() - at).min_element();
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
        uniforms::LightGrid {
            low: self.low.extend(self.cell).to_array(),
            size: self.size.as_vec3().extend(self.cells() as f32).to_array(),
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
        assert_eq!((nested.size, nested.cell), (IVec3::new(34, 10, 14), 0.125));
        for focus in [bounds.min - 9.0, bounds.centre(), bounds.max + 9.0, Vec3::new(0.3, 1.1, 2.2)] {
            let nested = grid.nested(focus);
            let corners =
                [nested.low, nested.low + nested.cell * nested.size.as_vec3()].map(|at| grid.in_cells(at));
            assert!(corners.iter().all(|at| (at - at.round()).length() < 1e-4), "between cells: {corners:?}");
            assert!(
                corners[0].min_element() > -1e-4 && (grid.size.as_vec3() - corners[1]).min_element() > -1e-4
            );
        }
        assert_eq!(
            [0.1, 0.6, 2.0].map(|x| nested.share_of(nested.low + Vec3::new(x, 0.6, 0.8))),
            [0.0, 1.0, 1.0]
        );
        let flat = LightGrid::around(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }, 1);
        assert!(flat.cells() == 27 && flat.cell > 0.0);
    }
}
