//! `deepshade bench`: speed. Networks are measured beside their rivals in the same run; rays, training and
//! making datasets by themselves.

mod dataset;
mod frame;
#[cfg(feature = "train")]
mod net;
mod passes;
#[cfg(feature = "train")]
mod pytorch;
pub mod rays;
#[cfg(feature = "train")]
mod train;

use anyhow::Result;

/// What is measured.
#[derive(clap::Subcommand)]
pub enum Verb {
    /// Milliseconds of the paper's networks, in WGSL and on the CPU, beside onnxruntime and PyTorch.
    #[cfg(feature = "train")]
    Net(net::Args),
    /// Images a second that training takes.
    #[cfg(feature = "train")]
    Train(train::Args),
    /// Rays a second through a scene, one thread and all, traversal alone.
    Rays(rays::Args),
    /// Milliseconds of every pass of a live frame, frames a second, memory.
    Frame(Box<frame::Args>),
    /// Milliseconds of every pass of a method on a frame, and of every part of `composed`.
    Passes(Box<passes::Args>),
    /// Training pairs an hour and a core, and where the time goes.
    Dataset(dataset::Args),
}

/// Measures and prints.
///
/// # Errors
/// If what is measured does not run.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        #[cfg(feature = "train")]
        Verb::Net(args) => net::run(args),
        #[cfg(feature = "train")]
        Verb::Train(args) => train::run(args),
        Verb::Rays(args) => rays::run(args),
        Verb::Frame(args) => frame::run(args),
        Verb::Passes(args) => passes::run(args),
        Verb::Dataset(args) => dataset::run(args),
    }
}
