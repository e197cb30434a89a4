//! Why a camera has not what it asks for.

use bevy::prelude::Msaa;
use deepshade_infer::{ForwardError, ModelError};
use deepshade_render::methods::estimate::EstimateError;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::GpuError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a camera has no learned ambient occlusion or depth of field. It is logged, once for each camera, and
/// the camera has none until the cause is gone.
#[derive(Debug, Error)]
pub enum LearnedError {
    /// A radius that is no length.
    #[error("a radius of {0}: it has to be finite and above 0")]
    Radius(f32),
    /// A distance in focus that is no length.
    #[error("a focal distance of {0}: it has to be finite and above 0")]
    FocalDistance(f32),
    /// An aperture that is no length, nor 0.
    #[error("an aperture radius of {0}: it has to be finite and not below 0")]
    ApertureRadius(f32),
    /// Multisampled depth cannot be read.
    #[error("the camera has Msaa::{0:?}: it has to be Msaa::Off")]
    Msaa(Msaa),
    /// Another projection than a perspective.
    #[error("the camera has to have a perspective projection")]
    Projection,
    /// A device on which Bevy has no ambient occlusion of its own, and so no place for its texture.
    #[error("the device allows {0} storage textures in a shader stage; Bevy's occlusion wants 5")]
    StorageTextures(u32),
    /// A network that is not there, or damaged.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A network of something else.
    #[error("the network in {} makes `{effect}`, not `{wanted}`", folder.display())]
    Effect {
        /// Where it lies.
        folder: PathBuf,
        /// What it makes.
        effect: Effect,
        /// What it has to make.
        wanted: Effect,
    },
    /// A network that makes one colour channel a run.
    #[error("the network in {} makes one colour at a time, and has to make all at once", folder.display())]
    Mono {
        /// Where it lies.
        folder: PathBuf,
    },
    /// A network that reads what a camera does not show.
    #[error("the network in {} reads `{attribute}`, which a camera does not show", folder.display())]
    Attribute {
        /// Where it lies.
        folder: PathBuf,
        /// What it reads.
        attribute: &'static str,
    },
    /// A method whose image the network reads is not known.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The network does not run on the device.
    #[error(transparent)]
    Forward(#[from] ForwardError),
    /// The device refuses.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
