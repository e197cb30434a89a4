//! The slow, plain version of `shade.wgsl`, kept so close to it that both can be read side by side.

use super::Filtered;
use super::filter::LEVELS;
use super::lobe::{ANGLES, EXPONENTS};
use crate::methods::surface::vector;
use crate::path::bsdf::Phong;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{IVec2, Vec3};

/// Radiance reflected to the eye, `[3, height, width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(gbuffer: &GBuffer, environment: &Filtered) -> Result<Planes, MissingAttribute> {
    let select = |attribute| gbuffer.select(&[attribute]);
    let [normal, viewer] = [select(Attribute::WorldNormal)?, select(Attribute::ToCamera)?];
    let [diffuse, specular] = [select(Attribute::Diffuse)?, select(Attribute::Specular)?];
    let [glossiness, valid] = [select(Attribute::Glossiness)?, select(Attribute::Valid)?];
    let (height, width) = (gbuffer.height(), gbuffer.width());
    let pixel = |i: usize| {
        if !shows_surface(valid.data()[i]) {
            return Vec3::ZERO;
        }
        let at = IVec2::new((i % width) as i32, (i / width) as i32);
        let (normal, viewer) = (vector(&normal, at), vector(&viewer, at));
        let cosine = normal.dot(viewer);
        let mirrored = 2.0 * cosine * normal - viewer;
        let lobe = environment.lobe(Phong::new(1.0 - glossiness.data()[i]).exponent(), cosine);
        let direction = mirrored.lerp(normal, lobe.y).normalize();
        let level = (lobe.z as usize).min(LEVELS - 2);
        let [coarse, fine] = [level, level + 1].map(|level| environment.maps[level].radiance(direction));
        let reflected = coarse.lerp(fine, lobe.z - level as f32);
        vector(&diffuse, at) * environment.maps[0].radiance(normal)
            + vector(&specular, at) * lobe.x * reflected
    };
    let pixels: Vec<Vec3> = (0..height * width).map(pixel).collect();
    Ok(Planes::from_fn(3, height, width, |c, y, x| pixels[y * width + x][c]))
}

impl Filtered {
    /// Energy, lean and level, bilinear in the table, by the cosine of the mirrored direction to the normal.
    fn lobe(&self, exponent: f32, cosine: f32) -> Vec3 {
        let row = (2.0 * (exponent + 1.0).log2()).clamp(0.0, (EXPONENTS - 1) as f32);
        let column = cosine.clamp(0.0, 1.0).sqrt() * (ANGLES - 1) as f32;
        let top = (row as usize).min(EXPONENTS - 2);
        let left = (column as usize).min(ANGLES - 2);
        let first = top * ANGLES + left;
        let upper = self.table[first].lerp(self.table[first + 1], column - left as f32);
        let lower = self.table[first + ANGLES].lerp(self.table[first + ANGLES + 1], column - left as f32);
        upper.lerp(lower, row - top as f32)
    }
}
