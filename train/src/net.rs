//! The network of a [`NetSpec`] as a burn module.

use crate::device::ops;
use crate::first_weights::first_weights;
use crate::plain;
use burn::module::{Module, Param, ParamId};
use burn::tensor::ops::PadMode;
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_infer::weights::LayerWeights;
use deepshade_infer::{Activation, BlockSource, Head, Layer, NetSpec, Weights};
use deepshade_shaders::Planes;

/// A convolution's weights and biases.
#[derive(Module, Debug)]
struct Conv {
    /// `[outputs, inputs / groups, kernel, kernel]`.
    weight: Param<Tensor<4>>,
    /// `[outputs]`.
    bias: Param<Tensor<1>>,
}

/// A network, driven by [`NetSpec::layers`].
#[derive(Module, Debug)]
pub struct UNet {
    convs: Vec<Conv>,
    #[module(skip)]
    spec: NetSpec,
    #[module(skip)]
    layers: Vec<Layer>,
}

impl UNet {
    /// A network with its [`first_weights`].
    pub fn random(spec: &NetSpec, seed: u64, device: &Device) -> Self {
        Self::from_weights(spec, &first_weights(spec, seed), device)
    }

    /// A network with these weights, which must [fit](Weights::fit) the spec.
    pub fn from_weights(spec: &NetSpec, weights: &Weights, device: &Device) -> Self {
        debug_assert!(weights.fit(spec), "weights of another spec");
        let layers = spec.layers();
        let convs = layers.iter().zip(&weights.0).enumerate().map(|(index, (layer, weights))| {
            let shape = layer.weight_shape();
            let weight = Tensor::from_data(TensorData::new(weights.weight.clone(), shape), device);
            let bias = Tensor::from_data(TensorData::new(weights.bias.clone(), [layer.outputs]), device);
            // Names that are the same in every run let an optimiser's saved state find its parameter again.
            let id = |part: u64| ParamId::from(2 * index as u64 + part);
            Conv {
                weight: Param::initialized(id(0), weight.set_require_grad(device.is_autodiff())),
                bias: Param::initialized(id(1), bias.set_require_grad(device.is_autodiff())),
            }
        });
        Self { convs: convs.collect(), spec: spec.clone(), layers }
    }

    /// The weights as plain arrays.
    pub fn weights(&self) -> Weights {
        let numbers = |data: TensorData| data.try_into_vec::<f32>().expect("weights are f32");
        let layer = |conv: &Conv| LayerWeights {
            weight: numbers(conv.weight.val().into_data()),
            bias: numbers(conv.bias.val().into_data()),
        };
        Weights(self.convs.iter().map(layer).collect())
    }

