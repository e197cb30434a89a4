//! Participating media: what absorbs and scatters light between surfaces.
//!
//! Coefficients are RGB and density is one number (Pharr, Jakob and Humphreys, "Physically Based Rendering",
//! 11). A medium without a box reaches to infinity and swallows all light of the environment and of
//! directional lights: that is its defined result, a box lets them in.

mod array;
mod file;
mod grid;
mod vol;
mod weather;

pub use file::DensityFile;
pub use grid::DensityGrid;
pub use vol::write_vol;
pub use weather::{Weather, WeatherKind};

use super::Bounds;
use glam::Vec3;
use std::path::PathBuf;
use thiserror::Error;

/// Largest coefficient, 1/m: a mean free path of a micrometre, at which a medium is a surface.
pub const LARGEST_COEFFICIENT: f32 = 1e6;

/// Largest anisotropy: beyond it f32 hardly tells the directions of the phase function's peak apart.
const LARGEST_ANISOTROPY: f32 = 0.99;

/// Beyond so many mean free paths nothing is seen of a medium that is the same throughout.
const FARTHEST_DEPTH: f32 = 16.0;

/// Most collisions that tracking may expect along a diagonal of a grid's box, which is what a ray costs.
const MOST_COLLISIONS: f32 = 1e5;

/// Points of a lamp's way through a grid at which density is looked up.
pub const POINTS: u32 = 32;

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

