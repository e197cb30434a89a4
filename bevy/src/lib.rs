//! deepshade's networks in Bevy.
//!
//! [`DeepshadePlugin`] and a component on a camera, [`LearnedAmbientOcclusion`]: what the camera's prepass
//! shows, depth and normals, goes through deepshade's passes in Bevy's own encoder, and the openness that
//! they make into the texture that Bevy's `ScreenSpaceAmbientOcclusion` writes. So Bevy's materials use it,
//! as they use that one.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use deepshade_bevy::{DeepshadePlugin, LearnedAmbientOcclusion};
//!
//! fn main() {
//!     let deepshade = DeepshadePlugin { models: "models".into() };
//!     App::new().add_plugins((DefaultPlugins, deepshade)).add_systems(Startup, camera).run();
//! }
//!
//! fn camera(mut commands: Commands) {
//!     let occlusion = LearnedAmbientOcclusion { radius: 0.5, ..default() };
//!     commands.spawn((Camera3d::default(), Msaa::Off, occlusion));
//! }
//! ```

mod component;
mod error;
mod extract;
mod failures;
mod networks;
mod plugin;
mod prepare;
mod record;
mod shading;
mod textures;

pub use component::{LearnedAmbientOcclusion, Quality};
pub use error::LearnedError;
pub use failures::LearnedFailures;
pub use plugin::DeepshadePlugin;
pub use shading::LearnedShading;
