//! The network's steps on the CPU, as a backend extension of burn's `flex`: what comes before a convolution
//! (pooling, doubling, concatenation), the convolution, bias and leaky ReLU as one operation with one
//! gradient, and the filter by predicted kernels as another.
//!
//! Forwards they are the kernels that also run networks ([`deepshade_infer::cpu`]). `deepshade bench train`
//! measures training with these alone. GPUs have theirs in `gpu`; both are tested against the same operations
//! written with tensors (`plain`).

mod backward;
mod correlate;
mod filter;

use backward::Made;
use burn::backend::autodiff::NodeId;
use burn::backend::autodiff::checkpoint::{base::Checkpointer, strategy::CheckpointStrategy};
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind};
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Dispatch, Flex, TensorMetadata, backend_extension};
use burn::tensor::{Tensor, TensorData};
use deepshade_infer::Filter;
use deepshade_infer::cpu::conv;
use deepshade_infer::cpu::operand::{Image, Operand};
use deepshade_infer::cpu::shape::ConvShape;
use deepshade_infer::cpu::stripe::Packed;
use deepshade_infer::spec::joined_order;
use std::borrow::Cow;

/// A tensor of the CPU backend.
type Cpu = FloatTensor<Flex>;

/// The operations that [`Flex`] has kernels for.
#[backend_extension(Flex, Autodiff)]
pub trait NetOps: Backend {
    /// [`convolve`].
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        pooled: bool,
        leak: f32,
    ) -> FloatTensor<Self>;
    /// [`convolve_joined`].
    fn convolve_joined(
        coarse: FloatTensor<Self>,
        fine: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        join_groups: usize,
        leak: f32,
    ) -> FloatTensor<Self>;
    /// [`filtered`].
    fn filtered(filter: Filter, made: FloatTensor<Self>, light: FloatTensor<Self>) -> FloatTensor<Self>;
}

/// Grouped convolution with zero padding, stride 1, bias and leaky ReLU (`leak` 1 for none), of an image or
/// of its 2x2 means.
///
/// # Shapes
/// `x` `[batch, inputs, height, width]`, twice as high and wide if it is to be `pooled`, `weight`
/// `[outputs, inputs / groups, kernel, kernel]`, `bias` `[outputs]`, to `[batch, outputs, height, width]`.
pub fn convolve(x: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>, pooled: bool, leak: f32) -> Tensor<4> {
    let (weight, bias) = (weight.into_dispatch(), bias.into_dispatch());
    Tensor::from_dispatch(<Dispatch as NetOps>::convolve(x.into_dispatch(), weight, bias, pooled, leak))
}

/// As [`convolve`], of `coarse`, doubled bilinearly (half-pixel centres, edges replicated), concatenated with
/// `fine` in so many groups.
///
/// # Shapes
/// `[batch, a, height / 2, width / 2]` and `[batch, b, height, width]` to `[batch, outputs, height, width]`.
pub fn convolve_joined(
    [coarse, fine]: [Tensor<4>; 2],
    weight: Tensor<4>,
    bias: Tensor<1>,
    join_groups: usize,
    leak: f32,
) -> Tensor<4> {
    let (coarse, fine) = (coarse.into_dispatch(), fine.into_dispatch());
    let (weight, bias) = (weight.into_dispatch(), bias.into_dispatch());
    let made = <Dispatch as NetOps>::convolve_joined(coarse, fine, weight, bias, join_groups, leak);
    Tensor::from_dispatch(made)
}

/// The image of a [`deepshade_infer::filter`], which has a gradient by `made` alone.
///
/// # Shapes
/// `made` `[batch, weights, height, width]` and `light` `[batch, channels, height, width]`, height and width
/// multiples of the coarsest level's scale, to `[batch, channels, height, width]`.
pub fn filtered(filter: Filter, made: Tensor<4>, light: Tensor<4>) -> Tensor<4> {
    let (made, light) = (made.into_dispatch(), light.into_dispatch());
    Tensor::from_dispatch(<Dispatch as NetOps>::filtered(filter, made, light))
}

