//! An environment that is filtered for few samples: a small equirectangular map, laid out as
//! [`Environment`] is and turned as that is, its texels means over their solid angle.
//! [`EnvironmentMap::radiance`] is `shared/environment.wgsl` in Rust.

#[cfg(test)]
mod tests;

use crate::scene::Environment;
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Radiance for every direction, of which a small map of twice as many columns as rows knows means.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    height: usize,
    /// Row by row from the top, RGB.
    texels: Vec<Vec3>,
}

impl EnvironmentMap {
    /// Means of an environment over the texels of a map of `height` rows.
    pub fn new(environment: &Environment, height: usize) -> Self {
        // At least two samples along an edge of each of the environment's texels, so that none is missed.
        let [columns, rows] = environment.size();
        let samples = [columns.div_ceil(2 * height), rows.div_ceil(height)].map(|count| 2 * count);
        let texels = (0..2 * height * height)
            .into_par_iter()
            .map(|i| mean_over_texel(environment, height, [i % (2 * height), i / (2 * height)], samples))
            .collect();
        Self { height, texels }
    }

    /// A map of `height` rows of these texels, row by row from the top.
    pub(super) fn of_texels(height: usize, texels: Vec<Vec3>) -> Self {
        assert_eq!(texels.len(), 2 * height * height, "twice as many columns as rows");
        Self { height, texels }
    }

    /// The map of half the rows, an even number.
    pub(super) fn halved(&self) -> Self {
        let (height, width) = (self.height / 2, self.height);
        // The two rows that become one, by their solid angles.
        let weight = |row: usize| ((row as f32 + 0.5) * PI / self.height as f32).sin();
        let texel = |i: usize| {
            let (column, row) = (2 * (i % width), 2 * (i / width));
            let pair = |row: usize| {
                let first = row * 2 * self.height + column;
                0.5 * (self.texels[first] + self.texels[first + 1])
            };
            let (upper, lower) = (weight(row), weight(row + 1));
            (pair(row) * upper + pair(row + 1) * lower) / (upper + lower)
        };
        Self { height, texels: (0..width * height).map(texel).collect() }
    }

    /// Rows; there are twice as many columns.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// The texels as the GPU reads them, the fourth component unused.
    pub fn padded(&self) -> impl Iterator<Item = [f32; 4]> {
        self.texels.iter().map(|texel| texel.extend(0.0).to_array())
    }

    /// Radiance from a unit direction, bilinear between the middles of texels: columns start again, and
    /// beyond a pole is the other side, since level ground looks there.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let aside = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let longitude = direction.x.atan2(-direction.z) / TAU;
        let image = Vec2::new(longitude - longitude.floor(), aside.atan2(direction.y) / PI);
        let at = image * Vec2::new(2.0, 1.0) * self.height as f32 - 0.5;
        let corner = at.floor();
        let within = at - corner;
        let corner = corner.as_ivec2();
        let top = self.texel(corner).lerp(self.texel(corner + IVec2::X), within.x);
        let bottom = self.texel(corner + IVec2::Y).lerp(self.texel(corner + IVec2::ONE), within.x);
        top.lerp(bottom, within.y)
    }

    fn texel(&self, at: IVec2) -> Vec3 {
        let height = self.height as i32;
        let beyond = at.y < 0 || at.y >= height;
        let row = if beyond { (2 * height - 1 - at.y) % (2 * height) } else { at.y };
        let column = if beyond { at.x + height } else { at.x };
        self.texels[(row * 2 * height + (column + 2 * height) % (2 * height)) as usize]
    }
}

/// The direction of a point of the image, both coordinates in [0, 1].
pub fn direction_at(image: Vec2) -> Vec3 {
    let (aside, up) = (image.y * PI).sin_cos();
    let (sin, cos) = (image.x * TAU).sin_cos();
    Vec3::new(sin * aside, up, -cos * aside)
}

/// The mean over the solid angle of a texel, by a grid of samples.
fn mean_over_texel(
    environment: &Environment,
    height: usize,
    [column, row]: [usize; 2],
    [across, down]: [usize; 2],
) -> Vec3 {
    let extent = Vec2::new(2.0, 1.0) * height as f32;
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    for i in 0..across * down {
        let inside = Vec2::new((i % across) as f32 + 0.5, (i / across) as f32 + 0.5);
        let inside = inside / Vec2::new(across as f32, down as f32);
        let image = (Vec2::new(column as f32, row as f32) + inside) / extent;
        let weight = (image.y * PI).sin();
        sum += weight * environment.radiance(direction_at(image));
        weights += weight;
    }
    sum / weights
}
