//! Where the cells of a light propagation volume are.

use crate::scene::Bounds;
use deepshade_shaders::wgsl::uniforms;
use glam::{IVec3, Vec3};

/// Cells around a scene, so that light beside its outermost surfaces has some.
const MARGIN: i32 = 1;

/// Most cells along an axis.
const MOST: i32 = 128;

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
        let flat = LightGrid::around(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }, 1);
        assert!(flat.cells() == 27 && flat.cell > 0.0);
    }
}
