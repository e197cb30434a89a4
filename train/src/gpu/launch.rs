//! Starts the kernels: shapes, sizes of the work, room for what is made.

use super::Gpu;
use super::convolution::{self, Shape};
use super::filter::{self, Form};
use super::join::{self, Shares};
use burn::backend::TensorMetadata;
use burn_cubecl::kernel::into_contiguous;
use burn_cubecl::ops::numeric::{empty_device_contiguous_dtype, zeros_client};
use cubecl::prelude::*;
use deepshade_infer::Filter;

/// Most units of a cube.
const UNITS: usize = 256;
/// Most outputs that a unit makes: their sums stay in registers, ...
const MOST_OUTPUTS: usize = 24;
/// ... as do so many sums for weights.
const MOST_SUMS: usize = 72;
/// Cubes that keep a large GPU busy.
const CUBES: usize = 2048;
/// Pixels that a unit sums at least, so that adding the sums of units up costs little.
const LEAST_PIXELS: usize = 8;

/// Convolution of `x`, `[batch, channels, height, width]`, with bias and leaky ReLU.
pub fn convolve(x: &Gpu, weight: &Gpu, bias: &Gpu, leak: f32) -> Gpu {
    let [outputs, inputs, kernel, _] = dims(weight);
    let groups = dims::<4>(x)[1] / inputs;
    let outputs = outputs / groups;
    let block = divisor(outputs, MOST_OUTPUTS);
    run_convolve(x, weight, bias, groups, leak, Shape { inputs, outputs, block, kernel, turned: false })
}

/// The gradient of what a convolution in `groups` reads, given that before its ReLU.
pub fn convolve_back(gradient: &Gpu, weight: &Gpu, groups: usize) -> Gpu {
    let [outputs, inputs, kernel, _] = dims(weight);
    let block = divisor(inputs, MOST_OUTPUTS);
    let shape = Shape { inputs: outputs / groups, outputs: inputs, block, kernel, turned: true };
    // It has no bias, and reads none.
    run_convolve(gradient, weight, weight, groups, 1.0, shape)
}

fn run_convolve(x: &Gpu, weight: &Gpu, bias: &Gpu, groups: usize, leak: f32, shape: Shape) -> Gpu {
    let [batch, _, height, width] = dims(x);
    let made = empty(x, [batch, groups * shape.outputs, height, width]);
    let blocks = groups * shape.outputs / shape.block;
    convolution::convolve::launch(
        &x.client,
        cubes(height * width, blocks, batch),
        units(height * width),
        buffer(x),
        buffer(weight),
        buffer(bias),
        buffer(&made),
        height as u32,
        width as u32,
        groups as u32,
        leak,
        shape,
    );
    made
}

/// The gradient before a leaky ReLU that made `y`.
pub fn before_leak(y: &Gpu, gradient: &Gpu, leak: f32) -> Gpu {
    if leak == 1.0 {
        return gradient.clone();
    }
    let before = empty(y, dims::<4>(y));
    let numbers = y.shape().num_elements();
    convolution::before_leak::launch(
        &y.client,
        cubes(numbers, 1, 1),
        units(numbers),
        buffer(y),
        buffer(gradient),
        buffer(&before),
        leak,
    );
    before
}

/// The gradients of a convolution's weights and biases, given what it read and the gradient before its ReLU.
pub fn correlate(x: &Gpu, gradient: &Gpu, weight: &Gpu) -> [Gpu; 2] {
    let [batch, channels, height, width] = dims(x);
    let [all_outputs, inputs, kernel, _] = dims(weight);
    let groups = channels / inputs;
    let outputs = all_outputs / groups;
    let block = divisor(outputs, (MOST_SUMS / (kernel * kernel)).clamp(1, MOST_OUTPUTS));
    let shape = Shape { inputs, outputs, block, kernel, turned: false };
    let blocks = all_outputs / block;
    let most = (batch * height * width).div_ceil(UNITS * LEAST_PIXELS);
    let shares = (CUBES / (blocks * inputs)).clamp(1, most);
    let weights = all_outputs * inputs * kernel * kernel;
    // Planes of units may be larger than the smallest: then rows at the end stay zero.
    let planes = UNITS / x.client.properties().hardware.plane_size_min as usize;
    let rows = [shares * planes, weights + all_outputs].into();
    let rows = zeros_client(x.client.clone(), x.device.clone(), rows, x.dtype);
    convolution::correlate::launch(
        &x.client,
        CubeCount::Static(shares as u32, blocks as u32, inputs as u32),
        CubeDim::new_1d(UNITS as u32),
        buffer(x),
        buffer(gradient),
        buffer(&rows),
        batch as u32,
        height as u32,
        width as u32,
        groups as u32,
        shape,
    );
    let by_weight = empty(x, [all_outputs, inputs, kernel, kernel]);
    let by_bias = empty(x, [all_outputs]);
    for (sums, first) in [(&by_weight, 0), (&by_bias, weights)] {
        let numbers = sums.shape().num_elements();
        convolution::sum_rows::launch(
            &x.client,
            cubes(numbers, 1, 1),
            units(numbers),
            buffer(&rows),
            buffer(sums),
            (weights + all_outputs) as u32,
            first as u32,
        );
    }
    [by_weight, by_bias]
}

