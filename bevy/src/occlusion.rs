//! The component of ambient occlusion.

use crate::effect::{LearnedEffect, Reach};
use crate::{LearnedError, LearnedShading};
use bevy::core_pipeline::prepass::{DepthPrepass, NormalPrepass};
use bevy::pbr::{
    ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionResources, SsaoBindGroups, SsaoPipelineId,
};
use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault};
use bevy::render::RenderApp;
use bevy::render::renderer::RenderDevice;
use bevy::render::sync_component::SyncComponent;
use deepshade_shaders::{Attribute, Effect};

/// Storage textures that Bevy's own passes bind.
const STORAGE_TEXTURES: u32 = 5;

/// Ambient occlusion by a network, for a `Camera3d` with `Msaa::Off` and a perspective projection. It takes
/// the place of Bevy's `ScreenSpaceAmbientOcclusion` where a camera has both.
#[derive(Clone, Copy, Component, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(DepthPrepass, NormalPrepass)]
pub struct LearnedAmbientOcclusion {
    /// Which network.
    pub quality: Quality,
    /// How far surfaces occlude, in the world's unit; above 0.
    pub radius: f32,
}

/// Which network of ambient occlusion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, PartialEq, Hash, Clone)]
pub enum Quality {
    /// `ao-small`: a quarter of the work.
    Low,
    /// `ao`.
    #[default]
    High,
}

impl Default for LearnedAmbientOcclusion {
    /// Half a metre, as rooms want it.
    fn default() -> Self {
        Self { quality: Quality::default(), radius: 0.5 }
    }
}

impl LearnedAmbientOcclusion {
    /// Checks what can be set.
    ///
    /// # Errors
    /// If the radius is no length.
    pub fn check(&self) -> Result<(), LearnedError> {
        match self.radius.is_finite() && self.radius > 0.0 {
            true => Ok(()),
            false => Err(LearnedError::Radius(self.radius)),
        }
    }
}

impl Quality {
    /// The network's folder in [`DeepshadePlugin::models`](crate::DeepshadePlugin::models).
    pub const fn folder(self) -> &'static str {
        match self {
            Self::Low => "ao-small",
            Self::High => "ao",
        }
    }
}

/// Bevy's own components are among it: they have its materials read the texture.
impl SyncComponent<RenderApp> for LearnedAmbientOcclusion {
    type Target = (
        Self,
        LearnedShading<Self>,
        ScreenSpaceAmbientOcclusion,
        ScreenSpaceAmbientOcclusionResources,
        SsaoPipelineId,
        SsaoBindGroups,
    );
}

impl LearnedEffect for LearnedAmbientOcclusion {
    const COMPONENT: &'static str = "LearnedAmbientOcclusion";
    const EFFECT: Effect = Effect::Ao;
    const SHOWN: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    /// With it Bevy makes the texture, and its materials read it.
    type OfBevy = ScreenSpaceAmbientOcclusion;

    fn folder(&self) -> &'static str {
        self.quality.folder()
    }

    fn checked(&self) -> Result<(), LearnedError> {
        self.check()
    }

    fn check_device(device: &RenderDevice) -> Result<(), LearnedError> {
        match device.limits().max_storage_textures_per_shader_stage {
            allowed if allowed < STORAGE_TEXTURES => Err(LearnedError::StorageTextures(allowed)),
            _ => Ok(()),
        }
    }

    fn reach(&self) -> Reach {
        Reach { radius: self.radius, lens: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_is_a_length() {
        let checked = |radius| LearnedAmbientOcclusion { radius, ..Default::default() }.check();
        assert!(checked(0.01).is_ok());
        for wrong in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let error = checked(wrong).map_err(|error| error.to_string());
            assert!(error.is_err_and(|error| error.contains(&wrong.to_string())), "{wrong}");
        }
    }
}
