//! Training: the network of a spec in burn, its loss and optimisers, the loop with its checkpoints, and the
//! export of what was learned.

pub mod bench;
pub mod checkpoint;
pub mod config;
mod device;
pub mod error;
mod events;
pub mod export;
mod feed;
mod files;
pub mod first_weights;
#[cfg(feature = "vulkan")]
mod gpu;
#[cfg(not(feature = "vulkan"))]
mod kernels;
mod loader;
pub mod loss;
pub mod metrics;
pub mod net;
pub mod optim;
mod pairs;
mod parallel;
mod plain;
mod rng;
mod stop;
pub mod training;

pub use config::TrainConfig;
pub use device::{device, device_name};
pub use error::TrainError;
pub use export::export;
pub use feed::Endless;
pub use files::{discard, is_taken};
pub use loss::Loss;
pub use net::{UNet, forward_burn, layers_burn};
pub use optim::Optimiser;
pub use pairs::PairSource;
pub use stop::Stop;
pub use training::{Ending, TrainingOutcome, train, train_on, train_streamed};
