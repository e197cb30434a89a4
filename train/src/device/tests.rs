//! Every operation of the device against the same written with tensors, on burn's `flex`: outputs and all
//! gradients.

use super::ops::{convolve, convolve_joined, filtered};
use crate::plain;
use crate::rng::{Purpose, Rng};
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_infer::Filter;

/// What is measured.
fn device() -> Device {
    crate::device().autodiff()
}

/// What it is held against.
fn flex() -> Device {
    Device::flex().autodiff()
}

type Convolve = fn(Tensor<4>, Tensor<4>, Tensor<1>, bool, f32) -> Tensor<4>;

fn moved<const D: usize>(tensor: &Tensor<D>, device: &Device) -> Tensor<D> {
    Tensor::from_data(tensor.to_data(), device)
}

fn noise<const D: usize>(shape: [usize; D], seed: u64) -> Tensor<D> {
    let mut rng = Rng::new(seed, Purpose::Crop, 0);
    let data = (0..shape.iter().product()).map(|_| rng.normal() as f32).collect::<Vec<_>>();
    Tensor::from_data(TensorData::new(data, shape), &flex())
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

/// Output and gradients of a sum over the output that depends on every element differently (a gradient begins
/// with ones).
fn traced<const N: usize>(
    device: &Device,
    leaves: [Tensor<4>; N],
    make: impl Fn([Tensor<4>; N]) -> Tensor<4>,
) -> Vec<Tensor<4>> {
    let leaves = leaves.map(|leaf| moved(&leaf, device).require_grad());
    let made = make(leaves.clone());
    let grads = (made.clone() * moved(&noise(made.dims(), 99), device)).backward();
    let gradients = leaves.iter().map(|leaf| leaf.grad(&grads).expect("a gradient"));
    std::iter::once(made.inner()).chain(gradients).collect()
}

/// `[batch, groups, inputs, outputs, height, width, kernel]`.
const SHAPES: [[usize; 7]; 10] = [
    [1, 1, 6, 8, 40, 70, 3],
    [2, 4, 4, 8, 17, 9, 3],
    [3, 1, 24, 1, 16, 33, 3],
    [1, 2, 3, 3, 5, 1, 5],
    [2, 8, 24, 8, 2, 2, 3],
    [1, 1, 2, 4, 1, 1, 1],
    [1, 3, 10, 1, 9, 20, 1],
    [1, 1, 48, 3, 70, 18, 5],
    [2, 2, 8, 16, 34, 50, 3],
    [1, 2, 3, 2, 9, 12, 7],
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
                    noise([batch, groups * inputs, scale * width, scale * height], 1),
                    noise([groups * outputs, inputs, kernel, kernel], 2),
                    noise([groups * outputs, 1, 1, 1], 3),
                ]
            };
            let made = traced(&device(), leaves(), |[x, w, b]| convolve(x, w, flat(b), pooled, leak));
            let expected =
                traced(&flex(), leaves(), |[x, w, b]| plain::convolve(x, w, flat(b), pooled, leak));
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
            let made = traced(&device(), leaves(), |[coarse, fine, w, b]| {
                convolve_joined([coarse, fine], w, flat(b), join_groups, 0.01)
            });
            let expected = traced(&flex(), leaves(), |[coarse, fine, w, b]| {
                plain::convolve_joined([coarse, fine], w, flat(b), join_groups, 0.01)
            });
            assert_all_close(shape, "the convolution", &made, &expected);
        }
    }
}

#[cfg(feature = "vulkan")]
#[test]
fn gradients_of_more_numbers_than_a_gpu_starts_cubes_for_along_an_axis() {
    let x = || [noise([2, 1, 1000, 1000], 1)];
    let made = |device: &Device, convolve: Convolve| {
        let (weight, bias) = (moved(&noise([9, 1, 1, 1], 2), device), moved(&noise([9], 3), device));
        traced(device, x(), |[x]| convolve(x, weight.clone(), bias.clone(), false, 0.1))
    };
    assert_all_close(
        [2, 1, 1, 9, 1000, 1000, 1],
        "the convolution",
        &made(&device(), convolve),
        &made(&flex(), plain::convolve),
    );
}