/// Why a medium could not be had.
#[derive(Debug, Error)]
pub enum MediumError {
    /// A coefficient is negative, not a number, infinite or too large to be meant.
    #[error("{which} coefficients {value} /m of a medium: each must be from 0 to {LARGEST_COEFFICIENT:e}")]
    Coefficient {
        /// Absorption or scattering.
        which: &'static str,
        /// What was asked for.
        value: Vec3,
    },
    /// The mean cosine of the scattering angle is that of no phase function.
    #[error("anisotropy {0} of a medium: must be from -{LARGEST_ANISOTROPY} to {LARGEST_ANISOTROPY}")]
    Anisotropy(f32),
    /// The medium's box is empty, flat or not finite.
    #[error("a medium's box from {} to {} has no volume or is not finite", .0.min, .0.max)]
    Box(Bounds),
    /// The grid has no cell or more than are kept.
    #[error("a density grid of {} x {} x {} cells: there must be from 1 to {} cells", .0[0], .0[1], .0[2], DensityGrid::MOST_CELLS)]
    Size([usize; 3]),
    /// There are not as many values as cells.
    #[error("{values} densities for {cells} cells of a grid")]
    Count {
        /// How many values there are.
        values: usize,
        /// How many there should be.
        cells: usize,
    },
    /// A density is negative, not a number or infinite.
    #[error("density {value} at cell ({}, {}, {}) of a grid, along x, y and z: must be finite and not negative", cell[0], cell[1], cell[2])]
    Density {
        /// Along x, y and z.
        cell: [usize; 3],
        /// What was found.
        value: f32,
    },
    /// What noise cannot make.
    #[error(
        "{:?} at {time} s, with billows of {} m, cover {}, wind {} m/s and churn {} /s: not finite, too fine, \
         gone too far, or more than all",
        weather.kind, weather.billow, weather.cover, weather.wind, weather.churn
    )]
    Weather {
        /// What it was to be.
        weather: Weather,
        /// When, seconds.
        time: f32,
    },
    /// Light would collide too often in the densest part of the grid.
    #[error(
        "a medium with {0:e} mean free paths across its box at the largest density: at most {MOST_COLLISIONS:e}"
    )]
    Thick(f32),
    /// The file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is damaged or uses what is not supported.
    #[error("{path}: {what}")]
    File {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

impl Medium {
    /// A medium of these coefficients (1/m) and mean cosine of the scattering angle.
    ///
    /// # Errors
    /// As [`Medium::check`].
    pub fn new(
        absorption: Vec3,
        scattering: Vec3,
        anisotropy: f32,
        density: Density,
    ) -> Result<Self, MediumError> {
        let medium = Self { absorption, scattering, anisotropy, density };
        medium.check().map(|()| medium)
    }

    /// Whether light can be traced through it.
    ///
    /// # Errors
    /// If a coefficient is negative, not finite or above 1e6 /m; the anisotropy is not within +-0.99; the box
    /// has no volume; or tracking would expect more than 1e5 collisions across a grid.
    pub fn check(&self) -> Result<(), MediumError> {
        for (which, value) in [("absorption", self.absorption), ("scattering", self.scattering)] {
            if !value.to_array().iter().all(|value| (0.0..=LARGEST_COEFFICIENT).contains(value)) {
                return Err(MediumError::Coefficient { which, value });
            }
        }
        if !(-LARGEST_ANISOTROPY..=LARGEST_ANISOTROPY).contains(&self.anisotropy) {
            return Err(MediumError::Anisotropy(self.anisotropy));
        }
        match &self.density {
            Density::Everywhere => Ok(()),
            Density::Within(bounds) => check_box(*bounds),
            Density::Grid(grid) => {
                let collisions = self.extinction().max_element() * grid.largest() * grid.bounds().diagonal();
                if collisions <= MOST_COLLISIONS { Ok(()) } else { Err(MediumError::Thick(collisions)) }
            }
        }
    }

    /// Absorption and scattering together, 1/m at density 1.
    pub fn extinction(&self) -> Vec3 {
        self.absorption + self.scattering
    }

    /// The same for all colours: coefficients are their means.
    #[must_use]
    pub fn in_grey(&self) -> Self {
        let [absorption, scattering] =
            [self.absorption, self.scattering].map(|colours| Vec3::splat(colours.element_sum() / 3.0));
        Self { absorption, scattering, ..self.clone() }
    }

    /// Where a ray is in the medium, within `reach` along a unit direction, and no farther than anything is
    /// seen of a medium that is the same throughout; empty where it misses it.
    pub fn seen_span(&self, origin: Vec3, direction: Vec3, reach: f32) -> [f32; 2] {
        let [enters, leaves] = self.density.span(origin, direction, reach).unwrap_or([0.0; 2]);
        match self.density {
            Density::Grid(_) => [enters, leaves],
            _ => {
                let farthest = FARTHEST_DEPTH / self.extinction().min_element().max(1e-12);
                [enters, leaves.min(enters + farthest)]
            }
        }
    }

    /// Density times length along a piece of a ray, metres: exact where density is the same everywhere, else
    /// by so many points.
    pub fn passed_density(&self, origin: Vec3, direction: Vec3, reach: f32, points: u32) -> f32 {
        let [enters, leaves] = self.seen_span(origin, direction, reach);
        let length = (leaves - enters).max(0.0);
        let Density::Grid(grid) = &self.density else { return length };
        let step = length / points as f32;
        (0..points).map(|i| grid.at(origin + direction * (enters + (i as f32 + 0.5) * step))).sum::<f32>()
            * step
    }

    /// What of light passes along a piece of a ray, by so many points.
    pub fn passed_share(&self, origin: Vec3, direction: Vec3, reach: f32, points: u32) -> Vec3 {
        (-self.extinction() * self.passed_density(origin, direction, reach, points)).exp()
    }
}

impl Density {
    /// Where a ray is in the medium: from which distance to which, within `reach` along a unit direction.
    pub fn span(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<[f32; 2]> {
        match self {
            Self::Everywhere => Some([0.0, reach]),
            Self::Within(bounds) => clip(*bounds, origin, direction, reach),
            Self::Grid(grid) => clip(grid.bounds(), origin, direction, reach),
        }
    }

    /// The density at a point of the medium's box.
    pub fn inside(&self, point: Vec3) -> f32 {
        match self {
            Self::Everywhere | Self::Within(_) => 1.0,
            Self::Grid(grid) => grid.at(point),
        }
    }

    /// The largest density.
    pub const fn largest(&self) -> f32 {
        match self {
            Self::Everywhere | Self::Within(_) => 1.0,
            Self::Grid(grid) => grid.largest(),
        }
    }

    /// The mean density in the medium's box.
    pub const fn mean(&self) -> f32 {
        match self {
            Self::Everywhere | Self::Within(_) => 1.0,
            Self::Grid(grid) => grid.mean(),
        }
    }
}

/// The part of a ray inside a box, by the slab method (Kay and Kajiya 1986).
fn clip(bounds: Bounds, origin: Vec3, direction: Vec3, reach: f32) -> Option<[f32; 2]> {
    let (mut near, mut far) = (0.0f32, reach);
    for axis in 0..3 {
        let (low, high) = (bounds.min[axis] - origin[axis], bounds.max[axis] - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near < far).then_some([near, far])
}

/// Whether a box has a volume and all its corners are finite.
fn check_box(bounds: Bounds) -> Result<(), MediumError> {
    let sound = bounds.size().cmpgt(Vec3::ZERO).all() && bounds.diagonal().is_finite();
    if sound { Ok(()) } else { Err(MediumError::Box(bounds)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::scene::{Material, Mesh, Scene};

    const UNIT: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::ONE };

    fn error(absorption: Vec3, scattering: Vec3, anisotropy: f32, density: Density) -> String {
        Medium::new(absorption, scattering, anisotropy, density).expect_err("bad").to_string()
    }

    #[test]
    fn coefficients_that_light_cannot_have_are_refused() {
        for bad in [-1e-9, f32::NAN, f32::INFINITY, 2e6] {
            let value = Vec3::new(1.0, bad, 1.0);
            let absorption = error(value, Vec3::ONE, 0.0, Density::Everywhere);
            assert!(absorption.starts_with("absorption coefficients [1, "), "{absorption}");
            let scattering = error(Vec3::ONE, value, 0.0, Density::Everywhere);
            assert!(scattering.starts_with("scattering coefficients [1, "), "{scattering}");
        }
        for bad in [1.0, -1.0, 1.5, f32::NAN, f32::INFINITY] {
            assert!(error(Vec3::ONE, Vec3::ONE, bad, Density::Everywhere).starts_with("anisotropy"));
        }
        assert!(Medium::new(Vec3::ZERO, Vec3::ONE, -0.9, Density::Within(UNIT)).is_ok());
    }

    #[test]
    fn scenes_with_a_medium_that_light_cannot_have_are_not_traced() {
        let absorption = Vec3::new(1.0, f32::NAN, 1.0);
        let medium =
            Medium { absorption, scattering: Vec3::ONE, anisotropy: 0.0, density: Density::Everywhere };
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let scene = Scene {
            name: "murk".to_owned(),
            meshes: vec![Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() }].into(),
            materials: vec![Material::default()],
            medium: Some(medium.into()),
            ..Scene::default()
        };
        let error = TracedScene::new(scene).expect_err("a bad medium").to_string();
        assert!(error.starts_with("murk: absorption coefficients [1, NaN, 1]"), "{error}");
    }

    #[test]
    fn boxes_without_a_volume_are_refused() {
        let flat = Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) };
        let endless = Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, f32::INFINITY, 1.0) };
        let unknown = Bounds { min: Vec3::splat(f32::NAN), max: Vec3::ONE };
        for bad in [flat, endless, unknown, Bounds::EMPTY] {
            assert!(error(Vec3::ONE, Vec3::ONE, 0.0, Density::Within(bad)).starts_with("a medium's box"));
        }
    }

    #[test]
    fn a_grid_that_light_would_not_get_through_is_refused() {
        let grid = DensityGrid::new(UNIT, [1; 3], vec![1e4]).expect("a cell");
        assert!(error(Vec3::ZERO, Vec3::splat(10.0), 0.0, Density::Grid(grid)).contains("mean free paths"));
    }

    #[test]
    fn rays_are_clipped_to_the_box() {
        let within = Density::Within(UNIT);
        let middle = Vec3::new(-1.0, 0.5, 0.5);
        assert_eq!(within.span(middle, Vec3::X, 9.0), Some([1.0, 2.0]));
        assert_eq!(within.span(middle, Vec3::X, 1.5), Some([1.0, 1.5]));
        assert_eq!(within.span(middle, Vec3::X, 0.5), None);
        assert_eq!(within.span(middle, Vec3::NEG_X, 9.0), None);
        assert_eq!(within.span(Vec3::splat(0.25), Vec3::NEG_Y, 9.0), Some([0.0, 0.25]));
        assert_eq!(within.span(Vec3::new(-1.0, 1.5, 0.5), Vec3::X, 9.0), None);
        // Along a face, where a quotient would be 0 / 0.
        assert_eq!(within.span(Vec3::new(-1.0, 0.0, 1.0), Vec3::X, 9.0), Some([1.0, 2.0]));
        assert_eq!(Density::Everywhere.span(middle, Vec3::X, f32::INFINITY), Some([0.0, f32::INFINITY]));
    }
}
