//! The forward pass in WGSL, on the caller's device.
//!
//! Every layer is one pass: what comes before the convolution (padding, doubling, concatenation) happens as
//! it reads, what comes after (bias, leaky ReLU, pooling) before it writes. There are two sets of kernels:
//!
//! - for GPUs (`shaders/wgsl/convolution`): feature maps in regions of a storage buffer that are used again
//!   as soon as a map is not needed any more, a tile of what a workgroup reads in its own memory, 16 to 64
//!   sums an invocation, feature maps in half floats if wanted;
//! - for software adapters (`shaders/wgsl/net`): feature maps in texture arrays, weights in uniform buffers,
//!   which lavapipe reads many times as fast as storage buffers.
//!
//! Where what the last block makes is not the image, further passes make it of that ([`crate::Head`]), for
//! both sets.
//!
//! [`Variant`] is the choice between them and between the shapes of the first set's kernels; [`Tuning`] makes
//! it by measuring. [`Network`] is what depends on the device, [`Plan`] what depends on the image's size,
//! [`Recording`] what depends on the caller's buffers or textures; recording that again makes nothing anew.
//!
//! Where a g-buffer lies in buffers, [`InputPasses`] make the network's input of them, and [`ImagePass`] the
//! effect's image of what the network made, so that all of it goes into one command encoder.

mod arena;
mod convenience;
mod device_layer;
mod files;
mod fit;
mod frame_recording;
mod head;
mod host;
mod image_pass;
mod input_passes;
mod io;
pub mod kernel;
mod limits;
mod map_layout;
mod maps;
mod network;
pub mod packing;
mod plan;
mod recording;
mod storage;
mod tiles;
mod tuning;
mod tuning_file;
mod tuning_key;
mod variant;

pub use convenience::{Runner, run, run_layers};
pub use deepshade_shaders::wgsl::convolution::Shape;
pub use files::{File, WgslFiles, wgsl_files};
pub use frame_recording::{FrameRecording, FrameScale};
pub use image_pass::{ImageBuffers, ImagePass};
pub use input_passes::{InputPasses, InputSource};
pub use io::{Input, InputKind, Output, OutputKind};
pub use network::{Network, Options};
pub use plan::{Bytes, Plan};
pub use recording::Recording;
pub(crate) use tiles::{Tile, Tiling};
pub use tuning::Tuning;
pub use variant::{Precision, Variant};

use crate::parity::Tolerance;
use deepshade_shaders::MissingAttribute;
use deepshade_shaders::gpu::GpuError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// How far an image that was made with feature maps in half floats may be off. A half float has 11 bits, so
/// that a map's elements are off by at most 2^-12 of themselves, 2.4e-4. Every layer passes its inputs'
/// errors on, which have either sign, and adds its own: ten times that of the largest element. Of noise at
/// 768x512 the shipped `do-paper` comes to half of it, and `dof`, whose last layer predicts kernels, the
/// exponents of which errors go into, to 0.84.
pub const HALF_TOLERANCE: Tolerance = Tolerance { of_rms: 0.0, of_largest: 2.5e-3 };

/// Why a network does not run on a device.
#[derive(Debug, Error)]
pub enum ForwardError {
    /// The weights are not the spec's.
    #[error("the weights do not fit the network's spec")]
    Unfit,
    /// A kernel too large for a uniform buffer.
    #[error("layer `{layer}`: eight of its outputs have {bytes} bytes of weights; there is room for {limit}")]
    Weights {
        /// Name of the layer.
        layer: String,
        /// Bytes of weights that eight outputs have.
        bytes: usize,
        /// Bytes that fit.
        limit: usize,
    },
    /// More channels than a texture holds.
    #[error("layer `{layer}` makes {channels} channels; the device's textures hold {limit}")]
    Channels {
        /// Name of the layer.
        layer: String,
        /// Channels that it makes.
        channels: usize,
        /// Most channels of a texture array.
        limit: usize,
    },
    /// An image too large, or empty.
    #[error("an image of {width}x{height}: layer `{layer}` {reason}")]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Name of the layer.
        layer: String,
        /// Which limit is in the way.
        reason: String,
    },
    /// Not even the smallest tile has room.
    #[error(
        "an image of {width}x{height}: no tile of it has feature maps of at most {limit} bytes within the device's limits"
    )]
    Memory {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes that the feature maps may take.
        limit: u64,
    },
    /// An input with another number of channels.
    #[error("the input has {found} channels; the network reads {expected}")]
    Input {
        /// Channels that the network reads.
        expected: usize,
        /// Channels of the input.
        found: usize,
    },
    /// A g-buffer without something that the network reads.
    #[error(transparent)]
    Missing(#[from] MissingAttribute),
    /// A set of kernels that cannot do what is asked for.
    #[error("{0}")]
    Variant(&'static str),
    /// A device that allows too little, whatever the image: ask wgpu for more when the device is made.
    #[error("the device's `{name}` is {allowed}; the network's kernels need {needed}")]
    Limit {
        /// Which of wgpu's limits.
        name: &'static str,
        /// What is needed.
        needed: u32,
        /// What the device allows.
        allowed: u32,
    },
    /// A shape that a layer's kernel does not have, or not on this device.
    #[error("layer `{layer}` has no kernel of {shape:?} here")]
    Shape {
        /// Name of the layer.
        layer: String,
        /// The shape.
        shape: Shape,
    },
    /// Measuring found no kernel of a layer that works: [`Tuning::variant`]. Another [`Precision`] may, and
    /// the CPU does.
    #[error("no kernel of layer `{layer}` works in {precision:?} on {device}{}", remembered(file.as_deref()))]
    NoKernel {
        /// Name of the layer.
        layer: String,
        /// How feature maps were to be kept.
        precision: Precision,
        /// Adapter and driver.
        device: String,
        /// What remembers it.
        file: Option<PathBuf>,
    },
    /// The GPU refuses.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Where it is remembered that no kernel works, in words.
fn remembered(file: Option<&Path>) -> String {
    let file =
        file.map(|file| format!(", as {} remembers; without that file it is measured again", file.display()));
    file.unwrap_or_default()
}