    /// Images of any size: the input is padded with its edge to a multiple of [`NetSpec::alignment`] to the
    /// right and below, and the output cut back.
    ///
    /// # Shapes
    /// `[batch, input channels, height, width]` to `[batch, effect's channels, height, width]`.
    pub fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        let image = self.unbounded(x);
        match self.spec.head {
            Head::Correction(_) => within(image, self.spec.effect.range()),
            Head::Image | Head::Filter(_) => image,
        }
    }

    /// As [`UNet::forward`], but for the effect's range: what is beyond it has a gradient.
    pub(crate) fn unbounded(&self, x: Tensor<4>) -> Tensor<4> {
        let [_, _, height, width] = x.dims();
        let x = self.padded(x);
        let made = self.layers(x.clone()).pop().expect("a network has a layer");
        self.image(x, made).narrow(2, 0, height).narrow(3, 0, width)
    }

    /// The network's image of a padded input, given what its last block makes.
    fn image(&self, x: Tensor<4>, made: Tensor<4>) -> Tensor<4> {
        let made = unfolded(made, self.spec.last_level());
        let channels = |wanted: Vec<usize>| {
            Tensor::cat(wanted.into_iter().map(|channel| x.clone().narrow(1, channel, 1)).collect(), 1)
        };
        match self.spec.head {
            Head::Image => made,
            Head::Filter(filter) => ops::filtered(filter, made, channels(self.spec.pyramid_channels())),
            Head::Correction(correction) => {
                let estimate = channels(self.spec.channels_of(correction.of));
                plain::corrected(correction, estimate, channels(self.spec.pyramid_channels()), made)
            }
        }
    }

    /// The input padded with its edge.
    fn padded(&self, x: Tensor<4>) -> Tensor<4> {
        let [_, _, height, width] = x.dims();
        let missing = |size: usize| size.next_multiple_of(self.spec.alignment()) - size;
        match missing(height) + missing(width) {
            0 => x,
            _ => x.pad((0, missing(width), 0, missing(height)), PadMode::Edge),
        }
    }

    /// What every layer makes of images whose height and width are multiples of [`NetSpec::alignment`].
    pub(crate) fn layers(&self, x: Tensor<4>) -> Vec<Tensor<4>> {
        let mut outputs: Vec<Tensor<4>> = Vec::with_capacity(self.convs.len());
        for (layer, conv) in self.layers.iter().zip(&self.convs) {
            let leak = if layer.activation { self.spec.leak } else { 1.0 };
            let (weight, bias) = (conv.weight.val(), conv.bias.val());
            let made = |index: usize| outputs[index].clone();
            outputs.push(match layer.source {
                BlockSource::Input => ops::convolve(x.clone(), weight, bias, false, leak),
                BlockSource::Folded => ops::convolve(folded(x.clone()), weight, bias, false, leak),
                BlockSource::Plain(from) => ops::convolve(made(from), weight, bias, false, leak),
                BlockSource::Pooled(finer) => ops::convolve(made(finer), weight, bias, true, leak),
                BlockSource::Joined { coarse, skip, groups } => {
                    ops::convolve_joined([made(coarse), made(skip)], weight, bias, groups, leak)
                }
            });
        }
        outputs
    }
}

/// The pixels of squares of four as channels, at half the resolution: space to depth.
fn folded(x: Tensor<4>) -> Tensor<4> {
    let [batch, channels, height, width] = x.dims();
    let squares: Tensor<6> = x.reshape([batch, channels, height / 2, 2, width / 2, 2]);
    squares.permute([0, 3, 5, 1, 2, 4]).reshape([batch, 4 * channels, height / 2, width / 2])
}

/// Channels that are the pixels of squares, `1 << level` along an axis, as those pixels: depth to space.
fn unfolded(x: Tensor<4>, level: usize) -> Tensor<4> {
    if level == 0 {
        return x;
    }
    let side = 1 << level;
    let [batch, made, height, width] = x.dims();
    let channels = made / (side * side);
    let squares: Tensor<6> = x.reshape([batch, side, side, channels, height, width]);
    squares.permute([0, 3, 4, 1, 5, 2]).reshape([batch, channels, side * height, side * width])
}

