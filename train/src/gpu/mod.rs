//! The network's steps on a GPU, as a backend extension of burn's CubeCL backends: convolution with bias and
//! leaky ReLU, doubling with concatenation, and the filter by predicted kernels, each as one operation with
//! one gradient.
//!
//! burn's own kernels find the gradient of grouped weights by one convolution a group, of which a network has
//! more than a hundred, and are slow unless burn's feature `autotune` chooses among them, which takes minutes
//! for a network. These are compiled in seconds.

mod convolution;
mod correlation;
mod filter;
mod join;
mod launch;

use crate::plain;
use burn::backend::autodiff::NodeId;
use burn::backend::autodiff::checkpoint::{base::Checkpointer, strategy::CheckpointStrategy};
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind};
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Cube, Dispatch, TensorMetadata, backend_extension};
use burn::tensor::Tensor;
use deepshade_infer::Filter;

/// A tensor of the GPU's backend.
type Gpu = FloatTensor<Cube>;

/// The operations that a GPU has kernels for.
#[backend_extension(Cube, Autodiff)]
pub trait NetOps: Backend {
    /// [`convolve`], of an image that is not to be pooled.
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        leak: f32,
    ) -> FloatTensor<Self>;
    /// `coarse`, doubled, concatenated with `fine` in so many groups.
    fn join(coarse: FloatTensor<Self>, fine: FloatTensor<Self>, groups: usize) -> FloatTensor<Self>;
    /// The image of a filter, of the [pyramid](pyramid) of the light, which has a gradient by `made` alone.
    fn filtered(filter: Filter, made: FloatTensor<Self>, pyramid: FloatTensor<Self>) -> FloatTensor<Self>;
}

/// As `kernels::convolve`.
pub fn convolve(x: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>, pooled: bool, leak: f32) -> Tensor<4> {
    let x = if pooled { plain::pooled(x) } else { x };
    let (weight, bias) = (weight.into_dispatch(), bias.into_dispatch());
    Tensor::from_dispatch(<Dispatch as NetOps>::convolve(x.into_dispatch(), weight, bias, leak))
}

/// As `kernels::convolve_joined`.
pub fn convolve_joined(
    [coarse, fine]: [Tensor<4>; 2],
    weight: Tensor<4>,
    bias: Tensor<1>,
    join_groups: usize,
    leak: f32,
) -> Tensor<4> {
    let joined = <Dispatch as NetOps>::join(coarse.into_dispatch(), fine.into_dispatch(), join_groups);
    convolve(Tensor::from_dispatch(joined), weight, bias, false, leak)
}

/// As `kernels::filtered`.
pub fn filtered(filter: Filter, made: Tensor<4>, light: Tensor<4>) -> Tensor<4> {
    let (made, pyramid) = (made.into_dispatch(), pyramid(filter, light).into_dispatch());
    Tensor::from_dispatch(<Dispatch as NetOps>::filtered(filter, made, pyramid))
}

/// The light and its means over ever larger squares, `[batch, channels, pixels of all levels]`.
fn pyramid(filter: Filter, light: Tensor<4>) -> Tensor<3> {
    let mut levels = vec![light];
    for _ in 1..filter.levels {
        levels.extend(levels.last().cloned().map(plain::pooled));
    }
    Tensor::cat(levels.into_iter().map(|level| level.flatten(2, 3)).collect(), 2)
}

impl NetOps for Cube {
    fn convolve(x: Gpu, weight: Gpu, bias: Gpu, leak: f32) -> Gpu {
        convolution::convolve(&x, &weight, &bias, leak)
    }

    fn join(coarse: Gpu, fine: Gpu, groups: usize) -> Gpu {
        join::join(&coarse, &fine, groups)
    }

    fn filtered(filter: Filter, made: Gpu, pyramid: Gpu) -> Gpu {
        filter::filtered(filter, &made, &pyramid)
    }
}

