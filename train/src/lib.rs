//! Training: the U-net of a spec in burn, its loss and optimisers, the loop with its checkpoints, and the export of
//! what was learned.

mod device;
#[cfg(not(feature = "vulkan"))]
mod kernels;
pub mod loss;
pub mod net;
#[cfg(any(test, feature = "vulkan"))]
mod plain;
mod rng;

pub use device::device;
pub use net::{UNet, forward_burn};
