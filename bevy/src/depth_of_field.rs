//! The component of depth of field.

use crate::effect::{LearnedEffect, Reach};
use crate::{LearnedError, LearnedShading};
use bevy::camera::Hdr;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault};
use bevy::render::RenderApp;
use bevy::render::sync_component::SyncComponent;
use deepshade_render::scene::Lens;
use deepshade_shaders::{Attribute, Effect};

/// Depth of field by a network, for a `Camera3d` with `Msaa::Off` and a perspective projection: what it draws
/// is seen through a thin lens. It runs after the main passes and before bloom and tonemapping.
#[derive(Clone, Copy, Component, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(DepthPrepass, Hdr)]
pub struct LearnedDepthOfField {
    /// Distance of the plane in focus along the viewing direction, in the world's unit; above 0.
    pub focal_distance: f32,
    /// Radius of the lens, in the world's unit. At 0 all is sharp, and nothing runs.
    pub aperture_radius: f32,
}

impl Default for LearnedDepthOfField {
    /// A lens of five centimetres, two metres away from what it shows sharply.
    fn default() -> Self {
        Self { focal_distance: 2.0, aperture_radius: 0.025 }
    }
}

impl LearnedDepthOfField {
    /// Checks what can be set.
    ///
    /// # Errors
    /// If the distance or the radius is no length.
    pub fn check(&self) -> Result<(), LearnedError> {
        let Self { focal_distance, aperture_radius } = *self;
        if !(focal_distance.is_finite() && focal_distance > 0.0) {
            return Err(LearnedError::FocalDistance(focal_distance));
        }
        match aperture_radius.is_finite() && aperture_radius >= 0.0 {
            true => Ok(()),
            false => Err(LearnedError::ApertureRadius(aperture_radius)),
        }
    }
}

impl SyncComponent<RenderApp> for LearnedDepthOfField {
    type Target = (Self, LearnedShading<Self>);
}

impl LearnedEffect for LearnedDepthOfField {
    const COMPONENT: &'static str = "LearnedDepthOfField";
    const EFFECT: Effect = Effect::Dof;
    const SHOWN: &'static [Attribute] =
        &[Attribute::Light, Attribute::Depth, Attribute::Blurriness, Attribute::Valid];
    type OfBevy = ();

    fn folder(&self) -> &'static str {
        "dof"
    }

    fn checked(&self) -> Result<(), LearnedError> {
        self.check()
    }

    fn reach(&self) -> Reach {
        let lens = Lens { radius: self.aperture_radius, focus: self.focal_distance };
        // Circles of confusion follow from the lens alone.
        Reach { radius: 1.0, lens: Some(lens) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lens_has_lengths() {
        let checked = |focal_distance, aperture_radius| {
            LearnedDepthOfField { focal_distance, aperture_radius }.check().map_err(|error| error.to_string())
        };
        assert!(checked(0.1, 0.0).is_ok() && checked(3.0, 0.1).is_ok());
        for wrong in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let error = checked(wrong, 0.1);
            assert!(error.is_err_and(|error| error.contains(&format!("distance of {wrong}"))), "{wrong}");
        }
        for wrong in [-0.1, f32::NAN, f32::INFINITY] {
            let error = checked(1.0, wrong);
            assert!(error.is_err_and(|error| error.contains(&format!("radius of {wrong}"))), "{wrong}");
        }
    }
}
