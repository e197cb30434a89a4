//! A stem that loses nothing (Xiao et al. 2018, "DeepFocus: learned image synthesis for computational displays"): the network
//! reads the four pixels of a square as four times the channels, works at half the resolution, and makes four pixels.

use crate::UNet;
use crate::first_weights::of_layers;
use burn::tensor::ops::PadMode;
use burn::tensor::{Device, Tensor};
use deepshade_infer::{Layer, NetSpec};

/// Pixels of a square.
const SQUARE: usize = 4;

/// The layers of the paper's network, of which the first reads and the last makes four times the channels.
pub fn layers(spec: &NetSpec) -> Vec<Layer> {
    let mut layers = spec.layers();
    layers.iter_mut().take(1).for_each(|first| first.inputs *= SQUARE);
    layers.iter_mut().next_back().into_iter().for_each(|last| last.outputs *= SQUARE);
    layers
}

/// A network with its first weights.
pub fn first(spec: &NetSpec, seed: u64, device: &Device) -> UNet {
    let layers = layers(spec);
    let squares = |light: usize| SQUARE * light..SQUARE * (light + 1);
    let lights: Vec<usize> = spec.light_channels().into_iter().flat_map(squares).collect();
    let weights = of_layers(spec, &layers, &lights, seed);
    UNet::with_layers(spec, layers, &weights, device)
}

/// The network's image.
pub fn forward(net: &UNet, x: Tensor<4>) -> Tensor<4> {
    let [_, _, height, width] = x.dims();
    let missing = |size: usize| size.next_multiple_of(2 * net.spec().alignment()) - size;
    let x = x.pad((0, missing(width), 0, missing(height)), PadMode::Edge);
    let made = net.layers(to_depth(x)).pop().expect("a network has a layer");
    to_space(made).narrow(2, 0, height).narrow(3, 0, width)
}

/// Squares of pixels as channels: `[batch, channels, height, width]` to `[batch, channels * 4, height / 2, width / 2]`.
pub fn to_depth(x: Tensor<4>) -> Tensor<4> {
    let [batch, channels, height, width] = x.dims();
    let squares = x.reshape([batch, channels, height / 2, 2, width / 2, 2]);
    squares.permute([0, 1, 3, 5, 2, 4]).reshape([batch, SQUARE * channels, height / 2, width / 2])
}

/// The inverse of [`to_depth`].
pub fn to_space(x: Tensor<4>) -> Tensor<4> {
    let [batch, channels, height, width] = x.dims();
    let squares = x.reshape([batch, channels / SQUARE, 2, 2, height, width]);
    squares.permute([0, 1, 4, 2, 5, 3]).reshape([batch, channels / SQUARE, 2 * height, 2 * width])
}
