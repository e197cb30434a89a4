//! What a method is: one way to compute an effect from a frame.

use crate::bvh::TracedScene;
use crate::scene::Camera;
use deepshade_shaders::{Effect, GBuffer, MissingAttribute, Planes, gpu::GpuError};
use thiserror::Error;

/// What a method gets: a scene seen by a camera, and the effect's reach.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The scene, for methods that look beyond the screen.
    pub scene: &'a TracedScene,
    /// The camera of the g-buffer.
    pub camera: &'a Camera,
    /// What the camera sees.
    pub gbuffer: &'a GBuffer,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Chooses the random numbers of methods that use some.
    pub seed: u32,
}

/// How often a method runs so that its time can be stated.
#[derive(Clone, Copy, Debug)]
pub struct Repeats {
    /// Runs before the clock counts.
    pub warm_up: usize,
    /// Runs of which the median is taken; at least 1.
    pub timed: usize,
}

impl Repeats {
    /// One run, with its own time.
    pub const ONCE: Self = Self { warm_up: 0, timed: 1 };
}

/// Which clock measured a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// Timestamp queries around the passes.
    Gpu,
    /// Wall clock around the computation.
    Cpu,
}

/// What a method gives back.
#[derive(Clone, Debug)]
pub struct Shaded {
    /// `[effect.channels(), height, width]`; [`Effect::background`] where the g-buffer is not valid.
    pub image: Planes,
    /// Median time of a run, milliseconds.
    pub milliseconds: f64,
    /// Which clock it is from.
    pub clock: Clock,
    /// Name of the device that made the image: an adapter, or the processor where no adapter was asked.
    pub device: String,
}

/// Why a method gave no image.
#[derive(Debug, Error)]
pub enum MethodError {
    /// The g-buffer lacks an attribute that the method reads.
    #[error("method `{method}`: {source}")]
    Missing {
        /// Which method.
        method: &'static str,
        /// What it lacks.
        source: MissingAttribute,
    },
    /// The GPU failed.
    #[error("method `{method}`: {source}")]
    Gpu {
        /// Which method.
        method: &'static str,
        /// How.
        source: GpuError,
    },
    /// Anything else, in words.
    #[error("method `{method}`: {what}")]
    Other {
        /// Which method.
        method: &'static str,
        /// What went wrong.
        what: String,
    },
}

/// One way to compute an effect.
pub trait Method {
    /// Its name on the command line; figures write hyphens as underscores.
    fn name(&self) -> &'static str;

    /// What it computes.
    fn effect(&self) -> Effect;

    /// Whether it needs fog that is the same throughout, and refuses grids.
    fn wants_even_fog(&self) -> bool {
        false
    }

    /// Computes the effect for a frame, as often as `repeats` says.
    ///
    /// # Errors
    /// If the frame lacks something or the GPU fails.
    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError>;
}
