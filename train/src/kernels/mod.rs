//! The network's operations on the CPU, as a backend extension of burn's `flex`.
//!
//! They replace burn's own grouped convolution, its gradients and the slices that a bilinear doubling is made of.
//! `deepshade bench train` measures training with these alone. Other backends run the same operations written with
//! tensors (`plain`), which are also what these are tested against.

mod conv;
mod resample;
mod stripe;

use burn::backend::autodiff::checkpoint::{base::Checkpointer, strategy::CheckpointStrategy};
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind, unary};
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Dispatch, Flex, TensorMetadata, backend_extension};
use burn::tensor::{Tensor, TensorData};
use conv::ConvShape;
use resample::JoinShape;

/// A tensor of the CPU backend.
type Cpu = FloatTensor<Flex>;

/// The operations that [`Flex`] has kernels for.
#[backend_extension(Flex, Autodiff)]
pub trait NetOps: Backend {
    /// Grouped convolution that keeps height and width, bias, leaky ReLU (`leak` 1 for none).
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        leak: f32,
    ) -> FloatTensor<Self>;
    /// 2x2 means.
    fn halve(x: FloatTensor<Self>) -> FloatTensor<Self>;
    /// Bilinear doubling of `coarse`, concatenated with `fine` group by group.
    fn join(coarse: FloatTensor<Self>, fine: FloatTensor<Self>, groups: usize) -> FloatTensor<Self>;
}

/// Grouped convolution with zero padding, stride 1, bias and leaky ReLU (`leak` 1 for none).
///
/// # Shapes
/// `x` `[batch, inputs, height, width]`, `weight` `[outputs, inputs / groups, kernel, kernel]`, `bias` `[outputs]`,
/// to `[batch, outputs, height, width]`.
pub fn convolve(x: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>, leak: f32) -> Tensor<4> {
    Tensor::from_dispatch(<Dispatch as NetOps>::convolve(
        x.into_dispatch(),
        weight.into_dispatch(),
        bias.into_dispatch(),
        leak,
    ))
}

/// 2x2 means: `[batch, channels, height, width]` to `[batch, channels, height / 2, width / 2]`.
pub fn halve(x: Tensor<4>) -> Tensor<4> {
    Tensor::from_dispatch(<Dispatch as NetOps>::halve(x.into_dispatch()))
}

/// Bilinear doubling of `coarse` (half-pixel centres, edges replicated), concatenated with `fine` group by group.
///
/// # Shapes
/// `[batch, a, height, width]` and `[batch, b, 2 * height, 2 * width]` to `[batch, a + b, 2 * height, 2 * width]`.
pub fn join(coarse: Tensor<4>, fine: Tensor<4>, groups: usize) -> Tensor<4> {
    Tensor::from_dispatch(<Dispatch as NetOps>::join(coarse.into_dispatch(), fine.into_dispatch(), groups))
}

impl NetOps for Flex {
    fn convolve(x: Cpu, weight: Cpu, bias: Cpu, leak: f32) -> Cpu {
        let shape = conv_shape(&x, &weight);
        let [batch, _, height, width] = dims(&x);
        let y = conv::forward(
            shape,
            numbers(&x.to_contiguous()),
            numbers(&weight.to_contiguous()),
            numbers(&bias.to_contiguous()),
            leak,
        );
        tensor(y, [batch, shape.groups * shape.outputs, height, width])
    }

    fn halve(x: Cpu) -> Cpu {
        resampled(x, |h, w| [h / 2, w / 2], resample::halve)
    }

    fn join(coarse: Cpu, fine: Cpu, groups: usize) -> Cpu {
        let (shape, joined) = join_shape(&coarse, &fine, groups);
        let (coarse, fine) = (coarse.to_contiguous(), fine.to_contiguous());
        tensor(resample::join(shape, numbers(&coarse), numbers(&fine)), joined)
    }
}

impl<C: CheckpointStrategy> NetOps for Autodiff<Flex, C> {
    fn convolve(
        x: FloatTensor<Self>,
        weight: FloatTensor<Self>,
        bias: FloatTensor<Self>,
        leak: f32,
    ) -> FloatTensor<Self> {
        let guards = [x.node(), weight.node(), bias.node()];
        let x = x.into_primitive().to_contiguous();
        let weight = weight.into_primitive().to_contiguous();
        let y = Flex::convolve(x.clone(), weight.clone(), bias.into_primitive(), leak);
        match Convolve.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish((x, weight, y.clone(), leak), y),
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }

