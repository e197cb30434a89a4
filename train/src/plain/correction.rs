//! A [`Correction`] written with burn's tensors. What it is of and what its pyramid is of are data and need
//! no gradient.

use super::filter::taps;
use burn::tensor::Tensor;
use deepshade_infer::{Correction, HALF_GATE};

/// The image, unbounded, of an estimate, of what the pyramid is of, both padded, and of what the last block
/// makes.
///
/// # Shapes
/// `estimate` and `over` `[batch, channels, height, width]`, `made`
/// `[batch, biases + weights, height, width]`, to `[batch, channels, height, width]`.
pub fn corrected(correction: Correction, estimate: Tensor<4>, over: Tensor<4>, made: Tensor<4>) -> Tensor<4> {
    let [_, channels, _, _] = estimate.dims();
    let (biases, count) = (correction.bias_count(channels), correction.filter().tap_count());
    let added = match correction.gain {
        true => estimate.clone() * made.clone().narrow(1, count, 1),
        false => made.clone().narrow(1, 0, channels),
    };
    if count == 0 {
        return estimate + added;
    }
    let weights = made.narrow(1, biases, count);
    let taps = taps(correction.filter(), over.clone());
    let sum = |channel: usize| {
        let there = Tensor::cat(taps.iter().map(|tap| tap.clone().narrow(1, channel, 1)).collect(), 1);
        (weights.clone() * (there - estimate.clone().narrow(1, channel, 1))).sum_dim(1)
    };
    let corrections = added + Tensor::cat((0..channels).map(sum).collect(), 1);
    if !correction.gated {
        return estimate + corrections;
    }
    let difference = (over - estimate.clone()).abs().max_dim(1);
    let gate = difference.clone() / (difference + HALF_GATE);
    estimate + gate * corrections
}