#[test]
fn the_filter_and_its_gradient() {
    for (levels, kernel, channels, black, [height, width]) in [
        (1, 5, 3, false, [7, 9]),
        (5, 1, 1, true, [32, 16]),
        (3, 3, 3, true, [8, 20]),
        (5, 3, 3, false, [48, 80]),
    ] {
        let filter = Filter { levels, kernel, black };
        let light = noise([2, channels, height, width], 2);
        let of = |device: &Device, filtered: fn(Filter, Tensor<4>, Tensor<4>) -> Tensor<4>| {
            let made = noise([2, filter.weight_count(), height, width], 1);
            traced(device, [made], |[made]| filtered(filter, made, moved(&light, device)))
        };
        let shape = [2, channels, filter.weight_count(), levels, height, width, kernel];
        assert_all_close(
            shape,
            "the filter's image",
            &of(&device(), filtered),
            &of(&flex(), plain::filtered),
        );
    }
}

/// The gradient by an input, taken from differences of the output in double precision.
fn difference(of: impl Fn(Tensor<4>) -> Tensor<4>, x: &Tensor<4>, at: usize) -> f64 {
    const STEP: f32 = 0.01;
    let shifted = |step: f32| {
        let mut numbers = x.to_data().try_into_vec::<f32>().expect("f32");
        numbers[at] += step;
        let made = of(Tensor::from_data(TensorData::new(numbers, x.dims()), &device()));
        let shape = made.dims();
        let weights = noise(shape, 99).to_data().try_into_vec::<f32>().expect("f32");
        let made = made.to_data().try_into_vec::<f32>().expect("f32");
        made.iter().zip(&weights).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum::<f64>()
    };
    (shifted(STEP) - shifted(-STEP)) / f64::from(2.0 * STEP)
}

/// Holds the gradients of an operation of some leaves against differences of its output.
fn assert_differences<const N: usize>(
    what: &str,
    leaves: [Tensor<4>; N],
    make: impl Fn([Tensor<4>; N]) -> Tensor<4>,
) {
    let gradients = traced(&device(), leaves.clone(), &make);
    for index in 0..N {
        let gradient = gradients[index + 1].to_data().try_into_vec::<f32>().expect("f32");
        for at in (0..gradient.len()).step_by(7) {
            let of_moved = |leaf: Tensor<4>| {
                let mut leaves = leaves.clone().map(|leaf| moved(&leaf, &device()));
                leaves[index] = leaf;
                make(leaves)
            };
            let expected = difference(of_moved, &leaves[index], at);
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
    // Differences are exact but for rounding where no sum changes its sign: without a leak the operation is
    // linear, and a bias beyond all sums keeps them on one side of the leaky ReLU.
    let flat = |bias: Tensor<4>| bias.reshape([4]);
    for (leak, offset) in [(1.0, 0.0), (0.1, 30.0), (0.1, -30.0)] {
        let bias = noise([4, 1, 1, 1], 4) + offset;
        let joined = [noise([1, 4, 3, 5], 1), noise([1, 2, 6, 10], 2), noise([4, 3, 3, 3], 3), bias.clone()];
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
fn an_input_without_gradient_gets_none() {
    let gradients = |device: &Device, convolve: Convolve| {
        let (x, bias) = (moved(&noise([1, 2, 8, 8], 1), device), moved(&noise([4], 3), device));
        let weight = moved(&noise([4, 2, 3, 3], 2), device).require_grad();
        let made = convolve(x.clone(), weight.clone(), bias, false, 0.1);
        let grads = (made.clone() * moved(&noise(made.dims(), 99), device)).backward();
        (x.grad(&grads), weight.grad(&grads).expect("a gradient"))
    };
    let ((none, made), (_, expected)) = (gradients(&device(), convolve), gradients(&flex(), plain::convolve));
    assert!(none.is_none());
    assert_close("dw", &made, &expected);
}
