//! Grouped convolution with bias and leaky ReLU, and its gradients, on the CPU.
//!
//! A task is a stripe of rows of one group of one image. It copies the rows it reads into a buffer with a border of
//! zeros, so that the inner loops know no edges, and runs the vector loops of [`super::stripe`] on it. How the work
//! is cut and in which order partial sums are added depends on the shapes only, never on the number of threads.

use super::stripe;
use rayon::prelude::*;

/// Rows of a stripe: few enough that what a task reads stays in the second-level cache.
const ROWS: usize = 16;

/// The sizes of a convolution that keeps height and width (stride 1, zero padding, odd kernel).
#[derive(Clone, Copy, Debug)]
pub struct ConvShape {
    /// Number of images.
    pub batch: usize,
    /// Number of groups.
    pub groups: usize,
    /// Channels that a group reads.
    pub inputs: usize,
    /// Channels that a group makes.
    pub outputs: usize,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// Width and height of the kernel.
    pub kernel: usize,
}

/// Gradients of a convolution.
pub struct ConvGradients {
    /// Of the input, `[batch, groups * inputs, height, width]`, where it was asked for.
    pub input: Option<Vec<f32>>,
    /// Of the weights, `[groups * outputs, inputs, kernel, kernel]`.
    pub weight: Vec<f32>,
    /// Of the biases, `[groups * outputs]`.
    pub bias: Vec<f32>,
}

impl ConvShape {
    /// Weights of a group.
    const fn group_weights(&self) -> usize {
        self.outputs * self.inputs * self.kernel * self.kernel
    }

    /// The convolution that carries gradients back: from outputs to inputs.
    const fn transposed(self) -> Self {
        Self { inputs: self.outputs, outputs: self.inputs, ..self }
    }

    /// Cuts an image `[batch, groups * channels, height, width]` into stripes.
    fn stripes<'a>(&self, image: &'a mut [f32], channels: usize) -> Vec<Stripe<'a>> {
        let count = self.height.div_ceil(ROWS);
        let mut stripes: Vec<Stripe> = (0..self.batch * self.groups * count)
            .map(|task| Stripe { part: task / count, top: task % count * ROWS, rows: Vec::new() })
            .collect();
        for (channel, plane) in image.chunks_exact_mut(self.height * self.width).enumerate() {
            for (at, rows) in plane.chunks_mut(ROWS * self.width).enumerate() {
                stripes[channel / channels * count + at].rows.push(rows);
            }
        }
        stripes
    }
}

/// A stripe of rows of one group of one image.
struct Stripe<'a> {
    /// `image * groups + group`.
    part: usize,
    /// Its first row.
    top: usize,
    /// Its rows, channel by channel, `[height of the stripe, width]` each.
    rows: Vec<&'a mut [f32]>,
}

/// Convolution, bias, leaky ReLU (`leak` 1 for none): `[batch, groups * outputs, height, width]`.
pub fn forward(shape: ConvShape, x: &[f32], weight: &[f32], bias: &[f32], leak: f32) -> Vec<f32> {
    let mut y = vec![0.0; shape.batch * shape.groups * shape.outputs * shape.height * shape.width];
    let stripes = shape.stripes(&mut y, shape.outputs);
    stripes.into_par_iter().for_each_init(Vec::new, |buffer, mut stripe| {
        let group = stripe.part % shape.groups;
        let weight = &weight[group * shape.group_weights()..][..shape.group_weights()];
        let padded = Padded::fill(buffer, shape, shape.inputs, &stripe, |row, at| {
            row.copy_from_slice(&x[at..at + row.len()]);
        });
        let bias = &bias[group * shape.outputs..][..shape.outputs];
        stripe::convolve(&padded, shape, weight, bias, leak, &mut stripe.rows);
    });
    y
}

