//! A clear layer over a surface: KHR_materials_clearcoat. Truth of `path` has it; everything else sees the
//! surface below.

use super::material::read;
use super::{Texture, TextureSlot};
use glam::Vec2;
use std::sync::Arc;

/// The clear coat of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coat {
    /// How much of it there is, from 0 to 1.
    pub share: f32,
    /// Multiplies the share by its red.
    pub texture: Option<TextureSlot>,
    /// Perceptual roughness.
    pub roughness: f32,
    /// Multiplies the roughness by its green.
    pub roughness_texture: Option<TextureSlot>,
    /// Tangent-space normals of its own, with the scale of their x and y. Without them it is as smooth as the
    /// mesh, whatever the normals of the surface below.
    pub normal_texture: Option<(TextureSlot, f32)>,
}

/// The clear coat of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coating {
    /// How much of it there is, from 0 to 1.
    pub share: f32,
    /// Perceptual roughness.
    pub roughness: f32,
}

impl Coat {
    /// What it is at a point; `None` where there is none.
    pub(super) fn at(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Option<Coating> {
        let share = (self.share * read(self.texture, textures, uvs).x).clamp(0.0, 1.0);
        let roughness = (self.roughness * read(self.roughness_texture, textures, uvs).y).clamp(0.0, 1.0);
        (share > 0.0).then_some(Coating { share, roughness })
    }

    /// What it reads from textures.
    pub(super) fn textures(&self) -> [Option<TextureSlot>; 3] {
        [self.texture, self.roughness_texture, self.normal_texture.map(|(slot, _)| slot)]
    }
}
