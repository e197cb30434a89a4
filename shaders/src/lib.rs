//! The contract between CPU, GPU and network: which channels a g-buffer has, how images lie in memory, what
//! is meant by similar, which WGSL sources exist, and how a compute pass is run and timed.
//!
//! Conventions, stated once for the whole project: right-handed, metres, y up; a camera looks down -z; image
//! origin top left; linear radiance, no gamma inside. Images are planar `[channels, height, width]` f32 in
//! memory and half floats in files.

pub mod atomic_file;
pub mod channel;
pub mod colour;
pub mod effect;
pub mod exposure;
pub mod gbuffer;
pub mod gpu;
pub mod host;
pub mod lists;
pub mod names;
pub mod own_file;
pub mod planes;
pub mod random;
pub mod similarity;
pub mod split_mix;
pub mod wgsl;

pub use channel::{Attribute, AttributeKind, Channel};
pub use effect::Effect;
pub use gbuffer::{GBuffer, MissingAttribute, shows_surface};
pub use planes::Planes;