impl NetOps for Flex {
    fn convolve(x: Cpu, weight: Cpu, bias: Cpu, pooled: bool, leak: f32) -> Cpu {
        let x = x.to_contiguous();
        forward(&single(&x, pooled), &weight, &bias, leak)
    }

    fn convolve_joined(coarse: Cpu, fine: Cpu, weight: Cpu, bias: Cpu, join_groups: usize, leak: f32) -> Cpu {
        let (coarse, fine) = (coarse.to_contiguous(), fine.to_contiguous());
        forward(&joined(&coarse, &fine, join_groups), &weight, &bias, leak)
    }

    fn filtered(filter: Filter, made: Cpu, light: Cpu) -> Cpu {
        filter::FilterState::new(filter, made.to_contiguous(), &light.to_contiguous()).image()
    }
}

impl<C: CheckpointStrategy> NetOps for Autodiff<Flex, C> {
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        pooled: bool,
        leak: f32,
    ) -> FloatTensor<Self> {
        let guards = [x.node(), weight.node(), bias.node()];
        let x = x.into_primitive().to_contiguous();
        let weight = weight.into_primitive().to_contiguous();
        let y = Flex::convolve(x.clone(), weight.clone(), bias.into_primitive(), pooled, leak);
        match Convolve.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => {
                prep.finish((x, pooled, ConvolutionState { weight, y: y.clone(), leak }), y)
            }
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }

    fn convolve_joined(
        coarse: FloatTensor<Self>,
        fine: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        join_groups: usize,
        leak: f32,
    ) -> FloatTensor<Self> {
        let guards = [coarse.node(), fine.node(), weight.node(), bias.node()];
        let images = [coarse, fine].map(|image| image.into_primitive().to_contiguous());
        let weight = weight.into_primitive().to_contiguous();
        let [coarse, fine] = images.clone();
        let y = Flex::convolve_joined(coarse, fine, weight.clone(), bias.into_primitive(), join_groups, leak);
        match ConvolveJoined.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => {
                prep.finish((images, join_groups, ConvolutionState { weight, y: y.clone(), leak }), y)
            }
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }

    fn filtered(filter: Filter, made: FloatTensor<Self>, light: FloatTensor<Self>) -> FloatTensor<Self> {
        let guards = [made.node()];
        let made = made.into_primitive().to_contiguous();
        let run = filter::FilterState::new(filter, made, &light.into_primitive().to_contiguous());
        let y = run.image();
        match filter::Filtered.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish(run, y),
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }
}

/// What a convolution was run with, and what it made.
#[derive(Clone, Debug)]
struct ConvolutionState {
    weight: Cpu,
    y: Cpu,
    leak: f32,
}

/// The backward step of a convolution of one image.
#[derive(Debug)]
struct Convolve;

impl Backward<Flex, 3> for Convolve {
    type State = (Cpu, bool, ConvolutionState);

    fn backward(self, ops: Ops<Self::State, 3>, grads: &mut Gradients, _: &mut Checkpointer) {
        let (x, pooled, run) = ops.state;
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        let [x_node, weight_node, bias_node] = ops.parents.map(|node| Some(node?.id));
        let made = backward(&single(&x, pooled), &run, &dy, x_node.is_some());
        register(grads, [(x_node, &x)], made.operand);
        register(grads, [(weight_node, &run.weight)], vec![made.weight]);
        register_bias(grads, bias_node, made.bias);
    }
}

/// The backward step of a convolution of two images.
#[derive(Debug)]
struct ConvolveJoined;

impl Backward<Flex, 4> for ConvolveJoined {
    type State = ([Cpu; 2], usize, ConvolutionState);

