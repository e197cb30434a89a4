//! The forward pass on the CPU: for machines without a GPU, and for training.
//!
//! Every layer is one parallel pass over stripes of rows: what comes before the convolution (padding, pooling,
//! doubling, concatenation) happens as a stripe is read, bias and leaky ReLU before it is written. The vector
//! instructions (AVX-512, AVX2, NEON) are chosen when the program runs. Images stay planar, `[channels, height,
//! width]`: vectors of neighbouring pixels fit groups of few channels and a single output alike, and need no way to
//! and from the g-buffer's layout.

pub mod ceilings;
pub mod conv;
pub mod operand;
pub mod stripe;

use crate::{Layer, NetSpec, Source, Weights};
use conv::ConvShape;
use deepshade_shaders::Planes;
use operand::{Image, Operand};
use std::borrow::Cow;
use std::time::Instant;
use stripe::Packed;

/// A network with its weights in the order in which the CPU reads them.
#[derive(Clone, Debug)]
pub struct Network {
    spec: NetSpec,
    stages: Vec<Stage>,
}

/// A layer, ready to run.
#[derive(Clone, Debug)]
struct Stage {
    layer: Layer,
    weights: Packed,
    bias: Vec<f32>,
    /// Of a layer that joins two: [`NetSpec::joined_order`].
    order: Vec<usize>,
}

/// Feature maps for images of one size, one a layer, used again from image to image.
#[derive(Clone, Debug)]
pub struct Plan {
    height: usize,
    width: usize,
    maps: Vec<Vec<f32>>,
}

impl Network {
    /// Packs the weights.
    ///
    /// # Panics
    /// If the weights are not the spec's ([`Weights::fit`]).
    pub fn new(spec: &NetSpec, weights: &Weights) -> Self {
        assert!(weights.fit(spec), "the weights belong to the spec");
        let layers = spec.layers();
        let order = |layer: &Layer| match layer.source {
            Source::Joined { coarse, skip } => {
                spec.joined_order(layers[coarse].outputs, layers[skip].outputs, layer.groups)
            }
            Source::Input | Source::Plain(_) | Source::Pooled(_) => Vec::new(),
        };
        let stages = layers.iter().zip(&weights.0).map(|(layer, weights)| Stage {
            weights: Packed::new(conv_shape(spec, layer, [1, 1]), &weights.weight),
            bias: weights.bias.clone(),
            order: order(layer),
            layer: layer.clone(),
        });
        Self { spec: spec.clone(), stages: stages.collect() }
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        &self.spec
    }

    /// Room for the feature maps of images of a size.
    pub fn plan(&self, height: usize, width: usize) -> Plan {
        let map = |stage: &Stage| vec![0.0; conv_shape(&self.spec, &stage.layer, [height, width]).made()];
        Plan { height, width, maps: self.stages.iter().map(map).collect() }
    }

    /// The network's image, `[output channels, height, width]`, of an input `[input channels, height, width]`.
    ///
    /// # Panics
    /// If the input is not the spec's.
    pub fn run(&self, input: &Planes) -> Planes {
        self.plan(input.height(), input.width()).run(self, input)
    }
}

impl Plan {
    /// As [`Network::run`], in this plan's room.
    ///
    /// # Panics
    /// If the input is not the spec's, or of another size than the plan.
    pub fn run(&mut self, network: &Network, input: &Planes) -> Planes {
        (0..network.stages.len()).for_each(|index| self.run_layer(network, index, input));
        self.image(network)
    }

    /// How long each layer takes, by name, milliseconds.
    ///
    /// # Panics
    /// If the input is not the spec's, or of another size than the plan.
    pub fn layer_times(&mut self, network: &Network, input: &Planes) -> Vec<(String, f64)> {
        let time = |(index, stage): (usize, &Stage)| {
            let start = Instant::now();
            self.run_layer(network, index, input);
            (stage.layer.name.clone(), start.elapsed().as_secs_f64() * 1e3)
        };
        network.stages.iter().enumerate().map(time).collect()
    }

    /// Bytes of the feature maps.
    pub fn bytes(&self) -> u64 {
        self.maps.iter().map(|map| size_of_val(map.as_slice()) as u64).sum()
    }

    fn run_layer(&mut self, Network { spec, stages }: &Network, index: usize, input: &Planes) {
        let found = [input.channels(), input.height(), input.width()];
        assert_eq!(found, [spec.input_channels(), self.height, self.width], "shape of the input");
        let stage = &stages[index];
        let size = [self.height, self.width];
        let (made, rest) = self.maps.split_at_mut(index);
        let map = |of: usize| {
            let [height, width] = frame(spec, &stages[of].layer, size);
            Image { data: &made[of], channels: stages[of].layer.outputs, height, width }
        };
        let operand = match stage.layer.source {
            Source::Input => Operand::Plain(image(input)),
            Source::Plain(from) => Operand::Plain(map(from)),
            Source::Pooled(from) => Operand::Pooled(map(from)),
            Source::Joined { coarse, skip } => {
                Operand::Joined { coarse: map(coarse), fine: map(skip), order: Cow::Borrowed(&stage.order) }
            }
        };
        let leak = if stage.layer.activation { spec.leak } else { 1.0 };
        let shape = conv_shape(spec, &stage.layer, size);
        conv::forward(shape, &operand, &stage.weights, &stage.bias, leak, &mut rest[0]);
    }

    /// What every layer made in the last run, as [`reference::layers`](crate::reference::layers) gives it.
    pub fn layers(&self, network: &Network) -> Vec<crate::Activation> {
        let planes = |stage: &Stage, map: &Vec<f32>| {
            let [height, width] = frame(&network.spec, &stage.layer, [self.height, self.width]);
            Planes::from_data(stage.layer.outputs, height, width, map.clone())
        };
        let mut made: Vec<crate::Activation> = network
            .stages
            .iter()
            .zip(&self.maps)
            .map(|(stage, map)| crate::Activation {
                layer: stage.layer.name.clone(),
                planes: planes(stage, map),
            })
            .collect();
        if let Some(last) = made.last_mut() {
            last.planes = self.image(network);
        }
        made
    }

    /// The image, cut out of the last layer's frame.
    fn image(&self, network: &Network) -> Planes {
        let [height, width] =
            [self.height, self.width].map(|size| size.next_multiple_of(network.spec.alignment()));
        let last = &self.maps[self.maps.len() - 1];
        let mut data = Vec::with_capacity(network.spec.output_channels() * self.height * self.width);
        for (_, row) in last.chunks_exact(width).enumerate().filter(|(row, _)| row % height < self.height) {
            data.extend_from_slice(&row[..self.width]);
        }
        Planes::from_data(network.spec.output_channels(), self.height, self.width, data)
    }
}

/// A layer's frame, `[height, width]`, for images of a size.
fn frame(spec: &NetSpec, layer: &Layer, size: [usize; 2]) -> [usize; 2] {
    size.map(|size| size.next_multiple_of(spec.alignment()) >> layer.level)
}

fn conv_shape(spec: &NetSpec, layer: &Layer, size: [usize; 2]) -> ConvShape {
    let [height, width] = frame(spec, layer, size);
    ConvShape {
        batch: 1,
        groups: layer.groups,
        inputs: layer.inputs / layer.groups,
        outputs: layer.outputs / layer.groups,
        height,
        width,
        kernel: spec.kernel,
    }
}

fn image(planes: &Planes) -> Image<'_> {
    Image { data: planes.data(), channels: planes.channels(), height: planes.height(), width: planes.width() }
}
