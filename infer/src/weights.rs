//! The weights of a network, layer by layer, as plain arrays.

use crate::{NetSpec, parity, reference};
use deepshade_shaders::random::random;

/// Weights and biases of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerWeights {
    /// `[outputs, inputs / groups, kernel, kernel]`. Inputs are in the order in which the layer reads them
    /// ([`NetSpec::joined_order`]).
    pub weight: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// The weights of all layers, in the order of [`NetSpec::layers`].
#[derive(Clone, Debug, PartialEq)]
pub struct Weights(pub Vec<LayerWeights>);

impl Weights {
    /// Random weights without any symmetry, scaled layer by layer so that every layer makes an image of rms 1 from
    /// [`parity::noise`] (after Mishkin and Matas 2016, "All you need is a good init"): nothing fades out on the way,
    /// so an error anywhere shows at the end.
    pub fn random(spec: &NetSpec, seed: u32) -> Self {
        let side = (2 * spec.alignment()).max(16);
        let noise = parity::noise(spec.input_channels(), side, side, seed);
        let mut weights = Self(Vec::new());
        let mut made = Vec::new();
        for (index, layer) in spec.layers().iter().enumerate() {
            let number = |i: usize, of: u32| random(i as u32, of, seed, index as u32 + 1) - 0.5;
            let count = layer.weight_shape(spec.kernel).iter().product();
            let mut weight = LayerWeights {
                weight: (0..count).map(|i| number(i, 0)).collect(),
                bias: (0..layer.outputs).map(|i| number(i, 1)).collect(),
            };
            // The leaky ReLU scales with what it is given, so dividing by the rms makes the rms 1.
            let rms =
                parity::rms(&reference::layer(spec, layer, &weight, &noise, &made)).max(f32::MIN_POSITIVE);
            weight.weight.iter_mut().chain(&mut weight.bias).for_each(|value| *value /= rms);
            made.push(reference::layer(spec, layer, &weight, &noise, &made));
            weights.0.push(weight);
        }
        weights
    }

    /// Whether every array has the length that the spec asks for.
    pub fn fit(&self, spec: &NetSpec) -> bool {
        let layers = spec.layers();
        self.0.len() == layers.len()
            && self.0.iter().zip(&layers).all(|(weights, layer)| {
                weights.bias.len() == layer.outputs
                    && weights.weight.len() + weights.bias.len() == layer.weight_count(spec.kernel)
            })
    }
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
}