/// `coarse`, doubled, and `fine` in so many groups.
pub fn join(coarse: &Gpu, fine: &Gpu, groups: usize) -> Gpu {
    let [batch, channels, height, width] = dims(fine);
    let channels = channels + dims::<4>(coarse)[1];
    let joined = empty(fine, [batch, channels, height, width]);
    join::join::launch(
        &fine.client,
        cubes(height * width, channels, batch),
        units(height * width),
        buffer(coarse),
        buffer(fine),
        buffer(&joined),
        height as u32,
        width as u32,
        groups as u32,
        shares(coarse, fine, groups),
    );
    joined
}

/// The gradients of `coarse` and `fine`, given that of what they were [joined](join) to.
pub fn part(gradient: &Gpu, coarse: &Gpu, fine: &Gpu, groups: usize) -> [Gpu; 2] {
    let [batch, coarse_channels, rows, columns] = dims(coarse);
    let [_, fine_channels, height, width] = dims(fine);
    let (by_coarse, by_fine) = (empty(coarse, dims::<4>(coarse)), empty(fine, dims::<4>(fine)));
    let shares = shares(coarse, fine, groups);
    let gradient = into_contiguous(gradient.clone());
    join::coarse_gradient::launch(
        &coarse.client,
        cubes(rows * columns, coarse_channels, batch),
        units(rows * columns),
        buffer(&gradient),
        buffer(&by_coarse),
        rows as u32,
        columns as u32,
        groups as u32,
        shares,
    );
    join::fine_gradient::launch(
        &fine.client,
        cubes(height * width, fine_channels, batch),
        units(height * width),
        buffer(&gradient),
        buffer(&by_fine),
        (height * width) as u32,
        groups as u32,
        shares,
    );
    [by_coarse, by_fine]
}

fn shares(coarse: &Gpu, fine: &Gpu, groups: usize) -> Shares {
    Shares { coarse: dims::<4>(coarse)[1] / groups, fine: dims::<4>(fine)[1] / groups }
}

/// The filter's image of what the last convolution `made`, `[batch, weights, height, width]`, and of the light's pyramid.
pub fn filtered(filter: Filter, made: &Gpu, pyramid: &Gpu) -> Gpu {
    let [batch, _, height, width] = dims(made);
    let form = form(filter, pyramid);
    let image = empty(made, [batch, form.channels, height, width]);
    filter::filter::launch(
        &made.client,
        cubes(height * width, batch, 1),
        units(height * width),
        buffer(made),
        buffer(pyramid),
        buffer(&image),
        height as u32,
        width as u32,
        form,
    );
    image
}

/// The gradient of [`filtered`] by `made`, given that by the image.
pub fn filter_gradient(filter: Filter, made: &Gpu, pyramid: &Gpu, gradient: &Gpu) -> Gpu {
    let [batch, _, height, width] = dims(made);
    let by_made = empty(made, dims::<4>(made));
    filter::filter_gradient::launch(
        &made.client,
        cubes(height * width, batch, 1),
        units(height * width),
        buffer(made),
        buffer(pyramid),
        buffer(gradient),
        buffer(&by_made),
        height as u32,
        width as u32,
        form(filter, pyramid),
    );
    by_made
}

fn form(filter: Filter, pyramid: &Gpu) -> Form {
    let [_, channels, _] = dims(pyramid);
    Form { levels: filter.levels, kernel: filter.kernel, weights: filter.weight_count(), channels }
}

/// The largest divisor that is at most so large.
fn divisor(number: usize, most: usize) -> usize {
    (1..=most.min(number)).rev().find(|divisor| number.is_multiple_of(*divisor)).unwrap_or(1)
}

/// Units of a cube for so much work.
fn units(work: usize) -> CubeDim {
    CubeDim::new_1d(work.next_power_of_two().clamp(32, UNITS) as u32)
}

/// Cubes of [`units`] for so much work, so many times along y and z.
fn cubes(work: usize, y: usize, z: usize) -> CubeCount {
    let units = units(work).x as usize;
    CubeCount::Static(work.div_ceil(units) as u32, y as u32, z as u32)
}

fn dims<const D: usize>(tensor: &Gpu) -> [usize; D] {
    tensor.shape().dims()
}

fn empty<const D: usize>(like: &Gpu, shape: [usize; D]) -> Gpu {
    empty_device_contiguous_dtype(like.client.clone(), like.device.clone(), shape.into(), like.dtype)
}

/// A tensor's numbers in their order.
fn buffer(tensor: &Gpu) -> BufferArg {
    into_contiguous(tensor.clone()).into_buffer_arg()
}
