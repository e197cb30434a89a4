//! The forward pass on the CPU: for machines without a GPU, and for training.
//!
//! Every layer is one parallel pass over stripes of rows: what comes before the convolution (padding,
//! pooling, doubling, concatenation) happens as a stripe is read, bias and leaky ReLU before it is written.
//! The vector instructions (AVX-512, AVX2, NEON) are chosen when the program runs. Images stay planar,
//! `[channels, height, width]`: vectors of neighbouring pixels fit groups of few channels and a single output
//! alike, and need no way to and from the g-buffer's layout.

pub mod ceilings;
pub mod conv;
mod correction;
pub mod filter;
pub mod operand;
mod plan;
pub mod shape;
pub mod stripe;

pub use plan::CpuPlan;

use crate::forward::ForwardError;
use crate::{Layer, NetSpec, Weights};
use deepshade_shaders::Planes;
use shape::ConvShape;
use std::sync::Arc;
use stripe::Packed;

/// A network with its weights in the order in which the CPU reads them. Clones share them.
#[derive(Clone, Debug)]
pub struct Network {
    spec: NetSpec,
    packed_layers: Arc<[PackedLayer]>,
}

/// A layer, ready to run.
#[derive(Debug)]
struct PackedLayer {
    layer: Layer,
    weights: Packed,
    bias: Vec<f32>,
    /// [`Layer::read_order`].
    order: Vec<usize>,
}

impl Network {
    /// Packs the weights.
    ///
    /// # Errors
    /// If no network can have the spec, or the weights are not the spec's.
    pub fn new(spec: &NetSpec, weights: &Weights) -> Result<Self, ForwardError> {
        if spec.validate().is_err() || !weights.fit(spec) {
            return Err(ForwardError::Unfit);
        }
        let layers = spec.layers();
        let packed = |(layer, weights): (&Layer, &crate::LayerWeights)| PackedLayer {
            weights: Packed::new(conv_shape(layer, [spec.alignment(); 2]), &weights.weight),
            bias: weights.bias.clone(),
            order: layer.read_order(&layers),
            layer: layer.clone(),
        };
        Ok(Self { spec: spec.clone(), packed_layers: layers.iter().zip(&weights.0).map(packed).collect() })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        &self.spec
    }

    /// Room for images of a size. Where feature maps would take more than a gigabyte the image is run in
    /// tiles, which make the same.
    ///
    /// # Errors
    /// If there is no pixel, or not even the smallest tile is small enough.
    pub fn plan(&self, height: usize, width: usize) -> Result<CpuPlan, ForwardError> {
        CpuPlan::new(self.clone(), [height, width], plan::MOST_BYTES)
    }

    /// As [`Network::plan`], with feature maps of at most so many bytes.
    ///
    /// # Errors
    /// As [`Network::plan`].
    pub fn plan_within(&self, height: usize, width: usize, bytes: u64) -> Result<CpuPlan, ForwardError> {
        CpuPlan::new(self.clone(), [height, width], bytes)
    }

    /// The network's image, `[output channels, height, width]`, of an input
    /// `[input channels, height, width]`.
    ///
    /// # Errors
    /// If the input is not the spec's, or as [`Network::plan`].
    pub fn run(&self, input: &Planes) -> Result<Planes, ForwardError> {
        self.plan(input.height(), input.width())?.run(input)
    }
}

/// The convolution of a layer in a whole frame of `[height, width]`.
fn conv_shape(layer: &Layer, frame: [usize; 2]) -> ConvShape {
    let [height, width] = frame.map(|size| size >> layer.level);
    ConvShape {
        batch: 1,
        groups: layer.groups,
        inputs: layer.inputs / layer.groups,
        outputs: layer.outputs / layer.groups,
        height,
        width,
        kernel: layer.kernel,
    }
}
