//! Light through surfaces that are no metals: KHR_materials_transmission, with what KHR_materials_volume says
//! of the body behind them. Truth of `path` has it; everything else takes such surfaces for opaque.

use super::{Texture, TextureSlot};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// What is behind a surface that light passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Walls {
    /// The same as before it: a pane, whose two sides bend light back.
    #[default]
    Thin,
    /// A body that a closed mesh bounds, in which light is bent.
    Solid {
        /// Share that is lost, `1 - e^-a` of each metre, of each colour.
        absorption: Vec3,
    },
}

/// How light passes a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmission {
    /// Share that passes, tinted by the base colour, of light that would meet the diffuse base.
    pub share: f32,
    /// Multiplies the share by its red.
    pub texture: Option<TextureSlot>,
    /// What is behind.
    pub walls: Walls,
}

/// How light passes one point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Share that passes, tinted by the diffuse colour; the rest is reflected diffusely.
    pub share: f32,
    /// Index of refraction.
    pub ior: f32,
    /// What is behind.
    pub walls: Walls,
}

impl Transmission {
    /// What it is at a point; `None` where nothing passes.
    pub(super) fn at(&self, ior: f32, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Option<Passage> {
        let share = self.share * super::material::read(self.texture, textures, uvs).x;
        let passage = Passage { share: share.clamp(0.0, 1.0), ior, walls: self.walls };
        (passage.share > 0.0).then_some(passage)
    }
}

/// What a colour that is left of white light after some metres says that each metre takes; nothing where the
/// colour is white or the way without an end.
pub fn absorption(colour: Vec3, metres: f32) -> Vec3 {
    // Black after a finite way would be infinite.
    let colour = colour.clamp(Vec3::splat(1e-6), Vec3::ONE);
    -colour.map(f32::ln) / metres
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_left_after_its_way() {
        let colour = Vec3::new(0.1, 0.5, 0.9);
        let left = (-2.0 * absorption(colour, 2.0)).map(f32::exp);
        assert!((left - colour).abs().max_element() < 1e-6, "{left}");
        assert_eq!(absorption(colour, f32::INFINITY), Vec3::ZERO);
        assert!(absorption(Vec3::ZERO, 1.0).is_finite());
    }
}
