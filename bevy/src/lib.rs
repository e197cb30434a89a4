//! deepshade's networks in Bevy.
//!
//! [`DeepshadePlugin`] and components on a camera. What the camera shows goes through deepshade's passes in
//! Bevy's own encoder.
//!
//! - [`LearnedAmbientOcclusion`] reads depth and normals of the prepass. The openness that it makes goes into
//!   the texture that Bevy's `ScreenSpaceAmbientOcclusion` writes: Bevy's materials use it, as they use that.
//! - [`LearnedDepthOfField`] reads the picture and its depth, and writes what a lens would show.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use deepshade_bevy::{DeepshadePlugin, LearnedAmbientOcclusion, LearnedDepthOfField};
//!
//! fn main() {
//!     let deepshade = DeepshadePlugin { models: "models".into() };
//!     App::new().add_plugins((DefaultPlugins, deepshade)).add_systems(Startup, camera).run();
//! }
//!
//! fn camera(mut commands: Commands) {
//!     let occlusion = LearnedAmbientOcclusion { radius: 0.5, ..default() };
//!     let lens = LearnedDepthOfField { focal_distance: 3.0, aperture_radius: 0.05 };
//!     commands.spawn((Camera3d::default(), Msaa::Off, occlusion, lens));
//! }
//! ```

mod depth_of_field;
mod effect;
mod error;
mod extract;
mod failures;
mod networks;
mod occlusion;
mod plugin;
mod prepare;
mod record;
mod shading;
mod textures;

pub use depth_of_field::LearnedDepthOfField;
pub use error::LearnedError;
pub use failures::LearnedFailures;
pub use occlusion::{LearnedAmbientOcclusion, Quality};
pub use plugin::DeepshadePlugin;
pub use shading::LearnedShading;
