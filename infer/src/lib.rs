//! What a trained network does: its spec, its folder, its forward pass in WGSL on the caller's device and in
//! vector instructions on the CPU, and a plain reference forward pass that the others are checked against.

pub mod cost;
pub mod cpu;
pub mod filter;
pub mod forward;
pub mod input;
pub mod model;
pub mod parity;
pub mod reach;
mod receptive;
pub mod reference;
pub mod spec;
pub mod weights;

pub use cost::Cost;
pub use filter::{Filter, Tap};
pub use forward::{ForwardError, Network, Plan, Recording};
pub use input::Scaling;
pub use model::{Model, ModelError};
pub use parity::{Activation, Comparison, Parity};
pub use reach::Reach;
pub use spec::{
    AnalyticEstimate, Block, BlockSource, ChannelOrder, Colour, Correction, HALF_GATE, Head, Layer, NetSpec,
    SpecError, Trained, TrainedUnder, UNet,
};
pub use weights::{LayerWeights, Weights};
