//! The gradients of a convolution by its weights and biases.
//!
//! A unit sums the products of some weights over its share of the pixels.

use super::Gpu;
use super::convolution::{ConvConfig, MOST_OUTPUTS, under};
use super::launch::{UNITS, buffer, dims, divisor, each, empty, units};
use burn::backend::TensorMetadata;
use burn_cubecl::ops::numeric::zeros_client;
use cubecl::prelude::*;

/// Most sums of a unit: they stay in registers.
const MOST_SUMS: usize = 72;
/// Cubes that keep a large GPU busy.
const CUBES: usize = 2048;
/// Pixels that a unit sums at least, so that adding the sums of units up costs little.
const LEAST_PIXELS: usize = 8;

/// The gradients by weights and biases, given what was read and the gradient before the ReLU.
pub fn weight_gradient(x: &Gpu, gradient: &Gpu, weight: &Gpu) -> [Gpu; 2] {
    let [batch, channels, height, width] = dims(x);
    let [all_outputs, inputs, kernel, _] = dims(weight);
    let groups = channels / inputs;
    let outputs = all_outputs / groups;
    let block = divisor(outputs, (MOST_SUMS / (kernel * kernel)).clamp(1, MOST_OUTPUTS));
    let config = ConvConfig { inputs, outputs, block, kernel, transposed: false };
    let blocks = all_outputs / block;
    let most = (batch * height * width).div_ceil(UNITS * LEAST_PIXELS);
    let shares = (CUBES / (blocks * inputs)).clamp(1, most);
    // Where planes are larger than the smallest, rows stay zero.
    let planes = UNITS / x.client.properties().hardware.plane_size_min as usize;
    let weights = all_outputs * inputs * kernel * kernel;
    let rows = [shares * planes, weights + all_outputs].into();
    let rows = zeros_client(x.client.clone(), x.device.clone(), rows, x.dtype);
    correlation::launch(
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
        planes,
        config,
    );
    let summed = |sums: Gpu, first: usize| {
        let numbers = sums.shape().num_elements();
        let width = (weights + all_outputs) as u32;
        let (rows, sum) = (buffer(&rows), buffer(&sums));
        row_sums::launch(&x.client, each(x, numbers), units(numbers), rows, sum, width, first as u32);
        sums
    };
    let by_weight = summed(empty(x, [all_outputs, inputs, kernel, kernel]), 0);
    [by_weight, summed(empty(x, [all_outputs]), weights)]
}

/// Sums of products of `gradient` and the pixels of `source` under each weight, and of `gradient` alone: rows
/// of weights, then biases, one a plane of units. Cubes along x share the pixels of all images, along y are
/// blocks of outputs of all groups, along z inputs.
#[cube(launch)]
fn correlation(
    source: &[f32],
    gradient: &[f32],
    rows: &mut [f32],
    batch: u32,
    height: u32,
    width: u32,
    groups: u32,
    #[comptime] planes: usize,
    #[comptime] config: ConvConfig,
) {
    let ConvConfig { inputs, outputs, block, kernel, .. } = comptime!(config);
    let (height, width, groups) = (height as usize, width as usize, groups as usize);
    let area = height * width;
    let blocks = comptime!(outputs / block);
    let group = CUBE_POS_Y as usize / blocks;
    let first = CUBE_POS_Y as usize % blocks * block;
    let input = CUBE_POS_Z as usize;
    let taps = comptime!(kernel * kernel);
    let mut sums = Array::<f32>::new(comptime!(block * taps));
    let mut biases = Array::<f32>::new(block);
    #[unroll]
    for output in 0..block {
        biases[output] = 0.0;
        #[unroll]
        for tap in 0..taps {
            sums[comptime!(output * taps + tap)] = 0.0;
        }
    }
    let pixels = batch as usize * area;
    let mut at = ABSOLUTE_POS_X as usize;
    while at < pixels {
        let (image, pixel) = (at / area, at % area);
        let plane = ((image * groups + group) * inputs + input) * area;
        let mut values = Array::<f32>::new(taps);
        #[unroll]
        for tap in 0..taps {
            values[tap] = under(source, plane, pixel / width, pixel % width, height, width, tap, kernel);
        }
        #[unroll]
        for output in 0..block {
            let value = gradient[((image * groups + group) * outputs + first + output) * area + pixel];
            biases[output] += value;
            #[unroll]
            for tap in 0..taps {
                sums[comptime!(output * taps + tap)] += value * values[tap];
            }
        }
        at += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
    let weights = groups * outputs * inputs * taps;
    let row = (CUBE_POS_X as usize * planes + PLANE_POS as usize) * (weights + groups * outputs);
    #[unroll]
    for output in 0..block {
        let channel = group * outputs + first + output;
        let bias = plane_sum(biases[output]);
        if UNIT_POS_PLANE == 0 && input == 0 {
            rows[row + weights + channel] = bias;
        }
        #[unroll]
        for tap in 0..taps {
            let sum = plane_sum(sums[comptime!(output * taps + tap)]);
            if UNIT_POS_PLANE == 0 {
                rows[row + (channel * inputs + input) * taps + tap] = sum;
            }
        }
    }
}

/// Sums over rows of `width` numbers, of those from `first` on.
#[cube(launch)]
fn row_sums(rows: &[f32], sums: &mut [f32], width: u32, first: u32) {
    let at = ABSOLUTE_POS;
    if at < sums.len() {
        let mut sum = 0.0;
        for row in 0..rows.len() / width as usize {
            sum += rows[row * width as usize + first as usize + at];
        }
        sums[at] = sum;
    }
}
