//! Convolution with what comes before and after it.

use super::{join, leaky};
use burn::tensor::Tensor;
use burn::tensor::module::conv2d;
use burn::tensor::ops::ConvOptions;

/// As `kernels::convolve`.
pub fn convolve(x: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>, pooled: bool, leak: f32) -> Tensor<4> {
    let x = if pooled { super::pooled(x) } else { x };
    let [_, inputs, kernel, _] = weight.dims();
    let groups = x.dims()[1] / inputs;
    let options = ConvOptions::new([1, 1], [kernel / 2; 2], [1, 1], groups);
    let sums = conv2d(x, weight, Some(bias), options);
    if leak == 1.0 { sums } else { leaky(sums, leak) }
}

/// As `kernels::convolve_joined`.
pub fn convolve_joined(
    [coarse, fine]: [Tensor<4>; 2],
    weight: Tensor<4>,
    bias: Tensor<1>,
    join_groups: usize,
    leak: f32,
) -> Tensor<4> {
    convolve(join(coarse, fine, join_groups), weight, bias, false, leak)
}
