//! Kernels of a grouped convolution with zero padding and stride 1, forwards and for its gradients.
//!
//! A unit makes one pixel of a block of output channels, or sums the products of some weights over its share of the pixels.
//! All images are `[batch, channels, height, width]`, all weights `[outputs, inputs / groups, kernel, kernel]`.

use cubecl::prelude::*;

/// What a kernel is compiled for: of one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shape {
    /// Channels that are read.
    pub inputs: usize,
    /// Channels that are made.
    pub outputs: usize,
    /// Of these a unit makes so many, a divisor.
    pub block: usize,
    /// Height and width of the kernels.
    pub kernel: usize,
    /// Whether gradients go back: weights are those of the convolution from outputs to inputs.
    pub turned: bool,
}

/// `made` is the convolution of `source`, plus bias, through a leaky ReLU. Units along x are pixels, along y blocks of outputs of
/// all groups, along z images.
#[cube(launch)]
pub fn convolve(
    source: &[f32],
    weight: &[f32],
    bias: &[f32],
    made: &mut [f32],
    height: u32,
    width: u32,
    groups: u32,
    leak: f32,
    #[comptime] shape: Shape,
) {
    let Shape { inputs, outputs, block, kernel, turned } = comptime!(shape);
    let (height, width, groups) = (height as usize, width as usize, groups as usize);
    let area = height * width;
    let pixel = ABSOLUTE_POS_X as usize;
    if pixel >= area {
        terminate!();
    }
    let (y, x) = (pixel / width, pixel % width);
    let blocks = comptime!(outputs / block);
    let group = CUBE_POS_Y as usize / blocks;
    let first = CUBE_POS_Y as usize % blocks * block;
    let image = CUBE_POS_Z as usize;
    let taps = comptime!(kernel * kernel);
    let mut sums = Array::<f32>::new(block);
    #[unroll]
    for output in 0..block {
        if comptime!(turned) {
            sums[output] = 0.0;
        } else {
            sums[output] = bias[group * outputs + first + output];
        }
    }
    for input in 0..inputs {
        let plane = ((image * groups + group) * inputs + input) * area;
        #[unroll]
        for tap in 0..taps {
            let value = under(source, plane, y, x, height, width, tap, kernel);
            #[unroll]
            for output in 0..block {
                let at = if comptime!(turned) {
                    ((group * inputs + input) * outputs + first + output) * taps + comptime!(taps - 1 - tap)
                } else {
                    ((group * outputs + first + output) * inputs + input) * taps + tap
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
}

/// The pixel under a weight of a kernel that is centred on `y`, `x`; zero outside.
#[cube]
fn under(
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
    // Beyond the upper and the left edge these are beyond the others, too: they wrap around.
    let row = (y + comptime!(tap / kernel)) as u32 - half as u32;
    let column = (x + comptime!(tap % kernel)) as u32 - half as u32;
    let mut value = 0.0;
    if row < height as u32 && column < width as u32 {
        value = source[plane + row as usize * width + column as usize];
    }
    value
}

/// The gradient before a leaky ReLU that made `made`, from the one after it.
#[cube(launch)]
pub fn before_leak(made: &[f32], gradient: &[f32], before: &mut [f32], leak: f32) {
    let at = ABSOLUTE_POS;
    if at >= before.len() {
        terminate!();
    }
    before[at] = select(made[at] > 0.0, gradient[at], leak * gradient[at]);
}

/// Sums of products of `gradient` and the pixels of `source` under each weight, and of `gradient` alone: rows of weights, then biases,
/// one a plane of units. Cubes along x share the pixels of all images, along y are blocks of outputs of all groups, along z inputs.
#[cube(launch)]
pub fn correlate(
    source: &[f32],
    gradient: &[f32],
    rows: &mut [f32],
    batch: u32,
    height: u32,
    width: u32,
    groups: u32,
    #[comptime] shape: Shape,
) {
    let Shape { inputs, outputs, block, kernel, .. } = comptime!(shape);
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
        let (y, x) = (pixel / width, pixel % width);
        let plane = ((image * groups + group) * inputs + input) * area;
        let mut values = Array::<f32>::new(taps);
        #[unroll]
        for tap in 0..taps {
            values[tap] = under(source, plane, y, x, height, width, tap, kernel);
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
    let row = ABSOLUTE_POS_X as usize / PLANE_DIM as usize * (weights + groups * outputs);
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
pub fn sum_rows(rows: &[f32], sums: &mut [f32], width: u32, first: u32) {
    let at = ABSOLUTE_POS;
    if at >= sums.len() {
        terminate!();
    }
    let mut sum = 0.0;
    for row in 0..rows.len() / width as usize {
        sum += rows[row * width as usize + first as usize + at];
    }
    sums[at] = sum;
}