/// The gradients of [`forward`], given its output `y` and the gradient `dy` of that output.
pub fn backward(
    shape: ConvShape,
    x: &[f32],
    weight: &[f32],
    y: &[f32],
    dy: &[f32],
    leak: f32,
    wants_input: bool,
) -> ConvGradients {
    let flipped = flip(shape, weight);
    let mut dx = vec![0.0; if wants_input { x.len() } else { 0 }];
    let mut stripes =
        if wants_input { shape.stripes(&mut dx, shape.inputs) } else { shape.stripes(&mut [], shape.inputs) };
    let partial: Vec<(Vec<f32>, Vec<f32>)> = stripes
        .par_iter_mut()
        .map_init(
            || (Vec::new(), Vec::new()),
            |(x_buffer, dy_buffer), stripe| {
                let dy = Padded::fill(dy_buffer, shape, shape.outputs, stripe, |row, at| {
                    stripe::leaky_backward(&y[at..at + row.len()], &dy[at..at + row.len()], leak, row);
                });
                if wants_input {
                    let group = stripe.part % shape.groups;
                    let weight = &flipped[group * shape.group_weights()..][..shape.group_weights()];
                    let zeros = vec![0.0; shape.inputs];
                    stripe::convolve(&dy, shape.transposed(), weight, &zeros, 1.0, &mut stripe.rows);
                }
                let x = Padded::fill(x_buffer, shape, shape.inputs, stripe, |row, at| {
                    row.copy_from_slice(&x[at..at + row.len()]);
                });
                (stripe::correlate(&x, &dy, shape), stripe::sums(&dy, shape))
            },
        )
        .collect();
    let mut gradients = ConvGradients {
        input: None,
        weight: vec![0.0; shape.groups * shape.group_weights()],
        bias: vec![0.0; shape.groups * shape.outputs],
    };
    for (stripe, (weight, bias)) in stripes.iter().zip(&partial) {
        let group = stripe.part % shape.groups;
        add(&mut gradients.weight[group * shape.group_weights()..], weight);
        add(&mut gradients.bias[group * shape.outputs..], bias);
    }
    drop(stripes);
    gradients.input = wants_input.then_some(dx);
    gradients
}

fn add(sum: &mut [f32], terms: &[f32]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += term;
    }
}

/// Weights of the transposed convolution, `[groups, inputs, outputs, kernel, kernel]`: the kernels turned by half.
fn flip(shape: ConvShape, weight: &[f32]) -> Vec<f32> {
    let area = shape.kernel * shape.kernel;
    let mut flipped = Vec::with_capacity(weight.len());
    for group in weight.chunks_exact(shape.group_weights()) {
        for input in 0..shape.inputs {
            for output in 0..shape.outputs {
                flipped.extend(group[(output * shape.inputs + input) * area..][..area].iter().rev());
            }
        }
    }
    flipped
}

/// The rows that a stripe reads, with a border of zeros: `[channels, rows + kernel - 1, stride]`.
pub struct Padded<'a> {
    /// The values.
    pub data: &'a [f32],
    /// Length of a row: the width rounded up to whole vectors, and the border.
    pub stride: usize,
    /// Rows of the stripe itself.
    pub rows: usize,
}

impl<'a> Padded<'a> {
    /// Fills a buffer by rows: `fill` gets a row and where it begins in the image `[batch, channels, height, width]`.
    fn fill(
        buffer: &'a mut Vec<f32>,
        shape: ConvShape,
        channels: usize,
        stripe: &Stripe,
        fill: impl Fn(&mut [f32], usize),
    ) -> Self {
        let half = shape.kernel / 2;
        let rows = ROWS.min(shape.height - stripe.top);
        let stride = shape.width.next_multiple_of(stripe::TILE) + 2 * half;
        let height = rows + 2 * half;
        buffer.resize(channels * height * stride, 0.0);
        for (at, row) in buffer.chunks_exact_mut(stride).enumerate() {
            let (channel, y) = (at / height, stripe.top + at % height);
            if (half..shape.height + half).contains(&y) {
                let source = (stripe.part * channels + channel) * shape.height + y - half;
                fill(&mut row[half..half + shape.width], source * shape.width);
                row[..half].fill(0.0);
                row[half + shape.width..].fill(0.0);
            } else {
                row.fill(0.0);
            }
        }
        Self { data: buffer, stride, rows }
    }

    /// Where the first pixel of the window of each weight `[channels, kernel, kernel]` lies.
    pub fn taps(&self, channels: usize, kernel: usize) -> Vec<usize> {
        let plane = (self.rows + kernel - 1) * self.stride;
        let mut taps = Vec::with_capacity(channels * kernel * kernel);
        for channel in 0..channels {
            for y in 0..kernel {
                taps.extend((0..kernel).map(|x| channel * plane + y * self.stride + x));
            }
        }
        taps
    }
}