    fn halve(x: FloatTensor<Self>) -> FloatTensor<Self> {
        let guard = x.node();
        let y = Flex::halve(x.into_primitive());
        match Halve.prepare::<C>([guard]).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish((), y),
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }

    fn join(coarse: FloatTensor<Self>, fine: FloatTensor<Self>, groups: usize) -> FloatTensor<Self> {
        let guards = [coarse.node(), fine.node()];
        let (coarse, fine) = (coarse.into_primitive(), fine.into_primitive());
        let state = (join_shape(&coarse, &fine, groups).0, dims(&coarse), dims(&fine));
        let y = Flex::join(coarse, fine, groups);
        match Join.prepare::<C>(guards).compute_bound().stateful() {
            OpsKind::Tracked(prep) => prep.finish(state, y),
            OpsKind::UnTracked(prep) => prep.finish(y),
        }
    }
}

/// The backward step of a convolution. State: input, weights, output, leak.
#[derive(Debug)]
struct Convolve;

impl Backward<Flex, 3> for Convolve {
    type State = (Cpu, Cpu, Cpu, f32);

    fn backward(self, ops: Ops<Self::State, 3>, grads: &mut Gradients, _: &mut Checkpointer) {
        let (x, weight, y, leak) = ops.state;
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        let [x_node, weight_node, bias_node] = ops.parents;
        let shape = conv_shape(&x, &weight);
        let gradients = conv::backward(
            shape,
            numbers(&x),
            numbers(&weight),
            numbers(&y),
            numbers(&dy),
            leak,
            x_node.is_some(),
        );
        if let (Some(node), Some(input)) = (x_node, gradients.input) {
            grads.register::<Flex>(node.id, tensor(input, dims::<4>(&x)));
        }
        if let Some(node) = weight_node {
            grads.register::<Flex>(node.id, tensor(gradients.weight, dims::<4>(&weight)));
        }
        if let Some(node) = bias_node {
            let length = gradients.bias.len();
            grads.register::<Flex>(node.id, tensor(gradients.bias, [length]));
        }
    }
}

/// The backward step of a pooling.
#[derive(Debug)]
struct Halve;

impl Backward<Flex, 1> for Halve {
    type State = ();

    fn backward(self, ops: Ops<(), 1>, grads: &mut Gradients, _: &mut Checkpointer) {
        unary::<Flex, _>(ops.parents, ops.node, grads, |dy| {
            resampled(dy, |h, w| [2 * h, 2 * w], |dy, h, w| resample::halve_backward(dy, 2 * h, 2 * w))
        });
    }
}

/// The backward step of a doubling with concatenation. State: sizes, shape of the coarse image, of the fine one.
#[derive(Debug)]
struct Join;

impl Backward<Flex, 2> for Join {
    type State = (JoinShape, [usize; 4], [usize; 4]);

    fn backward(self, ops: Ops<Self::State, 2>, grads: &mut Gradients, _: &mut Checkpointer) {
        let (shape, coarse, fine) = ops.state;
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        let [coarse_node, fine_node] = ops.parents;
        if let Some(node) = coarse_node {
            let gradient = resample::join_backward_coarse(shape, numbers(&dy));
            grads.register::<Flex>(node.id, tensor(gradient, coarse));
        }
        if let Some(node) = fine_node {
            let gradient = resample::join_backward_fine(shape, numbers(&dy));
            grads.register::<Flex>(node.id, tensor(gradient, fine));
        }
    }
}

/// Runs a kernel on planes: it gets the numbers, height and width.
fn resampled(
    x: Cpu,
    size: impl Fn(usize, usize) -> [usize; 2],
    kernel: impl Fn(&[f32], usize, usize) -> Vec<f32>,
) -> Cpu {
    let [batch, channels, height, width] = dims(&x);
    let [new_height, new_width] = size(height, width);
    tensor(kernel(numbers(&x.to_contiguous()), height, width), [batch, channels, new_height, new_width])
}

fn conv_shape(x: &Cpu, weight: &Cpu) -> ConvShape {
    let [batch, channels, height, width] = dims(x);
    let [outputs, inputs, kernel, _] = dims(weight);
    let groups = channels / inputs;
    ConvShape { batch, groups, inputs, outputs: outputs / groups, height, width, kernel }
}

