//! What the systems have to know of a component.

use crate::LearnedError;
use bevy::prelude::Bundle;
use bevy::render::RenderApp;
use bevy::render::renderer::RenderDevice;
use bevy::render::sync_component::SyncComponent;
use deepshade_render::scene::Lens;
use deepshade_shaders::{Attribute, Effect};

/// A component that has a network run for its camera. Its target is what the camera in the render world has
/// for it.
pub(crate) trait LearnedEffect: SyncComponent<RenderApp> + Copy {
    /// The component's name, for messages.
    const COMPONENT: &'static str;
    /// What its network makes.
    const EFFECT: Effect;
    /// What deepshade's passes are shown of a camera.
    const SHOWN: &'static [Attribute];
    /// What Bevy has to find on the view.
    type OfBevy: Bundle + Default;

    /// The network's folder in [`DeepshadePlugin::models`](crate::DeepshadePlugin::models).
    fn folder(&self) -> &'static str;

    /// Checks what can be set.
    ///
    /// # Errors
    /// If a value is none that it can have.
    fn checked(&self) -> Result<(), LearnedError>;

    /// Checks what the effect wants of the device beside what networks want.
    ///
    /// # Errors
    /// If the device allows too little.
    fn check_device(_: &RenderDevice) -> Result<(), LearnedError> {
        Ok(())
    }

    /// How far it reaches, and through which lens.
    fn reach(&self) -> Reach;
}

/// How far an effect reaches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// In the world's unit; of an effect that has no radius any.
    pub radius: f32,
    /// The lens that blurs, if one does.
    pub lens: Option<Lens>,
}
