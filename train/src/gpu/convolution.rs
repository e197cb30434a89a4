//! A grouped convolution with zero padding, stride 1, bias and leaky ReLU, and its gradient by what it reads.
//!
//! A unit makes a pixel of a block of output channels. All images are `[batch, channels, height, width]`, all
//! weights `[outputs, inputs / groups, kernel, kernel]`.

use super::Gpu;
use super::launch::{buffer, cubes, dims, divisor, each, empty, units};
use burn::backend::TensorMetadata;
use cubecl::prelude::*;

/// Most outputs that a unit makes: their sums stay in registers.
pub const MOST_OUTPUTS: usize = 24;

/// What a kernel is compiled for: of one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConvConfig {
    /// Channels that are read.
    pub inputs: usize,
    /// Channels that are made.
    pub outputs: usize,
    /// Of these a unit makes so many, a divisor.
    pub block: usize,
    /// Height and width of the kernels.
    pub kernel: usize,
    /// Whether it carries gradients back: weights are those of the convolution from outputs to inputs, and
    /// there is no bias.
    pub transposed: bool,
}

/// Convolution of `x` with bias and leaky ReLU.
pub fn convolve(x: &Gpu, weight: &Gpu, bias: &Gpu, leak: f32) -> Gpu {
    let [outputs, inputs, kernel, _] = dims(weight);
    let groups = dims::<4>(x)[1] / inputs;
    let outputs = outputs / groups;
    let block = divisor(outputs, MOST_OUTPUTS);
    let config = ConvConfig { inputs, outputs, block, kernel, transposed: false };
    run(x, weight, bias, groups, leak, config)
}

/// The gradient by what a convolution in `groups` reads, given that before its ReLU.
pub fn input_gradient(gradient: &Gpu, weight: &Gpu, groups: usize) -> Gpu {
    let [outputs, inputs, kernel, _] = dims(weight);
    let block = divisor(inputs, MOST_OUTPUTS);
    let config = ConvConfig { inputs: outputs / groups, outputs: inputs, block, kernel, transposed: true };
    // Without a bias the kernel does not read what stands in its place.
    run(gradient, weight, weight, groups, 1.0, config)
}

fn run(x: &Gpu, weight: &Gpu, bias: &Gpu, groups: usize, leak: f32, config: ConvConfig) -> Gpu {
    let [batch, _, height, width] = dims(x);
    let made = empty(x, [batch, groups * config.outputs, height, width]);
    let blocks = groups * config.outputs / config.block;
    convolution::launch(
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
        config,
    );
    made
}

/// The gradient before a leaky ReLU that made `y`.
pub fn leaky_relu_backward(y: &Gpu, gradient: &Gpu, leak: f32) -> Gpu {
    if leak == 1.0 {
        return gradient.clone();
    }
    let before = empty(y, dims::<4>(y));
    let numbers = y.shape().num_elements();
    leaky_relu_gradient::launch(
        &y.client,
        each(y, numbers),
        units(numbers),
        buffer(y),
        buffer(gradient),
        buffer(&before),
        leak,
    );
    before
}

/// Units along x are pixels, along y blocks of outputs of all groups, along z images.
#[cube(launch)]
fn convolution(
    source: &[f32],
    weight: &[f32],
    bias: &[f32],
    made: &mut [f32],
    height: u32,
    width: u32,
    groups: u32,
    leak: f32,
    #[comptime] config: ConvConfig,
) {
    let ConvConfig { inputs, outputs, block, kernel, transposed } = comptime!(config);
    let (height, width, groups) = (height as usize, width as usize, groups as usize);
    let area = height * width;
    let blocks = comptime!(outputs / block);
    let group = CUBE_POS_Y as usize / blocks;
    let first = CUBE_POS_Y as usize % blocks * block;
    let image = CUBE_POS_Z as usize;
    let taps = comptime!(kernel * kernel);
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        let mut sums = Array::<f32>::new(block);
        #[unroll]
        for output in 0..block {
            if comptime!(transposed) {
                sums[output] = 0.0;
            } else {
                sums[output] = bias[group * outputs + first + output];
            }
        }
        for input in 0..inputs {
            let plane = ((image * groups + group) * inputs + input) * area;
            #[unroll]
            for tap in 0..taps {
                let value = under(source, plane, pixel / width, pixel % width, height, width, tap, kernel);
                #[unroll]
                for output in 0..block {
                    let channel = first + output;
                    let at = if comptime!(transposed) {
                        ((group * inputs + input) * outputs + channel) * taps + comptime!(taps - 1 - tap)
                    } else {
                        ((group * outputs + channel) * inputs + input) * taps + tap
                    };
                    sums[output] += value * weight[at];
                }
            }
        }
        #[unroll]
        for output in 0..block {
            let sum = sums[output];
            let at = ((image * groups + group) * outputs + first + output) * area + pixel;
            made[at] = select(sum > 0.0, sum, leak * sum);
        }
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// The pixel under a weight of a kernel that is centred on `y`, `x`; zero outside.
#[cube]
pub fn under(
    source: &[f32],
    plane: usize,
    y: usize,
    x: usize,
    height: usize,
    width: usize,
    #[comptime] tap: usize,
    #[comptime] kernel: usize,
) -> f32 {
    let half = comptime!(kernel / 2);
    // Negative positions wrap to huge ones, which the bounds reject.
    let row = (y + comptime!(tap / kernel)) as u32 - half as u32;
    let column = (x + comptime!(tap % kernel)) as u32 - half as u32;
    let mut value = 0.0;
    if row < height as u32 && column < width as u32 {
        value = source[plane + row as usize * width + column as usize];
    }
    value
}

#[cube(launch)]
fn leaky_relu_gradient(made: &[f32], gradient: &[f32], before: &mut [f32], leak: f32) {
    let at = ABSOLUTE_POS;
    if at < before.len() {
        before[at] = select(made[at] > 0.0, gradient[at], leak * gradient[at]);
    }
}
