//! Procedural smoke: fractal noise in a box, thinning out towards its faces.

use super::{DensityGrid, MediumError};
use crate::scene::Bounds;
use crate::scene::procedural::noise::fbm;
use glam::Vec3;
use rayon::prelude::*;

/// Octaves of the noise.
const OCTAVES: u32 = 4;

/// Part of the way from the middle to a face after which smoke begins to thin out.
const THINS_FROM: f32 = 0.7;

/// Smallest billows, in parts of the largest coordinate: the noise counts them with 32-bit numbers.
const FINEST: f32 = 1e-6;

/// How smoke looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoke {
    /// The same seed makes the same smoke.
    pub seed: u32,
    /// Size of the largest billows, metres.
    pub billow: f32,
    /// Share of the box that there is smoke in, about: 0 for none, 1 for hardly a hole.
    pub cover: f32,
}

impl Smoke {
    /// Smoke in a box, with about `cells` cubic cells along its longest edge; densities from 0 to 1.
    ///
    /// # Errors
    /// If cover is not finite, billows are less than a millionth of the box's distance from the origin, or as
    /// [`DensityGrid::new`].
    pub fn grid(self, bounds: Bounds, cells: usize) -> Result<DensityGrid, MediumError> {
        super::check_box(bounds)?;
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let sound = self.cover.is_finite() && self.billow.is_finite() && self.billow >= FINEST * farthest;
        if !sound || self.billow <= 0.0 {
            return Err(MediumError::Smoke(self));
        }
        let edge = bounds.size().max_element() / cells.max(1) as f32;
        let size = bounds.size().to_array().map(|length| ((length / edge).round() as usize).max(1));
        let count = DensityGrid::cells(size)?;
        let step = bounds.size() / Vec3::from(size.map(|cells| cells as f32));
        let middle = |index: usize| {
            let cell = [index % size[0], index / size[0] % size[1], index / (size[0] * size[1])];
            bounds.min + (Vec3::from(cell.map(|cell| cell as f32)) + 0.5) * step
        };
        let value = |index| self.density(middle(index), bounds);
        DensityGrid::new(bounds, size, (0..count).into_par_iter().map(value).collect())
    }

    /// Density at a point of a box.
    fn density(self, point: Vec3, bounds: Bounds) -> f32 {
        /// Noise reaches about so far from its mean, 0.
        const REACH: f32 = 0.5;
        let aside = (2.0 * (point - bounds.centre()) / bounds.size()).abs().max_element();
        let edge = ((1.0 - aside) / (1.0 - THINS_FROM)).clamp(0.0, 1.0);
        let noise = fbm(self.seed, point / self.billow, OCTAVES) / REACH;
        let body = (0.5 * (noise - 1.0) + self.cover).clamp(0.0, 1.0);
        body * edge * edge * (3.0 - 2.0 * edge)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: Vec3::new(-2.0, 0.0, -1.0), max: Vec3::new(2.0, 2.0, 1.0) };
    const SMOKE: Smoke = Smoke { seed: 3, billow: 0.7, cover: 0.5 };

    #[test]
    fn a_seed_makes_the_same_smoke_and_another_seed_other_smoke() {
        let smoke = SMOKE.grid(BOX, 24).expect("smoke");
        assert_eq!(smoke, SMOKE.grid(BOX, 24).expect("smoke"));
        assert_ne!(smoke, Smoke { seed: 4, ..SMOKE }.grid(BOX, 24).expect("smoke"));
        assert_eq!(smoke.size(), [24, 12, 12]);
    }

    #[test]
    fn cover_is_about_the_share_of_the_box_with_smoke() {
        let share = |cover| {
            let grid = Smoke { cover, ..SMOKE }.grid(BOX, 32).expect("smoke");
            assert!(grid.largest() <= 1.0);
            let smoky = grid.values().iter().filter(|value| **value > 0.0).count();
            smoky as f32 / grid.values().len() as f32
        };
        assert_eq!(share(-1.0), 0.0);
        assert!((share(0.5) - 0.5).abs() < 0.1, "{}", share(0.5));
        assert!(share(1.0) > 0.9);
    }

    #[test]
    fn impossible_smoke_is_refused() {
        assert!(matches!(SMOKE.grid(Bounds::EMPTY, 8), Err(MediumError::Box(_))));
        assert!(matches!(SMOKE.grid(BOX, 1 << 20), Err(MediumError::Size(_))));
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(matches!(Smoke { billow: bad, ..SMOKE }.grid(BOX, 8), Err(MediumError::Smoke(_))));
        }
        assert!(matches!(Smoke { cover: f32::NAN, ..SMOKE }.grid(BOX, 8), Err(MediumError::Smoke(_))));
    }
}