/// Numbers cut to a range, of which the greatest may be infinite.
fn within(x: Tensor<4>, [least, most]: [f32; 2]) -> Tensor<4> {
    let x = x.clamp_min(least);
    if most.is_finite() { x.clamp_max(most) } else { x }
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

/// What every layer makes through burn on the way to [`forward_burn`]'s image, as
/// [`reference::layers`](deepshade_infer::reference::layers) gives it.
pub fn layers_burn(spec: &NetSpec, weights: &Weights, input: &Planes) -> Vec<Activation> {
    let device = crate::device();
    let net = UNet::from_weights(spec, weights, &device);
    let x = net.padded(to_tensor(&[input], &device));
    let mut made = net.layers(x.clone());
    let last = made.pop().map(|_| to_planes(net.forward(to_tensor(&[input], &device))));
    let made = made.into_iter().map(to_planes).chain(last);
    spec.layers()
        .into_iter()
        .zip(made)
        .map(|(layer, planes)| Activation { layer: layer.name, planes })
        .collect()
}

/// Images of one size as a tensor `[batch, channels, height, width]`.
///
/// # Panics
/// If there is no image, or they differ in shape.
pub fn to_tensor(images: &[&Planes], device: &Device) -> Tensor<4> {
    let shape = [images.len(), images[0].channels(), images[0].height(), images[0].width()];
    let data = images.iter().flat_map(|image| image.data()).copied().collect();
    Tensor::from_data(TensorData::new::<f32, _>(data, shape), device)
}

/// The only image of a tensor `[1, channels, height, width]`.
pub(crate) fn to_planes(tensor: Tensor<4>) -> Planes {
    let [_, channels, height, width] = tensor.dims();
    let data = tensor.into_data().try_into_vec::<f32>().expect("images are f32");
    Planes::from_data(channels, height, width, data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Colour, Comparison, Filter, Reach, parity, reference};
    use deepshade_shaders::Effect;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn ao_has_the_papers_number_of_weights() {
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            let net = UNet::random(&NetSpec::ao(order, REACH), 1, &crate::device());
            assert_eq!(net.num_params(), 71_089);
        }
    }

    /// A network for depth of field that predicts kernels.
    fn filtering(order: ChannelOrder, colour: Colour, filter: Filter) -> NetSpec {
        let published = NetSpec::published(Effect::Dof, order, REACH).expect("the paper has one");
        NetSpec { colour, ..published }.with_head(Head::Filter(filter))
    }

    #[test]
    fn layers_are_the_references() {
        let order = ChannelOrder::Interleaved;
        let ao = NetSpec::ao(order, REACH).reshaped(|net| net.levels = 3);
        for spec in [ao, filtering(order, Colour::Mono, Filter { levels: 5, kernel: 1, black: false })] {
            let weights = Weights::random(&spec, 4);
            let input = parity::noise(spec.input_channels(), 21, 30, 7);
            let expected = reference::layers(&spec, &weights, &input);
            assert_eq!(parity::first_difference(&expected, &layers_burn(&spec, &weights, &input)), None);
        }
    }

    #[test]
    fn weights_survive_the_way_through_burn() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
        let weights = Weights::random(&spec, 3);
        assert_eq!(UNet::from_weights(&spec, &weights, &crate::device()).weights(), weights);
    }

    #[test]
    fn agrees_with_the_reference_at_any_size() {
        let sizes = [(16, 16), (64, 32), (37, 83), (101, 19)];
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            let ao = NetSpec::ao(order, REACH);
            let specs = [
                ao.clone(),
                ao.clone().reshaped(|net| net.levels = 1),
                ao.reshaped(|net| (net.levels, net.kernel, net.u0) = (3, 5, 4)),
                filtering(order, Colour::Mono, Filter { levels: 4, kernel: 3, black: false }),
                filtering(order, Colour::Rgb, Filter { levels: 5, kernel: 3, black: false }),
                filtering(order, Colour::Rgb, Filter { levels: 2, kernel: 3, black: true }),
            ];
            for (seed, spec) in specs.iter().enumerate() {
                let weights = Weights::random(spec, seed as u32);
                for (height, width) in sizes {
                    let input = parity::noise(spec.input_channels(), height, width, 7);
                    let expected = reference::forward(spec, &weights, &input);
                    let comparison = Comparison::new(&expected, &forward_burn(spec, &weights, &input));
                    assert!(
                        comparison.agrees(),
                        "{order:?}, {} levels, {height}x{width}: {comparison:?}",
                        spec.levels()
                    );
                }
            }
        }
    }

    #[test]
    fn the_other_channel_order_is_another_network() {
        let spec = NetSpec::ao(ChannelOrder::Contiguous, REACH);
        let weights = Weights::random(&spec, 1);
        let input = parity::noise(6, 32, 32, 7);
        let other = spec.clone().reshaped(|net| net.order = ChannelOrder::Interleaved);
        let comparison =
            Comparison::new(&forward_burn(&spec, &weights, &input), &forward_burn(&other, &weights, &input));
        assert!(!comparison.agrees());
    }
}
