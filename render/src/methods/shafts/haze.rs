//! A medium that is the same everywhere or everywhere in a box.

use crate::path::medium::HenyeyGreenstein;
use crate::scene::{Density, Medium};
use glam::Vec3;

/// Optical depth beyond which nothing is seen.
pub const DEEP: f32 = 16.0;

/// Why a method refuses a grid.
pub const UNEVEN: &str = "the medium is a grid, and it must be the same throughout";

/// A medium of uniform density.
#[derive(Clone, Copy, Debug)]
pub struct Haze<'a> {
    /// Share of light that is absorbed or scattered, 1/m, RGB.
    pub extinction: Vec3,
    /// Share that is scattered, 1/m, RGB.
    pub scattering: Vec3,
    /// Into which directions.
    pub phase: HenyeyGreenstein,
    density: &'a Density,
}

impl<'a> Haze<'a> {
    /// The medium, if it is the same throughout.
    pub fn of(medium: &'a Medium) -> Option<Self> {
        let uniform = !matches!(medium.density, Density::Grid(_));
        uniform.then(|| Self {
            extinction: medium.extinction(),
            scattering: medium.scattering,
            phase: HenyeyGreenstein::new(medium.anisotropy),
            density: &medium.density,
        })
    }

    /// Whether all colours are dimmed alike.
    pub fn is_grey(&self) -> bool {
        self.extinction == Vec3::splat(self.extinction.x)
    }

    /// From which distance to which a ray is in it, within `reach` along a unit direction.
    pub fn span(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<[f32; 2]> {
        self.density.span(origin, direction, reach)
    }

    /// Metres in it after which nothing is seen: a ten-millionth.
    pub fn deep(&self) -> f32 {
        DEEP / self.extinction.min_element()
    }

    /// The box that holds it; `None` without an end.
    pub const fn bounds(&self) -> Option<crate::scene::Bounds> {
        match self.density {
            Density::Within(bounds) => Some(*bounds),
            _ => None,
        }
    }

    /// How far light has travelled in it, metres, when it reaches a point inside: from `way` metres away,
    /// along a unit direction towards the light.
    pub fn way_in(&self, point: Vec3, towards: Vec3, way: f32) -> f32 {
        self.span(point, towards, way).map_or(0.0, |[near, far]| far - near)
    }
}
