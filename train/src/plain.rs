//! The network's operations written with burn's tensors: what the kernels of processor (`kernels`) and GPU
//! (`gpu`) are tested against, and the head that corrects an estimate, of which data alone have no gradient.

#[cfg(test)]
mod convolve;
mod correction;
mod filter;

#[cfg(any(test, feature = "vulkan"))]
use burn::tensor::Tensor;
#[cfg(test)]
use burn::tensor::activation::leaky_relu;
#[cfg(any(test, feature = "vulkan"))]
use burn::tensor::{module::avg_pool2d, ops::AvgPoolOptions};
pub use correction::corrected;
#[cfg(test)]
pub use {
    convolve::{convolve, convolve_joined},
    filter::filtered,
};

/// Leaky ReLU.
#[cfg(test)]
pub fn leaky(x: Tensor<4>, leak: f32) -> Tensor<4> {
    leaky_relu(x, leak.into())
}

/// Means of 2x2 pixels.
#[cfg(any(test, feature = "vulkan"))]
pub fn pooled(x: Tensor<4>) -> Tensor<4> {
    avg_pool2d(x, AvgPoolOptions::new([2, 2]))
}

/// Doubling and concatenation, as slices and blends.
#[cfg(test)]
pub fn join(coarse: Tensor<4>, fine: Tensor<4>, groups: usize) -> Tensor<4> {
    let doubled = double_along(double_along(coarse, 2), 3);
    let [batch, channels, height, width] = fine.dims();
    let joined = [batch, channels + doubled.dims()[1], height, width];
    let shares = |x: Tensor<4>| {
        let share = x.dims()[1] / groups;
        x.reshape([batch, groups, share, height, width])
    };
    Tensor::cat(vec![shares(doubled), shares(fine)], 2).reshape(joined)
}

/// Doubles one dimension: every value's two children lean a quarter towards its neighbour on their side.
#[cfg(test)]
fn double_along(x: Tensor<4>, dimension: usize) -> Tensor<4> {
    let mut dims = x.dims();
    let size = dims[dimension];
    let edge = |at: usize| x.clone().narrow(dimension, at, 1);
    let replicated = Tensor::cat(vec![edge(0), x.clone(), edge(size - 1)], dimension) * 0.25;
    let centre = x * 0.75;
    let children = vec![
        centre.clone() + replicated.clone().narrow(dimension, 0, size),
        centre + replicated.narrow(dimension, 2, size),
    ];
    dims[dimension] *= 2;
    Tensor::stack::<5>(children, dimension + 1).reshape(dims)
}
