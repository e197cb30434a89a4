//! The network of a [`NetSpec`] as a burn module.

use crate::device::ops;
use crate::rng::{Purpose, Rng};
use burn::module::{Module, Param, ParamId};
use burn::tensor::ops::PadMode;
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_infer::weights::LayerWeights;
use deepshade_infer::{ChannelOrder, Layer, NetSpec, Source, Weights};
use deepshade_shaders::Planes;

/// A convolution's weights and biases.
#[derive(Module, Debug)]
struct Conv {
    /// `[outputs, inputs / groups, kernel, kernel]`.
    weight: Param<Tensor<4>>,
    /// `[outputs]`.
    bias: Param<Tensor<1>>,
}

/// The U-net of the thesis (7.3.2), driven by [`NetSpec::layers`].
#[derive(Module, Debug)]
pub struct UNet {
    convs: Vec<Conv>,
    #[module(skip)]
    spec: NetSpec,
}

impl UNet {
    /// A network with random weights: normal, of variance `2 / ((1 + leak^2) * fan-in)` before a leaky ReLU and
    /// `1 / fan-in` before none (He et al. 2015, equations 10 and 15); biases are 0.
    pub fn random(spec: &NetSpec, seed: u64, device: &Device) -> Self {
        let area = spec.kernel * spec.kernel;
        let layers = spec.layers().into_iter().enumerate().map(|(index, layer)| {
            let fan_in = (layer.inputs / layer.groups * area) as f64;
            let gain = if layer.activation { 2.0 / (1.0 + f64::from(spec.leak).powi(2)) } else { 1.0 };
            let deviation = (gain / fan_in).sqrt();
            let mut rng = Rng::new(seed, Purpose::Weights, index as u64);
            let count = layer.weight_count(spec.kernel) - layer.outputs;
            let weight = (0..count).map(|_| (deviation * rng.normal()) as f32).collect();
            LayerWeights { weight, bias: vec![0.0; layer.outputs] }
        });
        Self::from_weights(spec, &Weights(layers.collect()), device)
    }

    /// A network with these weights, which must [fit](Weights::fit) the spec.
    pub fn from_weights(spec: &NetSpec, weights: &Weights, device: &Device) -> Self {
        debug_assert!(weights.fit(spec), "weights of another spec");
        let layers = spec.layers();
        let convs = layers.iter().zip(&weights.0).enumerate().map(|(index, (layer, weights))| {
            let shape = [layer.outputs, layer.inputs / layer.groups, spec.kernel, spec.kernel];
            let weight = Tensor::from_data(TensorData::new(weights.weight.clone(), shape), device);
            let bias = Tensor::from_data(TensorData::new(weights.bias.clone(), [layer.outputs]), device);
            // Names that are the same in every run let an optimiser's saved state find its parameter again.
            let id = |part: u64| ParamId::from(2 * index as u64 + part);
            Conv {
                weight: Param::initialized(id(0), weight.set_require_grad(device.is_autodiff())),
                bias: Param::initialized(id(1), bias.set_require_grad(device.is_autodiff())),
            }
        });
        Self { convs: convs.collect(), spec: spec.clone() }
    }

    /// The weights as plain arrays.
    pub fn weights(&self) -> Weights {
        let numbers = |data: TensorData| data.to_vec::<f32>().expect("weights are f32");
        let layer = |conv: &Conv| LayerWeights {
            weight: numbers(conv.weight.val().into_data()),
            bias: numbers(conv.bias.val().into_data()),
        };
        Weights(self.convs.iter().map(layer).collect())
    }

    /// What the network computes.
    pub const fn spec(&self) -> &NetSpec {
        &self.spec
    }

    /// Images of any size: the input is padded with its edge to a multiple of [`NetSpec::alignment`] to the right
    /// and below, and the output cut back.
    ///
    /// # Shapes
    /// `[batch, input channels, height, width]` to `[batch, effect's channels, height, width]`.
    pub fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        let [_, _, height, width] = x.dims();
        let missing = |size: usize| size.next_multiple_of(self.spec.alignment()) - size;
        if missing(height) + missing(width) == 0 {
            return self.forward_aligned(x);
        }
        let padded = x.pad((0, missing(width), 0, missing(height)), PadMode::Edge);
        self.forward_aligned(padded).narrow(2, 0, height).narrow(3, 0, width)
    }

    /// Images whose height and width are multiples of [`NetSpec::alignment`].
    fn forward_aligned(&self, x: Tensor<4>) -> Tensor<4> {
        let mut outputs: Vec<Tensor<4>> = Vec::with_capacity(self.convs.len());
        for (layer, conv) in self.spec.layers().iter().zip(&self.convs) {
            let input = match layer.source {
                Source::Input => x.clone(),
                Source::Pooled(finer) => ops::halve(outputs[finer].clone()),
                Source::Joined { coarse, skip } => {
                    let coarse = ops::double(outputs[coarse].clone());
                    self.join(coarse, outputs[skip].clone(), layer)
                }
            };
            let leak = if layer.activation { self.spec.leak } else { 1.0 };
            outputs.push(ops::convolve(input, conv.weight.val(), conv.bias.val(), leak));
        }
        outputs.pop().expect("a network has a layer")
    }

    /// Concatenation in the spec's order ([`NetSpec::joined_order`]).
    fn join(&self, coarse: Tensor<4>, skip: Tensor<4>, layer: &Layer) -> Tensor<4> {
        let groups = match self.spec.channel_order {
            ChannelOrder::Contiguous => 1,
            ChannelOrder::Interleaved => layer.groups,
        };
        let [batch, _, height, width] = skip.dims();
        let shares = |x: Tensor<4>| {
            let share = x.dims()[1] / groups;
            x.reshape([batch, groups, share, height, width])
        };
        Tensor::cat(vec![shares(coarse), shares(skip)], 2).reshape([batch, layer.inputs, height, width])
    }
}

/// Runs a network on an image through burn, on the device that the crate was built for.
///
/// # Shapes
/// `[input channels, height, width]` to `[effect's channels, height, width]`.
pub fn forward_burn(spec: &NetSpec, weights: &Weights, input: &Planes) -> Planes {
    let device = crate::device();
    let output = UNet::from_weights(spec, weights, &device).forward(to_tensor(&[input], &device));
    to_planes(output)
}

/// Images of one size as a tensor `[batch, channels, height, width]`.
pub(crate) fn to_tensor(images: &[&Planes], device: &Device) -> Tensor<4> {
    let shape = [images.len(), images[0].channels(), images[0].height(), images[0].width()];
    let data = images.iter().flat_map(|image| image.data()).copied().collect();
    Tensor::from_data(TensorData::new::<f32, _>(data, shape), device)
}

/// The only image of a tensor `[1, channels, height, width]`.
pub(crate) fn to_planes(tensor: Tensor<4>) -> Planes {
    let [_, channels, height, width] = tensor.dims();
    let data = tensor.into_data().to_vec::<f32>().expect("images are f32");
    Planes::from_data(channels, height, width, data)
}