impl<C: CheckpointStrategy> NetOps for Autodiff<Cube, C> {
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        leak: f32,
    ) -> FloatTensor<Self> {
        let guards = [x.node(), weight.node(), bias.node()];
        let (x, weight) = (x.into_primitive(), weight.into_primitive());
        let y = convolution::convolve(&x, &weight, &bias.into_primitive(), leak);
        match Convolve.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish(Convolved { x, weight, y: y.clone(), leak }, y),
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }

    fn join(coarse: FloatTensor<Self>, fine: FloatTensor<Self>, groups: usize) -> FloatTensor<Self> {
        let guards = [coarse.node(), fine.node()];
        let (coarse, fine) = (coarse.into_primitive(), fine.into_primitive());
        let joined = join::join(&coarse, &fine, groups);
        match Join.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish((coarse, fine, groups), joined),
            OpsKind::UnTracked(prep) => prep.finish(joined),
        }
    }

    fn filtered(filter: Filter, made: FloatTensor<Self>, pyramid: FloatTensor<Self>) -> FloatTensor<Self> {
        let guards = [made.node()];
        let (made, pyramid) = (made.into_primitive(), pyramid.into_primitive());
        let image = filter::filtered(filter, &made, &pyramid);
        match Filtered.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish((filter, made, pyramid), image),
            OpsKind::UnTracked(prep) => prep.finish(image),
        }
    }
}

/// What a convolution read, and what it made.
#[derive(Clone, Debug)]
struct Convolved {
    x: Gpu,
    weight: Gpu,
    y: Gpu,
    leak: f32,
}

/// The backward step of a convolution.
#[derive(Debug)]
struct Convolve;

impl Backward<Cube, 3> for Convolve {
    type State = Convolved;

    fn backward(self, ops: Ops<Convolved, 3>, grads: &mut Gradients, _: &mut Checkpointer) {
        let Convolved { x, weight, y, leak } = ops.state;
        let gradient = convolution::leaky_relu_backward(&y, &grads.consume::<Cube>(&ops.node), leak);
        let [x_node, weight_node, bias_node] = ops.parents.map(|node| Some(node?.id));
        if x_node.is_some() {
            let groups = x.shape()[1] / weight.shape()[1];
            register(grads, x_node, convolution::input_gradient(&gradient, &weight, groups));
        }
        if weight_node.is_some() || bias_node.is_some() {
            let [by_weight, by_bias] = correlation::weight_gradient(&x, &gradient, &weight);
            register(grads, weight_node, by_weight);
            register(grads, bias_node, by_bias);
        }
    }
}

/// The backward step of a concatenation.
#[derive(Debug)]
struct Join;

impl Backward<Cube, 2> for Join {
    type State = (Gpu, Gpu, usize);

    fn backward(self, ops: Ops<Self::State, 2>, grads: &mut Gradients, _: &mut Checkpointer) {
        let (coarse, fine, groups) = ops.state;
        let gradient = grads.consume::<Cube>(&ops.node);
        let [coarse_node, fine_node] = ops.parents.map(|node| Some(node?.id));
        let [by_coarse, by_fine] = join::join_backward(&gradient, &coarse, &fine, groups);
        register(grads, coarse_node, by_coarse);
        register(grads, fine_node, by_fine);
    }
}

/// The backward step of a filter.
#[derive(Debug)]
struct Filtered;

impl Backward<Cube, 1> for Filtered {
    type State = (Filter, Gpu, Gpu);

    fn backward(self, ops: Ops<Self::State, 1>, grads: &mut Gradients, _: &mut Checkpointer) {
        let (filter, made, pyramid) = ops.state;
        let gradient = grads.consume::<Cube>(&ops.node);
        let [made_node] = ops.parents.map(|node| Some(node?.id));
        register(grads, made_node, filter::filtered_backward(filter, &made, &pyramid, &gradient));
    }
}

fn register(grads: &mut Gradients, node: Option<NodeId>, gradient: Gpu) {
    if let Some(node) = node {
        grads.register::<Cube>(node, gradient);
    }
}
