//! The forward pass in WGSL, on the caller's device: `shaders/wgsl/net`.
//!
//! Every layer is one pass: what comes before the convolution (padding, doubling, concatenation) happens as it reads,
//! what comes after (bias, leaky ReLU, pooling) before it writes. Feature maps are texture arrays of four channels a
//! layer: a fetch then brings four numbers, in half the time that software Vulkan (lavapipe) takes to read as many from
//! a storage buffer, and no feature map meets a storage buffer's limit of 128 MiB. Weights are in uniform buffers,
//! which lavapipe reads about ten times as fast as storage buffers.

mod convenience;
mod packing;
mod plan;

pub use convenience::{run, run_layers};
pub use plan::Plan;

use crate::{Layer, NetSpec, Source, Weights};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader};
use packing::{Packed, Part};
use thiserror::Error;

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
    /// An input with another number of channels.
    #[error("the input has {found} channels; the network reads {expected}")]
    Input {
        /// Channels that the network reads.
        expected: usize,
        /// Channels of the input.
        found: usize,
    },
    /// The GPU refuses.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// A network on a device: its compiled passes and its weights. A [`Plan`] adds what depends on the image's size.
#[derive(Debug)]
pub struct Network {
    device: wgpu::Device,
    spec: NetSpec,
    stages: Vec<Stage>,
}

/// One layer on a device.
#[derive(Debug)]
struct Stage {
    layer: Layer,
    pass: Pass,
    parts: Vec<StagePart>,
    /// Weights between the first ones of two groups of outputs.
    stride: usize,
}

/// Groups of outputs whose weights fit into one uniform buffer.
#[derive(Debug)]
struct StagePart {
    first: usize,
    count: usize,
    reads: wgpu::Buffer,
    weights: wgpu::Buffer,
}

impl Network {
    /// Compiles the passes and uploads the weights.
    ///
    /// # Errors
    /// If the weights are not the spec's, a layer is beyond the device's limits, or the device refuses.
    pub fn new(device: &wgpu::Device, spec: &NetSpec, weights: &Weights) -> Result<Self, ForwardError> {
        if spec.validate().is_err() || !weights.fit(spec) {
            return Err(ForwardError::Unfit);
        }
        let layers = spec.layers();
        let mut passes: Vec<(&str, Pass)> = Vec::new();
        let mut stages = Vec::new();
        for (index, layer) in layers.iter().enumerate() {
            check_channels(device, layer)?;
            let packed = packing::pack(spec, &layers, index, &weights.0[index])?;
            let shader = shader(spec, layer);
            if !passes.iter().any(|(name, _)| *name == shader.name) {
                let source = shader.specialised(&[("KERNEL", spec.kernel as u32)]);
                passes.push((shader.name, Pass::new(device, shader.name, &source)?));
            }
            let pass = passes.iter().find(|(name, _)| *name == shader.name).map(|(_, pass)| pass.clone());
            let pass = pass.expect("compiled above");
            stages.push(Stage::new(device, layer.clone(), pass, &packed)?);
        }
        Ok(Self { device: device.clone(), spec: spec.clone(), stages })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        &self.spec
    }

    /// Prepares runs on images of a size: the feature maps between the layers.
    ///
    /// # Errors
    /// If the size is beyond the device's limits or its memory.
    pub fn plan(&self, height: usize, width: usize) -> Result<Plan, ForwardError> {
        Plan::new(self, height, width)
    }
}

impl Stage {
    fn new(device: &wgpu::Device, layer: Layer, pass: Pass, packed: &Packed) -> Result<Self, ForwardError> {
        let upload = |part: &Part| {
            let label = |what: &str| format!("net.{}.{what}", layer.name);
            Ok(StagePart {
                first: part.first,
                count: part.reads.len(),
                reads: gpu::storage(device, &label("reads"), &part.reads)?,
                weights: gpu::uniforms(device, &label("weights"), &part.weights)?,
            })
        };
        let parts = packed.parts.iter().map(upload).collect::<Result<_, GpuError>>()?;
        Ok(Self { layer, pass, parts, stride: packed.stride })
    }
}

/// The pass of a layer.
fn shader(spec: &NetSpec, layer: &Layer) -> &'static Shader {
    match (layer.source, layer.activation) {
        (Source::Input, _) if spec.levels == 1 => &wgsl::NET_ONLY,
        (Source::Input, _) => &wgsl::NET_FIRST,
        (Source::Plain(_), _) => &wgsl::NET_PLAIN,
        (Source::Pooled(_), _) if layer.level + 1 == spec.levels => &wgsl::NET_BOTTOM,
        (Source::Pooled(_), _) => &wgsl::NET_DOWN,
        (Source::Joined { .. }, true) => &wgsl::NET_UP,
        (Source::Joined { .. }, false) => &wgsl::NET_IMAGE,
    }
}

fn check_channels(device: &wgpu::Device, layer: &Layer) -> Result<(), ForwardError> {
    let limit = 4 * device.limits().max_texture_array_layers as usize;
    match layer.outputs.next_multiple_of(packing::FEATURES) <= limit {
        true => Ok(()),
        false => Err(ForwardError::Channels { layer: layer.name.clone(), channels: layer.outputs, limit }),
    }
}
