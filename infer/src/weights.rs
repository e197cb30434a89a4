//! The weights of a network, layer by layer, as plain arrays.

use crate::{BlockSource, Head, Layer, NetSpec, parity, reference};
use deepshade_shaders::random::random;

/// Weights and biases of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerWeights {
    /// `[outputs, inputs / groups, kernel, kernel]`. Inputs are in the order in which the layer reads them
    /// ([`Layer::read_order`]).
    pub weight: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// The weights of all layers, in the order of [`NetSpec::blocks`].
#[derive(Clone, Debug, PartialEq)]
pub struct Weights(pub Vec<LayerWeights>);

impl Weights {
    /// Random weights without any symmetry, scaled layer by layer so that every layer makes an image of rms 1
    /// from [`parity::noise`] (after Mishkin and Matas 2016, "All you need is a good init"): nothing fades
    /// out on the way, so an error anywhere shows at the end.
    pub fn random(spec: &NetSpec, seed: u32) -> Self {
        let side = (2 * spec.alignment()).max(16);
        let noise = parity::noise(spec.input_channels(), side, side, seed);
        let mut weights = Self(Vec::new());
        let mut made = Vec::new();
        for (index, layer) in spec.layers().iter().enumerate() {
            let number = |i: usize, of: u32| random(i as u32, of, seed, index as u32 + 1) - 0.5;
            let count = layer.weight_shape().iter().product();
            let mut weight = LayerWeights {
                weight: (0..count).map(|i| number(i, 0)).collect(),
                bias: (0..layer.outputs).map(|i| number(i, 1)).collect(),
            };
            // The leaky ReLU scales with what it is given, so dividing by the rms makes the rms 1.
            let rms =
                parity::rms(&reference::layer(spec, layer, &weight, &noise, &made)).max(f32::MIN_POSITIVE);
            // Weights of many taps that are each as large as the image would make anything of it.
            let share = match spec.head {
                Head::Correction(_) if !layer.activation => spec.head_channels() as f32,
                _ => 1.0,
            };
            weight.weight.iter_mut().chain(&mut weight.bias).for_each(|value| *value /= rms * share);
            made.push(reference::layer(spec, layer, &weight, &noise, &made));
            weights.0.push(weight);
        }
        weights
    }

    /// The same network with every layer but the last scaled by a power of two, so that the largest of what
    /// it makes of [`parity::noise`] is from 1 to 2, and what reads it scaled back: leaky ReLUs pass a
    /// positive factor on, so the image is the same to the last bit. Training leaves features as large as it
    /// likes, and half floats end at 65,504.
    #[must_use]
    pub fn balanced(mut self, spec: &NetSpec) -> Self {
        let side = (2 * spec.alignment()).max(64);
        let noise = parity::noise(spec.input_channels(), side, side, 1);
        let layers = spec.layers();
        let mut factors = scales(&reference::layers(spec, &self, &noise));
        *factors.last_mut().expect("a network has a layer") = 1.0;
        for ((layer, factor), weights) in layers.iter().zip(&factors).zip(&mut self.0) {
            let read = factors_read(&layers, layer, &factors);
            weights.scale(layer, *factor, &read);
        }
        self
    }

    /// Whether every array has the length that the spec asks for.
    pub fn fit(&self, spec: &NetSpec) -> bool {
        let layers = spec.layers();
        self.0.len() == layers.len()
            && self.0.iter().zip(&layers).all(|(weights, layer)| {
                weights.bias.len() == layer.outputs
                    && weights.weight.len() + weights.bias.len() == layer.weight_count()
            })
    }
}

impl LayerWeights {
    /// Makes the layer's image `factor` times as large, where channel `c` of what it reads is `read[c]` times
    /// as large as it was.
    fn scale(&mut self, layer: &Layer, factor: f32, read: &[f32]) {
        let area = layer.kernel * layer.kernel;
        let (share, per_group) = (layer.inputs / layer.groups, layer.outputs / layer.groups);
        for (index, taps) in self.weight.chunks_mut(area).enumerate() {
            let (output, input) = (index / share, index % share);
            let channel = output / per_group * share + input;
            taps.iter_mut().for_each(|weight| *weight *= factor / read[channel]);
        }
        self.bias.iter_mut().for_each(|bias| *bias *= factor);
    }
}

/// For each layer the power of two that brings its largest magnitude to between 1 and 2; 1 where it makes
/// nothing.
fn scales(made: &[parity::Activation]) -> Vec<f32> {
    let scale = |largest: f32| if largest.is_normal() { (-largest.log2().floor()).exp2() } else { 1.0 };
    made.iter().map(|made| scale(parity::largest(&made.planes))).collect()
}

/// For each channel that a layer reads the factor of the layer from which it is.
fn factors_read(layers: &[Layer], layer: &Layer, factors: &[f32]) -> Vec<f32> {
    let of = |channel: usize| match layer.source {
        BlockSource::Input | BlockSource::Folded => 1.0,
        BlockSource::Plain(from) | BlockSource::Pooled(from) => factors[from],
        BlockSource::Joined { coarse, skip, .. } => {
            factors[if channel < layers[coarse].outputs { coarse } else { skip }]
        }
    };
    layer.read_order(layers).into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};

    #[test]
    fn random_weights_fit_and_keep_every_layer_at_rms_1() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let weights = Weights::random(&spec, 3);
        assert!(weights.fit(&spec));
        let other_input = parity::noise(spec.input_channels(), 96, 80, 4);
        for made in reference::layers(&spec, &weights, &other_input) {
            let rms = parity::rms(&made.planes);
            assert!((0.7..1.4).contains(&rms), "{}: rms {rms}", made.layer);
        }
    }

    #[test]
    fn balanced_weights_make_the_same_image_of_features_that_half_floats_hold() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        for order in [ChannelOrder::Interleaved, ChannelOrder::Contiguous] {
            let spec = NetSpec::ao(order, reach).reshaped(|net| net.levels = 4);
            let mut weights = Weights::random(&spec, 3);
            // What training may do: one layer far too large for half floats, another far too small.
            for (index, factor) in [(1, 3e6_f32), (2, 1e-9)] {
                let layer = &mut weights.0[index];
                layer.weight.iter_mut().chain(&mut layer.bias).for_each(|value| *value *= factor);
            }
            let balanced = weights.clone().balanced(&spec);
            let input = parity::noise(spec.input_channels(), 75, 50, 9);
            let [before, after] =
                [&weights, &balanced].map(|weights| reference::layers(&spec, weights, &input));
            assert_eq!(before.last(), after.last(), "the image, to the last bit");
            let largest = |made: &[parity::Activation]| {
                made[..made.len() - 1].iter().map(|made| parity::largest(&made.planes)).fold(0.0, f32::max)
            };
            assert!(largest(&before) > 65_504.0, "what is to be mended: {}", largest(&before));
            for made in &after[..after.len() - 1] {
                let largest = parity::largest(&made.planes);
                assert!((0.5..4.0).contains(&largest), "{}: {largest}", made.layer);
            }
            assert_ne!(weights, balanced);
        }
    }
}
