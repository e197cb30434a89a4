//! The filter of [`deepshade_infer::filter`] written with burn's tensors. The light is data and needs no
//! gradient.

use burn::tensor::Tensor;
#[cfg(test)]
use burn::tensor::activation::softmax;
use burn::tensor::module::avg_pool2d;
use burn::tensor::ops::{AvgPoolOptions, PadMode};
use deepshade_infer::Filter;

/// As `kernels::filtered`.
#[cfg(test)]
pub fn filtered(filter: Filter, made: Tensor<4>, light: Tensor<4>) -> Tensor<4> {
    let weights = softmax(made, 1).narrow(1, 0, filter.tap_count());
    let [_, channels, _, _] = light.dims();
    let taps = taps(filter, light);
    let image = |channel: usize| {
        let light = taps.iter().map(|tap| tap.clone().narrow(1, channel, 1)).collect();
        (weights.clone() * Tensor::cat(light, 1)).sum_dim(1)
    };
    Tensor::cat((0..channels).map(image).collect(), 1)
}

/// The light as every tap reads it, `[batch, channels, height, width]`, in the order of their weights.
pub(super) fn taps(filter: Filter, light: Tensor<4>) -> Vec<Tensor<4>> {
    let [_, _, height, width] = light.dims();
    let (kernel, radius) = (filter.kernel, filter.kernel / 2);
    let mut taps = Vec::with_capacity(filter.tap_count());
    let mut level = light;
    for index in 0..filter.levels {
        if index > 0 {
            level = avg_pool2d(level, AvgPoolOptions::new([2, 2]));
        }
        let scale = 1 << index;
        let wide = level.clone().pad((radius, radius, radius, radius), PadMode::Edge);
        let wide = spread_along(spread_along(wide, 2, scale), 3, scale);
        for (y, x) in (0..kernel).flat_map(|y| (0..kernel).map(move |x| (y, x))) {
            taps.push(wide.clone().narrow(2, y * scale, height).narrow(3, x * scale, width));
        }
    }
    taps
}

/// One dimension `scale` times as long, a power of two: linear between the centres of pixels, and beyond the
/// outermost as there.
fn spread_along(x: Tensor<4>, dimension: usize, scale: usize) -> Tensor<4> {
    if scale == 1 {
        return x;
    }
    let mut dims = x.dims();
    let size = dims[dimension];
    let edge = |at: usize| x.clone().narrow(dimension, at, 1);
    let replicated = Tensor::cat(vec![edge(0), x.clone(), edge(size - 1)], dimension);
    let child = |index: usize| {
        let position = (index as f64 + 0.5) / scale as f64 - 0.5;
        let near = if position < 0.0 { 0 } else { 2 };
        let neighbour = replicated.clone().narrow(dimension, near, size);
        x.clone() * (1.0 - position.abs()) + neighbour * position.abs()
    };
    dims[dimension] *= scale;
    Tensor::stack::<5>((0..scale).map(child).collect(), dimension + 1).reshape(dims)
}