    fn backward(self, ops: Ops<Self::State, 4>, grads: &mut Gradients, _: &mut Checkpointer) {
        let ([coarse, fine], join_groups, run) = ops.state;
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        let [coarse_node, fine_node, weight_node, bias_node] = ops.parents.map(|node| Some(node?.id));
        let wants_images = coarse_node.is_some() || fine_node.is_some();
        let made = backward(&joined(&coarse, &fine, join_groups), &run, &dy, wants_images);
        register(grads, [(coarse_node, &coarse), (fine_node, &fine)], made.operand);
        register(grads, [(weight_node, &run.weight)], vec![made.weight]);
        register_bias(grads, bias_node, made.bias);
    }
}

fn register<const N: usize>(grads: &mut Gradients, of: [(Option<NodeId>, &Cpu); N], made: Vec<Vec<f32>>) {
    for ((node, like), gradient) in of.into_iter().zip(made) {
        if let Some(node) = node {
            grads.register::<Flex>(node, tensor(gradient, dims::<4>(like)));
        }
    }
}

fn register_bias(grads: &mut Gradients, node: Option<NodeId>, gradient: Vec<f32>) {
    if let Some(node) = node {
        let length = gradient.len();
        grads.register::<Flex>(node, tensor(gradient, [length]));
    }
}

fn forward(operand: &Operand<'_>, weight: &Cpu, bias: &Cpu, leak: f32) -> Cpu {
    let weight = weight.to_contiguous();
    let shape = shape(operand, &weight);
    let packed = Packed::new(shape, numbers(&weight));
    let mut y = vec![0.0; shape.made()];
    conv::forward(shape, operand, &packed, numbers(&bias.to_contiguous()), leak, &mut y);
    tensor(y, [shape.batch, shape.groups * shape.outputs, shape.height, shape.width])
}

fn backward(
    operand: &Operand<'_>,
    run: &ConvolutionState,
    dy: &Cpu,
    wants_operand: bool,
) -> backward::Gradients {
    let ConvolutionState { weight, y, leak } = run;
    let made = Made { weight: numbers(weight), y: numbers(y), dy: numbers(dy), leak: *leak };
    backward::backward(shape(operand, weight), operand, made, wants_operand)
}

fn single(x: &Cpu, pooled: bool) -> Operand<'_> {
    if pooled { Operand::Pooled(image(x)) } else { Operand::Plain(image(x)) }
}

fn joined<'a>(coarse: &'a Cpu, fine: &'a Cpu, groups: usize) -> Operand<'a> {
    let (coarse, fine) = (image(coarse), image(fine));
    let order = Cow::Owned(joined_order(coarse.channels, fine.channels, groups));
    Operand::Joined { coarse, fine, order }
}

fn image(x: &Cpu) -> Image<'_> {
    let [_, channels, height, width] = dims(x);
    Image { data: numbers(x), channels, height, width }
}

/// The sizes of a convolution of an operand by weights `[outputs, inputs / groups, kernel, kernel]`.
fn shape(operand: &Operand<'_>, weight: &Cpu) -> ConvShape {
    let [outputs, inputs, kernel, _] = dims(weight);
    let (of, channels, [height, width]) = match operand {
        Operand::Plain(x) => (x, x.channels, [x.height, x.width]),
        Operand::Folded(x) => (x, 4 * x.channels, [x.height / 2, x.width / 2]),
        Operand::Pooled(x) => (x, x.channels, [x.height / 2, x.width / 2]),
        Operand::Joined { fine, order, .. } => (fine, order.len(), [fine.height, fine.width]),
    };
    let batch = of.data.len() / (of.channels * of.height * of.width);
    let groups = channels / inputs;
    ConvShape { batch, groups, inputs, outputs: outputs / groups, height, width, kernel }
}

fn dims<const D: usize>(tensor: &Cpu) -> [usize; D] {
    tensor.shape().dims()
}

fn numbers(tensor: &Cpu) -> &[f32] {
    tensor.as_slice().expect("contiguous f32")
}

fn tensor<const D: usize>(numbers: Vec<f32>, shape: [usize; D]) -> Cpu {
    Cpu::from_data(TensorData::new(numbers, shape))
}
