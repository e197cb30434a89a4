//! Density on a regular grid.

use super::{MediumError, check_box};
use crate::scene::Bounds;
use glam::{UVec3, Vec3};

/// Density on a regular grid, trilinear between the middles of its cells and constant beyond the outermost of
/// them, up to the box.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityGrid {
    bounds: Bounds,
    /// Cells along x, y and z.
    size: [usize; 3],
    /// x fastest, then y, then z.
    values: Vec<f32>,
    /// The largest value.
    largest: f32,
    /// The mean of the values.
    mean: f32,
    /// Cells a metre.
    scale: Vec3,
}

impl DensityGrid {
    /// The most cells of a grid: 512 along each edge, half a gibibyte.
    pub const MOST_CELLS: usize = 1 << 27;

    /// A grid of `size` cells along x, y and z that fill a box; `values` are those of their middles, x
    /// fastest, then y.
    ///
    /// # Errors
    /// If the box has no volume, there is no cell or more than [`DensityGrid::MOST_CELLS`], there are not as
    /// many values as cells, or one of them is negative or not finite.
    pub fn new(bounds: Bounds, size: [usize; 3], values: Vec<f32>) -> Result<Self, MediumError> {
        check_box(bounds)?;
        let cells = Self::cells(size)?;
        if values.len() != cells {
            return Err(MediumError::Count { values: values.len(), cells });
        }
        let sound = |value: f32| value >= 0.0 && value.is_finite();
        if let Some(index) = values.iter().position(|value| !sound(*value)) {
            let [x, y, _] = size;
            let cell = [index % x, index / x % y, index / (x * y)];
            return Err(MediumError::Density { cell, value: values[index] });
        }
        let largest = values.iter().copied().fold(0.0, f32::max);
        let mean = (values.iter().copied().map(f64::from).sum::<f64>() / cells as f64) as f32;
        let scale = Vec3::from(size.map(|cells| cells as f32)) / bounds.size();
        Ok(Self { bounds, size, values, largest, mean, scale })
    }

    /// The same in another box.
    ///
    /// # Errors
    /// If it has no volume.
    pub fn moved(&self, bounds: Bounds) -> Result<Self, MediumError> {
        Self::new(bounds, self.size, self.values.clone())
    }

    /// Number of cells of a grid of that size.
    ///
    /// # Errors
    /// If there is no cell or more than [`DensityGrid::MOST_CELLS`].
    pub(super) fn cells(size: [usize; 3]) -> Result<usize, MediumError> {
        let product = size.iter().try_fold(1usize, |product, cells| product.checked_mul(*cells));
        product.filter(|cells| (1..=Self::MOST_CELLS).contains(cells)).ok_or(MediumError::Size(size))
    }

    /// The box that the cells fill.
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Cells along x, y and z.
    pub const fn size(&self) -> [usize; 3] {
        self.size
    }

    /// The values of the cells' middles, x fastest, then y, then z.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The largest value: no density anywhere is above it.
    pub const fn largest(&self) -> f32 {
        self.largest
    }

    /// The mean of the values.
    pub const fn mean(&self) -> f32 {
        self.mean
    }

    /// Density at a point of the box.
    pub fn at(&self, point: Vec3) -> f32 {
        let last = UVec3::from(self.size.map(|cells| cells as u32 - 1));
        let at = ((point - self.bounds.min) * self.scale - 0.5).clamp(Vec3::ZERO, last.as_vec3());
        let low = at.as_uvec3();
        let high = (low + 1).min(last);
        let within = at - low.as_vec3();
        let value = |x: u32, y: u32, z: u32| {
            self.values[(z as usize * self.size[1] + y as usize) * self.size[0] + x as usize]
        };
        let along_x = |y, z| mix(value(low.x, y, z), value(high.x, y, z), within.x);
        let along_y = |z| mix(along_x(low.y, z), along_x(high.y, z), within.y);
        mix(along_y(low.z), along_y(high.z), within.z)
    }
}

fn mix(a: f32, b: f32, weight: f32) -> f32 {
    a + (b - a) * weight
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds() -> Bounds {
        Bounds { min: Vec3::new(-1.0, 2.0, 0.5), max: Vec3::new(3.0, 5.0, 2.5) }
    }

    #[test]
    fn a_linear_density_is_met_between_the_middles() {
        let size = [4, 3, 2];
        let linear = |point: Vec3| 10.0 + point.dot(Vec3::new(1.0, -0.5, 2.0));
        let middle = |x: usize, y: usize, z: usize| {
            let cells = Vec3::new(x as f32, y as f32, z as f32) + 0.5;
            bounds().min + cells * bounds().size() / Vec3::new(4.0, 3.0, 2.0)
        };
        let cells = (0..24).map(|i| middle(i % 4, i / 4 % 3, i / 12));
        let grid = DensityGrid::new(bounds(), size, cells.map(linear).collect()).expect("a grid");
        for i in 0..64 {
            let share = Vec3::new((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) / 3.0;
            let point = middle(0, 0, 0) + share * (middle(3, 2, 1) - middle(0, 0, 0));
            assert!((grid.at(point) - linear(point)).abs() < 1e-4, "{point}");
        }
        // Constant beyond the outermost middles.
        assert_eq!(grid.at(bounds().min), linear(middle(0, 0, 0)));
        assert_eq!(grid.at(bounds().max), linear(middle(3, 2, 1)));
        assert_eq!(grid.largest(), linear(middle(3, 0, 1)));
    }

    #[test]
    fn damaged_grids_are_refused_with_the_cell_named() {
        for bad in [-0.5, f32::NAN, f32::INFINITY] {
            let mut values = vec![1.0; 24];
            values[3 + 4 * (2 + 3)] = bad;
            let error = DensityGrid::new(bounds(), [4, 3, 2], values).expect_err("a bad density").to_string();
            assert!(error.starts_with(&format!("density {bad} at cell (3, 2, 1)")), "{error}");
        }
        let error = |size, count| {
            DensityGrid::new(bounds(), size, vec![1.0; count]).expect_err("a bad size").to_string()
        };
        assert!(error([4, 3, 2], 23).starts_with("23 densities for 24 cells"));
        assert!(error([0, 3, 2], 0).starts_with("a density grid of 0 x 3 x 2 cells"));
        assert!(error([1 << 20, 1 << 20, 1], 1).starts_with("a density grid of 1048576 x"));
        assert!(error([usize::MAX, 2, 2], 1).starts_with("a density grid of"));
        let flat = Bounds { max: bounds().min, ..bounds() };
        assert!(matches!(DensityGrid::new(flat, [1; 3], vec![1.0]), Err(MediumError::Box(_))));
    }
}
