//! The network's steps on the CPU, as a backend extension of burn's `flex`: what comes before a convolution (pooling,
//! doubling, concatenation), the convolution, bias and leaky ReLU as one operation with one gradient.
//!
//! Forwards they are the kernels that also run networks ([`deepshade_infer::cpu`]). `deepshade bench train` measures
//! training with these alone. Other backends run the same operations written with tensors (`plain`), which are also
//! what these are tested against.

mod backward;
mod correlate;

use backward::Made;
use burn::backend::autodiff::NodeId;
use burn::backend::autodiff::checkpoint::{base::Checkpointer, strategy::CheckpointStrategy};
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind};
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Dispatch, Flex, TensorMetadata, backend_extension};
use burn::tensor::{Tensor, TensorData};
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
}

/// Grouped convolution with zero padding, stride 1, bias and leaky ReLU (`leak` 1 for none), of an image or of its
/// 2x2 means.
///
/// # Shapes
/// `x` `[batch, inputs, height, width]`, twice as high and wide if it is to be `pooled`, `weight` `[outputs, inputs /
/// groups, kernel, kernel]`, `bias` `[outputs]`, to `[batch, outputs, height, width]`.
pub fn convolve(x: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>, pooled: bool, leak: f32) -> Tensor<4> {
    let (weight, bias) = (weight.into_dispatch(), bias.into_dispatch());
    Tensor::from_dispatch(<Dispatch as NetOps>::convolve(x.into_dispatch(), weight, bias, pooled, leak))
}

/// As [`convolve`], of `coarse`, doubled bilinearly (half-pixel centres, edges replicated), concatenated with `fine` in
/// so many groups.
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

impl NetOps for Flex {
    fn convolve(x: Cpu, weight: Cpu, bias: Cpu, pooled: bool, leak: f32) -> Cpu {
        let x = x.to_contiguous();
        forward(&single(&x, pooled), &weight, &bias, leak)
    }

    fn convolve_joined(coarse: Cpu, fine: Cpu, weight: Cpu, bias: Cpu, join_groups: usize, leak: f32) -> Cpu {
        let (coarse, fine) = (coarse.to_contiguous(), fine.to_contiguous());
        forward(&joined(&coarse, &fine, join_groups), &weight, &bias, leak)
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
            OpsKind::Tracked(prep) => prep.finish((x, pooled, Run { weight, y: y.clone(), leak }), y),
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
                prep.finish((images, join_groups, Run { weight, y: y.clone(), leak }), y)
            }
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }
}

/// What a convolution was run with, and what it made.
#[derive(Clone, Debug)]
struct Run {
    weight: Cpu,
    y: Cpu,
    leak: f32,
}

/// The backward step of a convolution of one image.
#[derive(Debug)]
struct Convolve;

