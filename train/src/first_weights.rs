//! What the weights of a network are before its first step.

use crate::rng::{Purpose, Rng};
use deepshade_infer::weights::LayerWeights;
use deepshade_infer::{BlockSource, Head, Layer, NetSpec, Weights};
use deepshade_shaders::Attribute;

/// Weights of the layer that makes the image, over those of other layers.
const IMAGE_SCALE: f64 = 0.01;

/// The share of their usual deviation that the weights of a residual layer have beside the identity.
const RESIDUAL_SCALE: f64 = 0.3;

/// Random weights: normal, of variance `2 / ((1 + leak^2) * fan-in)` (He et al. 2015, equation 15); biases
/// are 0. The layer that makes the image starts near the effect's background, with weights a hundredth of
/// that and the background as its bias: far from the target, structural similarity hardly has a gradient. For
/// the same reason a network whose effect filters light starts with the image that it is given, and one that
/// corrects an estimate with the estimate. Where kernels are predicted all weights are random: a softmax that
/// starts near that image, with one weight far above all others, has no gradient by which to leave it. A
/// layer of kernels that reads a layer as wide as itself is residual: it starts near the identity.
pub fn first_weights(spec: &NetSpec, seed: u64) -> Weights {
    let mut weights = random_weights(spec, seed);
    if spec.effect.definition().filters_light && spec.head == Head::Image {
        pass_light(&spec.layers(), &spec.channels_of(Attribute::Light), &mut weights);
    }
    if let (Head::Correction(_), Some(last)) = (spec.head, weights.0.last_mut()) {
        last.weight.fill(0.0);
        last.bias.fill(0.0);
    }
    weights
}

/// As [`first_weights`], without the image that a network is given.
pub fn random_weights(spec: &NetSpec, seed: u64) -> Weights {
    let layers = spec.layers().into_iter().enumerate().map(|(index, layer)| {
        let area = layer.kernel * layer.kernel;
        let fan_in = (layer.inputs / layer.groups * area) as f64;
        let residual = is_residual(&layer);
        let (scale, bias) = match (layer.activation, spec.head) {
            (true, _) if residual => (RESIDUAL_SCALE, 0.0),
            (true, _) | (false, Head::Filter(_) | Head::Correction(_)) => (1.0, 0.0),
            (false, Head::Image) => (IMAGE_SCALE, spec.effect.background().unwrap_or(0.0)),
        };
        let deviation = scale * (2.0 / (1.0 + f64::from(spec.leak).powi(2)) / fan_in).sqrt();
        let mut rng = Rng::new(seed, Purpose::Weights, index as u64);
        let count = layer.weight_count() - layer.outputs;
        let mut weight: Vec<f32> = (0..count).map(|_| (deviation * rng.normal()) as f32).collect();
        if residual {
            (0..layer.outputs).for_each(|channel| {
                weight[(channel * layer.inputs + channel) * area + area / 2] += 1.0;
            });
        }
        LayerWeights { weight, bias: vec![bias; layer.outputs] }
    });
    Weights(layers.collect())
}

/// Whether a layer is one whose kernel begins as the identity.
fn is_residual(layer: &Layer) -> bool {
    let plain = matches!(layer.source, BlockSource::Plain(_)) && layer.activation;
    plain && layer.groups == 1 && layer.kernel > 1 && layer.inputs == layer.outputs
}

/// Makes the first kernels of the first layer hand on the channels of light, which no activation changes as
/// no light is negative, and the last layer add them to its image.
fn pass_light(layers: &[Layer], lights: &[usize], weights: &mut Weights) {
    let (Some(first), Some(last), [down, .., up]) = (layers.first(), layers.last(), &mut weights.0[..])
    else {
        return;
    };
    if first.groups != 1 || last.groups != 1 || lights.len() != last.outputs || lights.len() > first.outputs {
        return;
    }
    if first.kernel != last.kernel || last.inputs < first.outputs {
        return;
    }
    let area = first.kernel * first.kernel;
    // Channels of the first layer, among those that the last one reads.
    let skip = match last.source {
        BlockSource::Joined { .. } => last.inputs - first.outputs,
        _ => 0,
    };
    for (index, light) in lights.iter().enumerate() {
        let kernel = &mut down.weight[index * first.inputs * area..][..first.inputs * area];
        kernel.fill(0.0);
        kernel[light * area + area / 2] = 1.0;
        up.weight[(index * last.inputs + skip + index) * area + area / 2] += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Filter, Reach, parity, reference};
    use deepshade_shaders::{Effect, Planes};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    fn published(effect: Effect) -> NetSpec {
        NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("the paper has one")
    }

    #[test]
    fn they_keep_the_size_of_what_passes_through() {
        let spec = published(Effect::Ao);
        let input = parity::noise(6, 64, 64, 7);
        for activation in reference::layers(&spec, &first_weights(&spec, 5), &input) {
            let rms = parity::rms(&activation.planes);
            assert!((0.1..4.0).contains(&rms), "{}: {rms}", activation.layer);
        }
    }

    #[test]
    fn a_network_that_predicts_kernels_starts_with_no_weight_alone() {
        for (kernel, shares) in [(1, 0.05..0.6), (3, 0.001..0.1)] {
            let filter = Filter { levels: 5, kernel, black: false };
            let spec = published(Effect::Dof).with_head(Head::Filter(filter));
            let mut light = Planes::filled(3, 32, 32, 0.0);
            light.plane_mut(2)[16 * 32 + 16] = 1.0;
            let own = reference::forward(&spec, &first_weights(&spec, 5), &light).at(0, 16, 16);
            assert!(shares.contains(&own), "a pixel's share of itself, {kernel}x{kernel}: {own}");
        }
    }

    #[test]
    fn little_is_hidden_before_the_first_step() {
        let spec = published(Effect::Multi).predicting_kernels().expect("it reads light");
        let light = Planes::filled(spec.input_channels(), 32, 32, 0.5);
        let image = reference::forward(&spec, &first_weights(&spec, 5), &light);
        assert!(image.data().iter().all(|value| (0.3..0.4999).contains(value)));
    }

    #[test]
    fn a_network_that_filters_light_starts_with_what_it_is_given() {
        for effect in Effect::ALL.into_iter().filter(|effect| effect.definition().filters_light) {
            let spec = published(effect);
            let noise = parity::noise(spec.input_channels(), 64, 48, 3);
            let input = Planes::from_fn(noise.channels(), 64, 48, |c, y, x| noise.at(c, y, x).abs());
            let image = reference::forward(&spec, &first_weights(&spec, 5), &input);
            for (output, light) in spec.channels_of(Attribute::Light).into_iter().enumerate() {
                let differences =
                    image.plane(output).iter().zip(input.plane(light)).map(|(a, b)| (a - b).abs());
                let largest = differences.fold(0.0, f32::max);
                assert!(largest > 0.0 && largest < 0.3, "{effect}: {largest}");
            }
        }
    }
}
