//! Truth: path-traced effects, one integrator a file, and the random numbers they share.

pub mod ao;
pub mod direct;
pub mod sampler;

pub use ao::Ao;