impl Backward<Flex, 3> for Convolve {
    type State = (Cpu, bool, Run);

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
    type State = ([Cpu; 2], usize, Run);

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

fn backward(operand: &Operand<'_>, run: &Run, dy: &Cpu, wants_operand: bool) -> backward::Gradients {
    let Run { weight, y, leak } = run;
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

#[cfg(test)]
mod tests {
    //! Every kernel against the same operation written with tensors: outputs and all gradients.

    use super::*;
    use crate::plain;
    use crate::rng::{Purpose, Rng};
    use burn::tensor::Device;

    fn device() -> Device {
        Device::flex().autodiff()
    }

    fn noise<const D: usize>(shape: [usize; D], seed: u64) -> Tensor<D> {
        let mut rng = Rng::new(seed, Purpose::Crop, 0);
        let data = (0..shape.iter().product()).map(|_| rng.normal() as f32).collect::<Vec<_>>();
        Tensor::from_data(TensorData::new(data, shape), &device())
    }

    fn assert_close<const D: usize>(what: &str, made: &Tensor<D>, expected: &Tensor<D>) {
        assert_eq!(made.dims(), expected.dims(), "{what}");
        let numbers = |t: &Tensor<D>| t.to_data().try_into_vec::<f32>().expect("f32");
        let (made, expected) = (numbers(made), numbers(expected));
        let largest = expected.iter().fold(1.0f32, |largest, e| largest.max(e.abs()));
        for (at, (made, expected)) in made.iter().zip(&expected).enumerate() {
            assert!((made - expected).abs() < 1e-5 * largest, "{what}[{at}]: {made} is not {expected}");
        }
    }

    /// Output and gradients of a scalar that depends on every element of the output differently.
    fn traced<const N: usize>(
        leaves: [Tensor<4>; N],
        make: impl Fn([Tensor<4>; N]) -> Tensor<4>,
    ) -> Vec<Tensor<4>> {
        let leaves = leaves.map(|leaf| leaf.require_grad());
        let made = make(leaves.clone());
        let grads = (made.clone() * noise(made.dims(), 99)).sum().backward();
        let gradients = leaves.iter().map(|leaf| leaf.grad(&grads).expect("a gradient"));
        std::iter::once(made.inner()).chain(gradients).collect()
    }

    /// `[batch, groups, inputs, outputs, height, width, kernel]`.
    const SHAPES: [[usize; 7]; 9] = [
        [1, 1, 6, 8, 40, 70, 3],
        [2, 4, 4, 8, 17, 9, 3],
        [3, 1, 24, 1, 16, 33, 3],
        [1, 2, 3, 3, 5, 1, 5],
        [2, 8, 24, 8, 2, 2, 3],
        [1, 1, 2, 4, 1, 1, 1],
        [1, 3, 10, 1, 9, 20, 1],
        [1, 1, 48, 3, 70, 18, 5],
        [2, 2, 8, 16, 34, 50, 3],
    ];

    fn assert_all_close(shape: [usize; 7], what: &str, made: &[Tensor<4>], expected: &[Tensor<4>]) {
        let names =
            [what, "its first gradient", "its second gradient", "its third gradient", "its fourth gradient"];
        assert_eq!(made.len(), expected.len());
        for (name, (made, expected)) in names.iter().zip(made.iter().zip(expected)) {
            assert_close(&format!("{name} of {shape:?}"), made, expected);
        }
    }

    #[test]
    fn convolution_with_pooling_and_its_gradients() {
        for shape in SHAPES {
            let [batch, groups, inputs, outputs, height, width, kernel] = shape;
            let flat = |bias: Tensor<4>| bias.reshape([groups * outputs]);
            for (pooled, scale, leak) in [(false, 1, 0.01), (true, 2, 0.01), (false, 1, 1.0)] {
                let leaves = || {
                    [
                        noise([batch, groups * inputs, scale * height, scale * width], 1),
                        noise([groups * outputs, inputs, kernel, kernel], 2),
                        noise([groups * outputs, 1, 1, 1], 3),
                    ]
                };
                let made = traced(leaves(), |[x, w, b]| convolve(x, w, flat(b), pooled, leak));
                let expected = traced(leaves(), |[x, w, b]| plain::convolve(x, w, flat(b), pooled, leak));
                assert_all_close(shape, "the convolution", &made, &expected);
            }
        }
    }

    #[test]
    fn convolution_with_doubling_and_concatenation_and_its_gradients() {
        for shape in SHAPES {
            let [batch, groups, inputs, outputs, height, width, kernel] = shape;
            let coarse = (2 * inputs / 3).max(1);
            if coarse == inputs {
                continue;
            }
            let flat = |bias: Tensor<4>| bias.reshape([groups * outputs]);
            let leaves = || {
                [
                    noise([batch, groups * coarse, height, width], 1),
                    noise([batch, groups * (inputs - coarse), 2 * height, 2 * width], 2),
                    noise([groups * outputs, inputs, kernel, kernel], 3),
                    noise([groups * outputs, 1, 1, 1], 4),
                ]
            };
            for join_groups in [1, groups] {
                let made = traced(leaves(), |[coarse, fine, w, b]| {
                    convolve_joined([coarse, fine], w, flat(b), join_groups, 0.01)
                });
                let expected = traced(leaves(), |[coarse, fine, w, b]| {
                    plain::convolve_joined([coarse, fine], w, flat(b), join_groups, 0.01)
                });
                assert_all_close(shape, "the convolution", &made, &expected);
            }
        }
    }

    /// The gradient by an input, taken from differences of the output in double precision.
    fn difference(of: impl Fn(Tensor<4>) -> Tensor<4>, x: &Tensor<4>, at: usize) -> f64 {
        const STEP: f32 = 0.01;
        let moved = |step: f32| {
            let mut numbers = x.to_data().try_into_vec::<f32>().expect("f32");
            numbers[at] += step;
            let made = of(Tensor::from_data(TensorData::new(numbers, x.dims()), &device()));
            let shape = made.dims();
            let weights = noise(shape, 99).to_data().try_into_vec::<f32>().expect("f32");
            let made = made.to_data().try_into_vec::<f32>().expect("f32");
            made.iter().zip(&weights).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum::<f64>()
        };
        (moved(STEP) - moved(-STEP)) / f64::from(2.0 * STEP)
    }

    /// Holds the gradients of an operation of some leaves against differences of its output.
    fn assert_differences<const N: usize>(
        what: &str,
        leaves: [Tensor<4>; N],
        make: impl Fn([Tensor<4>; N]) -> Tensor<4>,
    ) {
        let gradients = traced(leaves.clone(), &make);
        for index in 0..N {
            let gradient = gradients[index + 1].to_data().try_into_vec::<f32>().expect("f32");
            for at in (0..gradient.len()).step_by(7) {
                let moved = |moved: Tensor<4>| {
                    let mut leaves = leaves.clone();
                    leaves[index] = moved;
                    make(leaves)
                };
                let expected = difference(moved, &leaves[index], at);
                let error = (f64::from(gradient[at]) - expected).abs();
                let allowed = 1e-3 * expected.abs().max(1.0);
                assert!(
                    error < allowed,
                    "{what}: leaf {index}, element {at}: {} is not {expected}",
                    gradient[at]
                );
            }
        }
    }

    #[test]
    fn gradients_are_those_of_finite_differences() {
        // Differences are exact but for rounding where no sum changes its sign: without a leak the operation is linear,
        // and a bias beyond all sums keeps them on one side of the leaky ReLU.
        let flat = |bias: Tensor<4>| bias.reshape([4]);
        for (leak, offset) in [(1.0, 0.0), (0.1, 30.0), (0.1, -30.0)] {
            let bias = noise([4, 1, 1, 1], 4) + offset;
            let joined =
                [noise([1, 4, 3, 5], 1), noise([1, 2, 6, 10], 2), noise([4, 3, 3, 3], 3), bias.clone()];
            assert_differences("joined", joined, |[coarse, fine, weight, bias]| {
                convolve_joined([coarse, fine], weight, flat(bias), 2, leak)
            });
            for pooled in [false, true] {
                let single = [noise([1, 6, 6, 10], 1), noise([4, 3, 3, 3], 3), bias.clone()];
                assert_differences("single", single, |[x, weight, bias]| {
                    convolve(x, weight, flat(bias), pooled, leak)
                });
            }
        }
    }

    #[test]
    fn an_input_without_gradient_costs_none() {
        let (x, bias) = (noise([1, 2, 8, 8], 1), noise([4], 3));
        let gradients = |convolve: fn(Tensor<4>, Tensor<4>, Tensor<1>, bool, f32) -> Tensor<4>| {
            let weight = noise([4, 2, 3, 3], 2).require_grad();
            let made = convolve(x.clone(), weight.clone(), bias.clone(), false, 0.1);
            let grads = (made.clone() * noise(made.dims(), 99)).sum().backward();
            (x.grad(&grads), weight.grad(&grads).expect("a gradient"))
        };
        let ((none, made), (_, expected)) = (gradients(convolve), gradients(plain::convolve));
        assert!(none.is_none());
        assert_close("dw", &made, &expected);
        let (image, weight) = (noise([1, 2, 8, 8], 1), noise([4, 2, 3, 3], 2));
        let [image, weight] =
            [image, weight].map(|tensor| tensor.to_data().try_into_vec::<f32>().expect("f32"));
        let shape = ConvShape { batch: 1, groups: 1, inputs: 2, outputs: 4, height: 8, width: 8, kernel: 3 };
        let operand = Operand::Plain(Image { data: &image, channels: 2, height: 8, width: 8 });
        let made = vec![0.5; 4 * 64];
        let made = Made { weight: &weight, y: &made, dy: &made, leak: 0.1 };
        let images = |wants: bool| backward::backward(shape, &operand, made, wants).operand.len();
        assert_eq!([images(true), images(false)], [1, 0]);
    }
}