/// The sizes of a concatenation, and the shape that it makes.
fn join_shape(coarse: &Cpu, fine: &Cpu, groups: usize) -> (JoinShape, [usize; 4]) {
    let [batch, a, height, width] = dims(coarse);
    let [_, b, fine_height, fine_width] = dims(fine);
    let shape = JoinShape { parts: batch * groups, coarse: a / groups, fine: b / groups, height, width };
    (shape, [batch, a + b, fine_height, fine_width])
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

    #[test]
    fn convolution_and_its_gradients() {
        // [batch, groups, inputs, outputs, height, width, kernel]
        let shapes = [
            [1, 1, 6, 8, 40, 70, 3],
            [2, 4, 4, 8, 17, 9, 3],
            [3, 1, 24, 1, 16, 33, 3],
            [1, 2, 3, 3, 5, 1, 5],
            [2, 8, 24, 8, 2, 2, 3],
            [1, 1, 2, 4, 1, 1, 1],
        ];
        for [batch, groups, inputs, outputs, height, width, kernel] in shapes {
            let leaves = || {
                [
                    noise([batch, groups * inputs, height, width], 1),
                    noise([groups * outputs, inputs, kernel, kernel], 2),
                    noise([groups * outputs, 1, 1, 1], 3),
                ]
            };
            for leak in [0.01, 1.0] {
                let flat = |bias: Tensor<4>| bias.reshape([groups * outputs]);
                let made = traced(leaves(), |[x, w, b]| convolve(x, w, flat(b), leak));
                let expected = traced(leaves(), |[x, w, b]| plain::convolve(x, w, flat(b), leak));
                for (what, (made, expected)) in ["y", "dx", "dw", "db"].iter().zip(made.iter().zip(&expected))
                {
                    assert_close(
                        &format!("{what} of {:?}", [groups, inputs, outputs, height, width]),
                        made,
                        expected,
                    );
                }
            }
        }
    }

    #[test]
    fn pooling_and_its_gradient() {
        for (height, width) in [(2, 2), (6, 14), (16, 4)] {
            let leaf = || [noise([2, 3, height, width], 1)];
            let expected = traced(leaf(), |[x]| plain::halve(x));
            for (made, expected) in traced(leaf(), |[x]| halve(x)).iter().zip(&expected) {
                assert_close("halve", made, expected);
            }
        }
    }

    #[test]
    fn doubling_with_concatenation_and_its_gradients() {
        for (height, width) in [(1, 1), (1, 5), (2, 2), (3, 4), (9, 6)] {
            for groups in [1, 2] {
                let leaves = || [noise([2, 4, height, width], 1), noise([2, 6, 2 * height, 2 * width], 2)];
                let made = traced(leaves(), |[coarse, fine]| join(coarse, fine, groups));
                let expected = traced(leaves(), |[coarse, fine]| plain::join(coarse, fine, groups));
                for (what, (made, expected)) in ["y", "coarse", "fine"].iter().zip(made.iter().zip(&expected))
                {
                    assert_close(&format!("{what} of {height}x{width} in {groups}"), made, expected);
                }
            }
        }
    }

    #[test]
    fn an_input_without_gradient_costs_none() {
        let (x, bias) = (noise([1, 2, 8, 8], 1), noise([4], 3));
        let gradients = |convolve: fn(Tensor<4>, Tensor<4>, Tensor<1>, f32) -> Tensor<4>| {
            let weight = noise([4, 2, 3, 3], 2).require_grad();
            let made = convolve(x.clone(), weight.clone(), bias.clone(), 0.1);
            let grads = (made.clone() * noise(made.dims(), 99)).sum().backward();
            (x.grad(&grads), weight.grad(&grads).expect("a gradient"))
        };
        let ((none, made), (_, expected)) = (gradients(convolve), gradients(plain::convolve));
        assert!(none.is_none());
        assert_close("dw", &made, &expected);
        let shape = ConvShape { batch: 1, groups: 1, inputs: 2, outputs: 4, height: 8, width: 8, kernel: 3 };
        let numbers = |count: usize| vec![0.5; count];
        let [image, weight, outputs] = [2 * 64, 4 * 2 * 9, 4 * 64].map(numbers);
        let costs = |wants_input: bool| {
            conv::backward(shape, &image, &weight, &outputs, &outputs, 0.1, wants_input).input.is_some()
        };
        assert!(costs(true) && !costs(false));
    }
}
