//! `deepshade bench`: speed. Networks and rays are measured beside their rivals in the same run; training and making
//! datasets by themselves.

mod dataset;
mod epipolar;
mod farm;
mod frame;
mod lpv;
#[cfg(feature = "train")]
mod net;
mod phosphor;
#[cfg(feature = "train")]
mod pytorch;
mod rays;
mod slope;
mod stages;
mod store;
mod surfel;
#[cfg(feature = "train")]
mod train;
#[cfg(feature = "view")]
mod view;
mod volume_shell;

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
    /// Rays a second through a scene, one thread and all, traversal alone; beside Embree with the feature `embree`.
    Rays(rays::Args),
    /// Milliseconds of every pass of a live frame, frames a second, memory.
    Frame(Box<frame::Args>),
    /// Milliseconds and memory of shading by surfels, stage by stage; thresholds, levels, resolution.
    Surfel(Box<surfel::Args>),
    /// Fog by partial-sum trees beside marching at equal error: speed-ups, how times grow.
    Epipolar(epipolar::Args),
    /// Milliseconds and errors of volume shells, stage by stage; thresholds, improvements, how times grow.
    VolumeShell(volume_shell::Args),
    /// Milliseconds and errors of light propagation volumes, stage by stage; the paper's alternatives, how far propagation is right.
    Lpv(lpv::Args),
    /// Milliseconds of designing phosphorescent materials, and what light of the past costs.
    Phosphor(phosphor::Args),
    /// Pictures a second of the window by every method, seconds to the first one, memory.
    #[cfg(feature = "view")]
    View(view::Args),
    /// Training pairs an hour and a core, and where the time goes.
    Dataset(dataset::Args),
    /// Training pairs an hour by several workers on this machine, and whether their bytes are those of one run.
    Farm(farm::Args),
    /// Megabytes and requests a second that an object store or a folder takes from this machine.
    Store(store::Args),
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
        Verb::Surfel(args) => surfel::run(args),
        Verb::Epipolar(args) => epipolar::run(args),
        Verb::VolumeShell(args) => volume_shell::run(args),
        Verb::Lpv(args) => lpv::run(args),
        Verb::Phosphor(args) => phosphor::run(args),
        #[cfg(feature = "view")]
        Verb::View(args) => view::run(args),
        Verb::Dataset(args) => dataset::run(args),
        Verb::Farm(args) => farm::run(args),
        Verb::Store(args) => store::run(args),
    }
}
