//! What shines from infinitely far away: equirectangular images, from Radiance HDR or OpenEXR files.
//!
//! y is up. Column `u` in [0, 1) and row `v` in [0, 1] of the image, from its top left corner, lie in the
//! direction `(sin(2 pi u) sin(pi v), cos(pi v), -cos(2 pi u) sin(pi v))`: the image's middle is +z, its left
//! and right edge -z, and a quarter from the left is +x, so that somebody inside sees the image unmirrored.
//! OpenEXR's latitude-longitude maps and Mitsuba's `envmap` are laid out alike.
//!
//! Radiance is bilinear between texel middles: columns start again, rows stay at the poles. Directions are
//! sampled from a density that is constant across each texel and proportional to the mean, over the texel and
//! the three colours, of that very interpolation, so that it is positive wherever there is light (Pharr,
//! Jakob and Humphreys, "Physically Based Rendering", 12.5 and A.5; theirs is constant in the image, ours in
//! solid angle).

mod cumulative;
mod directions;
mod file;
#[cfg(test)]
mod tests;

pub(crate) use cumulative::Cumulative;

use super::SceneError;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::path::Path;

/// The most texels along an edge.
const MAX_EDGE: usize = 16_384;

/// Radiance for every direction. A map without any light is allowed, and never sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    width: usize,
    height: usize,
    /// Row by row from the top, RGB.
    texels: Vec<Vec3>,
    /// Turned about the world's y axis, radians.
    rotation: f32,
    /// Over all directions.
    mean: Vec3,
    /// Which texel to look in; `None` without any light.
    distribution: Option<Distribution>,
    /// What was put right where it was read.
    warning: Option<String>,
}

/// Choice of a row, then of a column in it.
#[derive(Clone, Debug, PartialEq)]
struct Distribution {
    rows: Cumulative,
    /// Of each row; `None` of one without light.
    columns: Vec<Option<Cumulative>>,
}

/// A direction in which the environment shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit vector.
    pub direction: Vec3,
    /// From there.
    pub radiance: Vec3,
    /// With which the direction was taken, per steradian.
    pub density: f32,
}

