//! What the plain versions of screen methods read of the sharp picture: `shared/picture.wgsl` in Rust.

use super::surface::vector;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{IVec2, Vec3};
use rayon::prelude::*;

/// Direct light and validity of every pixel.
#[derive(Clone, Debug)]
pub struct LightImage {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// [`Attribute::Light`], `[3, height, width]`, radiance.
    light: Planes,
    /// [`Attribute::Valid`], `[1, height, width]`.
    valid: Planes,
}

impl LightImage {
    /// The picture that a g-buffer holds.
    ///
    /// # Errors
    /// If the g-buffer lacks light or validity.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        Ok(Self {
            height: gbuffer.height(),
            width: gbuffer.width(),
            light: gbuffer.select(&[Attribute::Light])?,
            valid: gbuffer.select(&[Attribute::Valid])?,
        })
    }

    /// Whether a pixel is inside the image.
    pub fn contains(&self, at: IVec2) -> bool {
        at.cmpge(IVec2::ZERO).all() && (at.x as usize) < self.width && (at.y as usize) < self.height
    }

    /// Whether a surface is seen.
    pub fn valid_at(&self, at: IVec2) -> bool {
        shows_surface(self.valid.at(0, at.y as usize, at.x as usize))
    }

    /// Direct light, radiance; black where no surface is seen.
    pub fn light_at(&self, at: IVec2) -> Vec3 {
        if self.valid_at(at) { vector(&self.light, at) } else { Vec3::ZERO }
    }

    /// An image of this size of `value`, `[3, height, width]`.
    pub fn image(&self, value: impl Fn(IVec2) -> Vec3 + Sync) -> Planes {
        let pixels = every_pixel(self.height, self.width, value);
        Planes::from_fn(3, self.height, self.width, |c, y, x| pixels[y * self.width + x][c])
    }
}

/// `value` of every pixel of an image, row by row.
pub fn every_pixel<T: Send>(height: usize, width: usize, value: impl Fn(IVec2) -> T + Sync) -> Vec<T> {
    let pixel = |index: usize| IVec2::new((index % width) as i32, (index / width) as i32);
    (0..height * width).into_par_iter().map(|index| value(pixel(index))).collect()
}
