//! What the weights of a network are before its first step.

use crate::rng::{Purpose, Rng};
use deepshade_infer::weights::LayerWeights;
use deepshade_infer::{Layer, NetSpec, Source, Weights};

/// Weights of the layer that makes the image, over those of other layers.
const IMAGE_SCALE: f64 = 0.01;

/// Random weights: normal, of variance `2 / ((1 + leak^2) * fan-in)` (He et al. 2015, equation 15); biases are 0. The layer
/// that makes the image starts near the effect's background, with weights a hundredth of that and the background as its
/// bias: far from the target, structural similarity hardly has a gradient. For the same reason a network whose effect
/// filters light starts with the image that it is given. Where kernels are predicted all weights are random: a softmax that
/// starts near that image, with one weight far above all others, has no gradient by which to leave it.
pub fn first_weights(spec: &NetSpec, seed: u64) -> Weights {
    of_layers(spec, &spec.layers(), &spec.light_channels(), seed)
}

/// As [`first_weights`], for layers that differ from those of the spec in their numbers of channels, the first of which reads
/// the light in these channels.
pub(crate) fn of_layers(spec: &NetSpec, layers: &[Layer], lights: &[usize], seed: u64) -> Weights {
    let mut weights = random(spec, layers, seed);
    if spec.effect.filters_light() && spec.filter.is_none() {
        pass_light(layers, spec.kernel, lights, &mut weights);
    }
    weights
}

/// As [`first_weights`], without the image that a network is given.
pub fn random_weights(spec: &NetSpec, seed: u64) -> Weights {
    random(spec, &spec.layers(), seed)
}

fn random(spec: &NetSpec, layers: &[Layer], seed: u64) -> Weights {
    let area = spec.kernel * spec.kernel;
    let layers = layers.iter().enumerate().map(|(index, layer)| {
        let fan_in = (layer.inputs / layer.groups * area) as f64;
        let (scale, bias) = if layer.activation || spec.filter.is_some() {
            (1.0, 0.0)
        } else {
            (IMAGE_SCALE, spec.effect.background().unwrap_or(0.0))
        };
        let deviation = scale * (2.0 / (1.0 + f64::from(spec.leak).powi(2)) / fan_in).sqrt();
        let mut rng = Rng::new(seed, Purpose::Weights, index as u64);
        let count = layer.weight_count(spec.kernel) - layer.outputs;
        let weight = (0..count).map(|_| (deviation * rng.normal()) as f32).collect();
        LayerWeights { weight, bias: vec![bias; layer.outputs] }
    });
    Weights(layers.collect())
}

/// Makes the first kernels of the first layer hand on the channels of light, which no activation changes as no light is
/// negative, and the last layer add them to its image.
fn pass_light(layers: &[Layer], kernel: usize, lights: &[usize], weights: &mut Weights) {
    let (Some(first), Some(last), [down, .., up]) = (layers.first(), layers.last(), &mut weights.0[..])
    else {
        return;
    };
    if first.groups != 1 || last.groups != 1 || lights.len() != last.outputs || lights.len() > first.outputs {
        return;
    }
    let area = kernel * kernel;
    // Channels of the first layer, among those that the last one reads.
    let skip = match last.source {
        Source::Joined { .. } => last.inputs - first.outputs,
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
            let filter = Some(Filter { levels: 5, kernel, black: false });
            let spec = NetSpec { filter, ..published(Effect::Dof) };
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
        for effect in Effect::ALL.into_iter().filter(|effect| effect.filters_light()) {
            let spec = published(effect);
            let noise = parity::noise(spec.input_channels(), 64, 48, 3);
            let input = Planes::from_fn(noise.channels(), 64, 48, |c, y, x| noise.at(c, y, x).abs());
            let image = reference::forward(&spec, &first_weights(&spec, 5), &input);
            for (output, light) in spec.light_channels().into_iter().enumerate() {
                let differences =
                    image.plane(output).iter().zip(input.plane(light)).map(|(a, b)| (a - b).abs());
                let largest = differences.fold(0.0, f32::max);
                assert!(largest > 0.0 && largest < 0.3, "{effect}: {largest}");
            }
        }
    }
}
