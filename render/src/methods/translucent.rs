//! What the plain versions of subsurface scattering read: `shared/translucent.wgsl` in Rust.

use super::LightImage;
use super::surface::vector;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};
use glam::{IVec2, Vec3};

/// The picture, where its surfaces are, and how far light goes below them.
#[derive(Clone, Debug)]
pub struct Translucent {
    /// Direct light and validity.
    pub picture: LightImage,
    /// [`Attribute::Position`], `[3, height, width]`, camera space, metres.
    position: Planes,
    /// [`Attribute::MeanFreePath`], `[3, height, width]`, metres.
    mean_free_path: Planes,
}

impl Translucent {
    /// What a g-buffer holds of it.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        Ok(Self {
            picture: LightImage::of(gbuffer)?,
            position: gbuffer.select(&[Attribute::Position])?,
            mean_free_path: gbuffer.select(&[Attribute::MeanFreePath])?,
        })
    }

    /// Where the surface is, camera space, metres.
    pub fn position_at(&self, at: IVec2) -> Vec3 {
        vector(&self.position, at)
    }

    /// Mean free path of each colour, metres.
    pub fn mean_free_path_at(&self, at: IVec2) -> Vec3 {
        vector(&self.mean_free_path, at)
    }

    /// An image, `[3, height, width]`: where a colour goes below the surface, `gathered` of the pixel, the
    /// colour and its mean free path; elsewhere light as it is.
    pub fn image(&self, light: &Planes, gathered: impl Fn(IVec2, usize, f32) -> f32 + Sync) -> Planes {
        self.picture.image(|pixel| {
            if !self.picture.valid_at(pixel) {
                return Vec3::ZERO;
            }
            let lengths = self.mean_free_path_at(pixel);
            let colour = |channel: usize| match lengths[channel] {
                length if length > 0.0 => gathered(pixel, channel, length),
                _ => light.at(channel, pixel.y as usize, pixel.x as usize),
            };
            Vec3::new(colour(0), colour(1), colour(2))
        })
    }
}