impl Environment {
    /// Reads an equirectangular image: Radiance (.hdr) or OpenEXR (.exr; scan lines, tiles or mip maps,
    /// channels R, G and B or Y alone). Texels below 0 are taken as 0, which [`Environment::warning`] says.
    ///
    /// # Errors
    /// If the file is missing, damaged, taller than wide, absurdly large or of another format, or if a texel
    /// is not finite; the file and the texel are named.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let file::Image { width, height, mut texels, cropped } = file::read(path)?;
        if height > width {
            let what = format!("is {width} x {height}, not equirectangular, which is wider than tall");
            return Err(SceneError::invalid(path, what));
        }
        let put_right = [cropped, without_negative_light(&mut texels)].into_iter().flatten();
        let put_right = put_right.collect::<Vec<_>>().join("; ");
        let warning = (!put_right.is_empty()).then(|| format!("{}: {put_right}", path.display()));
        Ok(Self { warning, ..Self::new(path, width, height, texels)? })
    }

    /// What was put right where it was read, in a sentence that names the file.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// The same from every direction.
    ///
    /// # Panics
    /// If `radiance` is negative or not finite.
    pub fn uniform(radiance: Vec3) -> Self {
        Self::new("uniform environment".as_ref(), 1, 1, vec![radiance]).expect("a radiance")
    }

    /// An environment of texels, row by row from the top, called `name` in errors.
    ///
    /// # Errors
    /// If there are not `width * height` texels, none, more than 16,384 along an edge, or one is negative or
    /// not finite.
    pub fn new(name: &Path, width: usize, height: usize, texels: Vec<Vec3>) -> Result<Self, SceneError> {
        check_size(width, height).map_err(|what| SceneError::invalid(name, what))?;
        if texels.len() != width * height {
            let what = format!("has {} texels, not {width} x {height}", texels.len());
            return Err(SceneError::invalid(name, what));
        }
        let bad = |texel: &Vec3| !texel.is_finite() || texel.min_element() < 0.0;
        if let Some(index) = texels.iter().position(bad) {
            let [r, g, b] = texels[index].to_array();
            let (column, row) = (index % width, index / width);
            let what = format!("texel ({column}, {row}) is ({r}, {g}, {b}), not a radiance");
            return Err(SceneError::invalid(name, what));
        }
        let mut environment = Self {
            width,
            height,
            texels,
            rotation: 0.0,
            mean: Vec3::ZERO,
            distribution: None,
            warning: None,
        };
        environment.mean = environment.measured_mean();
        environment.distribution = environment.measured_distribution();
        Ok(environment)
    }

    /// The same environment, turned by an angle in radians about the world's y axis: +z towards +x.
    #[must_use]
    pub fn rotated(self, angle: f32) -> Self {
        Self { rotation: self.rotation + angle, ..self }
    }

    /// How far it is turned about the world's y axis, radians.
    pub const fn rotation(&self) -> f32 {
        self.rotation
    }

    /// Texels in a row and in a column.
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// Mean radiance over all directions.
    pub const fn mean(&self) -> Vec3 {
        self.mean
    }

    /// Radiance from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let at = self.image_of(direction) * self.extent() - 0.5;
        let corner = at.floor();
        let within = at - corner;
        let (x, y) = (corner.x as i64, corner.y as i64);
        let top = self.texel(x, y).lerp(self.texel(x + 1, y), within.x);
        let bottom = self.texel(x, y + 1).lerp(self.texel(x + 1, y + 1), within.x);
        top.lerp(bottom, within.y)
    }

    /// A direction to look for light in, from a point of the unit square; `None` without any light.
    pub fn sample(&self, square: Vec2) -> Option<EnvironmentSample> {
        let distribution = self.distribution.as_ref()?;
        let (row, down) = distribution.rows.sample(square.y);
        let (column, across) = distribution.columns[row].as_ref()?.sample(square.x);
        let u = (column as f32 + across) / self.width as f32;
        // Uniform in the cosine, so that the density is the same everywhere in the texel. Near the poles f32
        // could not tell cosines apart.
        let border = |row: usize| (std::f64::consts::PI * row as f64 / self.height as f64).cos();
        let cosine = border(row) + (border(row + 1) - border(row)) * f64::from(down);
        let direction = self.direction_at(u, cosine);
        let density = self.density_of_texel(column, row);
        Some(EnvironmentSample { direction, radiance: self.radiance(direction), density })
    }

    /// Density per steradian with which [`Environment::sample`] takes a unit direction.
    pub fn density(&self, direction: Vec3) -> f32 {
        let at = self.image_of(direction) * self.extent();
        let column = (at.x as usize).min(self.width - 1);
        let row = (at.y as usize).min(self.height - 1);
        self.density_of_texel(column, row)
    }

    fn density_of_texel(&self, column: usize, row: usize) -> f32 {
        let Some(distribution) = &self.distribution else { return 0.0 };
        let Some(columns) = &distribution.columns[row] else { return 0.0 };
        distribution.rows.probability(row) * columns.probability(column) / self.solid_angle(row)
    }

    fn extent(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// Where a direction is in the image, both in [0, 1].
    fn image_of(&self, direction: Vec3) -> Vec2 {
        let aside = direction.x.hypot(direction.z);
        let longitude = direction.x.atan2(-direction.z) + self.rotation;
        Vec2::new((longitude / TAU).rem_euclid(1.0), aside.atan2(direction.y) / PI)
    }

    /// The direction of a column in [0, 1) and a cosine to the vertical.
    fn direction_at(&self, u: f32, cosine: f64) -> Vec3 {
        let aside = (1.0 - cosine * cosine).max(0.0).sqrt() as f32;
        let (sin, cos) = (u * TAU - self.rotation).sin_cos();
        Vec3::new(sin * aside, cosine as f32, -cos * aside)
    }

    /// The texel of a column, which starts again, and a row, which stays at the poles.
    fn texel(&self, column: i64, row: i64) -> Vec3 {
        let column = column.rem_euclid(self.width as i64) as usize;
        let row = row.clamp(0, self.height as i64 - 1) as usize;
        self.texels[row * self.width + column]
    }

    /// Of one texel of a row, steradians. From the product, as the difference of cosines loses digits at the
    /// poles.
    fn solid_angle(&self, row: usize) -> f32 {
        let step = PI / self.height as f32;
        let difference = 2.0 * ((row as f32 + 0.5) * step).sin() * (0.5 * step).sin();
        difference * TAU / self.width as f32
    }

    fn measured_mean(&self) -> Vec3 {
        let mut sum = glam::DVec3::ZERO;
        for (row, texels) in self.texels.chunks_exact(self.width).enumerate() {
            let of_row: glam::DVec3 = texels.iter().map(|texel| texel.as_dvec3()).sum();
            sum += of_row * f64::from(self.solid_angle(row));
        }
        (sum / (4.0 * std::f64::consts::PI)).as_vec3()
    }

    fn measured_distribution(&self) -> Option<Distribution> {
        let columns: Vec<(f64, Option<Cumulative>)> = (0..self.height)
            .map(|row| {
                let weights: Vec<f64> =
                    (0..self.width).map(|column| self.interpolated_mean(column, row)).collect();
                let total = weights.iter().sum::<f64>() * f64::from(self.solid_angle(row));
                (total, Cumulative::new(weights.into_iter()))
            })
            .collect();
        let rows = Cumulative::new(columns.iter().map(|(total, _)| *total))?;
        Some(Distribution { rows, columns: columns.into_iter().map(|(_, columns)| columns).collect() })
    }

    /// Mean of the interpolated radiance over a texel and its colours: across the texel, its own tent has the
    /// integral 3/4 and each neighbour's 1/8.
    fn interpolated_mean(&self, column: usize, row: usize) -> f64 {
        let (column, row) = (column as i64, row as i64);
        let tent = |a: Vec3, b: Vec3, c: Vec3| 0.125 * a + 0.75 * b + 0.125 * c;
        let across = |row: i64| {
            tent(self.texel(column - 1, row), self.texel(column, row), self.texel(column + 1, row))
        };
        tent(across(row - 1), across(row), across(row + 1)).as_dvec3().element_sum() / 3.0
    }
}

/// Takes numbers below 0 as 0, such as filters with negative lobes leave beside bright spots; says how many
/// texels there were, if any.
fn without_negative_light(texels: &mut [Vec3]) -> Option<String> {
    let (mut count, mut least) = (0, 0.0f32);
    for texel in texels.iter_mut().filter(|texel| texel.is_finite() && texel.min_element() < 0.0) {
        (count, least) = (count + 1, least.min(texel.min_element()));
        *texel = texel.max(Vec3::ZERO);
    }
    (count > 0).then(|| format!("{count} texels below 0, down to {least:e}, are taken as 0"))
}

/// Whether a map of that size is accepted.
fn check_size(width: usize, height: usize) -> Result<(), String> {
    if width == 0 || height == 0 || width > MAX_EDGE || height > MAX_EDGE {
        return Err(format!("is {width} x {height} texels, where 1 to {MAX_EDGE} an edge are accepted"));
    }
    Ok(())
}
