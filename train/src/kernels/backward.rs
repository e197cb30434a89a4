//! Gradients of a convolution on the CPU, with those of what its operand does while it is read.
//!
//! As in [`deepshade_infer::cpu::conv`], a task is a stripe of rows of one group of one image: it reads its
//! rows of the operand and of the gradient once, and gives the gradient of these rows and its share of those
//! of the weights. How the work is cut and in which order shares are added depends on the shapes only, never
//! on the number of threads.

use super::correlate;
use deepshade_infer::cpu::operand::{Buffer, Image, Operand, Padded};
use deepshade_infer::cpu::shape::{ConvShape, Scale, Stripe};
use deepshade_infer::cpu::stripe::{self, Packed};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// What a convolution was run with, and the gradient of what it made.
#[derive(Clone, Copy)]
pub struct Made<'a> {
    /// `[groups * outputs, inputs, kernel, kernel]`.
    pub weight: &'a [f32],
    /// `[batch, groups * outputs, height, width]`.
    pub y: &'a [f32],
    /// Gradient of `y`.
    pub dy: &'a [f32],
    /// Factor of negative values.
    pub leak: f32,
}

/// Gradients of a convolution.
pub struct Gradients {
    /// Of the operand's images, where they were asked for: one, or the coarse and the fine one.
    pub operand: Vec<Vec<f32>>,
    /// `[groups * outputs, inputs, kernel, kernel]`.
    pub weight: Vec<f32>,
    /// `[groups * outputs]`.
    pub bias: Vec<f32>,
}

/// The gradients of [`forward`](deepshade_infer::cpu::conv::forward).
pub fn backward(shape: ConvShape, operand: &Operand<'_>, made: Made<'_>, wants_operand: bool) -> Gradients {
    let zeros = |count: usize| vec![0.0; count];
    let mut gradients = Gradients {
        operand: if wants_operand {
            images(operand).map(|image| zeros(image.data.len())).collect()
        } else {
            Vec::new()
        },
        weight: zeros(shape.groups * shape.group_weights()),
        bias: zeros(shape.groups * shape.outputs),
    };
    let stripes = stripes(shape, operand, &mut gradients.operand);
    let transposed = transposed(shape);
    let turned = Packed::new(transposed, &turned(shape, made.weight));
    let shares: Vec<(usize, correlate::Share)> = stripes
        .into_par_iter()
        .map_init(Buffers::default, |buffers, stripe| {
            let group = stripe.part % shape.groups;
            let job =
                Job { shape, transposed, operand, made, turned: &turned, wants_operand, stripe, buffers };
            (group, Arch::new().dispatch(job))
        })
        .collect();
    for (group, share) in shares {
        add(&mut gradients.weight[group * shape.group_weights()..], &share.weight);
        add(&mut gradients.bias[group * shape.outputs..], &share.bias);
    }
    gradients
}

fn add(sum: &mut [f32], terms: &[f32]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += term;
    }
}

fn images<'a, 'b>(operand: &'b Operand<'a>) -> impl Iterator<Item = &'b Image<'a>> {
    match operand {
        Operand::Plain(image) | Operand::Folded(image) | Operand::Pooled(image) => [Some(image), None],
        Operand::Joined { coarse, fine, .. } => [Some(coarse), Some(fine)],
    }
    .into_iter()
    .flatten()
}

/// The convolution that carries gradients back: from outputs to inputs.
const fn transposed(shape: ConvShape) -> ConvShape {
    ConvShape { inputs: shape.outputs, outputs: shape.inputs, ..shape }
}

/// Weights of the transposed convolution, `[groups, inputs, outputs, kernel, kernel]`: the kernels turned by
/// half.
fn turned(shape: ConvShape, weight: &[f32]) -> Vec<f32> {
    let area = shape.kernel * shape.kernel;
    let mut turned = Vec::with_capacity(weight.len());
    for group in weight.chunks_exact(shape.group_weights()) {
        for input in 0..shape.inputs {
            for output in 0..shape.outputs {
                turned.extend(group[(output * shape.inputs + input) * area..][..area].iter().rev());
            }
        }
    }
    turned
}

/// The stripes of the work, each with the parts of the operand's gradients that it makes.
fn stripes<'a>(shape: ConvShape, operand: &Operand<'_>, gradients: &'a mut [Vec<f32>]) -> Vec<Stripe<'a>> {
    let mut stripes = shape.stripes();
    let mut distribute = |image, positions: &[usize], scale| {
        shape.distribute(&mut stripes, shape.inputs, image, positions, scale);
    };
    let channels: Vec<usize> = (0..shape.groups * shape.inputs).collect();
    match (operand, gradients) {
        (Operand::Plain(_), [image]) => distribute(image, &channels, Scale::Same),
        (Operand::Pooled(_), [image]) => distribute(image, &channels, Scale::Double),
        (Operand::Joined { coarse, order, .. }, [coarse_gradient, fine_gradient]) => {
            let mut positions = channels;
            order.iter().enumerate().for_each(|(position, channel)| positions[*channel] = position);
            let (of_coarse, of_fine) = positions.split_at(coarse.channels);
            distribute(coarse_gradient, of_coarse, Scale::Half);
            distribute(fine_gradient, of_fine, Scale::Same);
        }
        // No gradient of the operand is wanted.
        _ => {}
    }
    stripes
}

/// Room for what a stripe reads, kept for further ones as long as rayon gives them to a thread in one piece.
#[derive(Default)]
struct Buffers {
    x: Buffer,
    dy: Vec<f32>,
    dx: Vec<f32>,
    blend: Vec<f32>,
}

/// The gradients of one stripe.
struct Job<'a, 'b> {
    shape: ConvShape,
    transposed: ConvShape,
    operand: &'a Operand<'a>,
    made: Made<'a>,
    turned: &'a Packed,
    wants_operand: bool,
    stripe: Stripe<'b>,
    buffers: &'a mut Buffers,
}

impl WithSimd for Job<'_, '_> {
    type Output = correlate::Share;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> correlate::Share {
        let Self { shape, transposed, operand, made, turned, wants_operand, mut stripe, buffers } = self;
        let Buffers { x, dy, dx, blend } = buffers;
        // Doubling spreads a gradient by a row beyond the stripe's own.
        let beyond = usize::from(wants_operand && matches!(operand, Operand::Joined { .. }));
        let top = stripe.top.saturating_sub(beyond);
        let rows = (stripe.top + stripe.rows + beyond).min(shape.height) - top;
        let area = shape.height * shape.width;
        let dy = Padded::filled(
            transposed,
            transposed.inputs,
            top,
            rows,
            dy,
            #[inline(always)]
            |channel, y, row| {
                let at = (stripe.part * shape.outputs + channel) * area + y * shape.width;
                before_leak(&made.y[at..], &made.dy[at..], made.leak, row);
            },
        );
        if wants_operand {
            let size = rows * shape.width;
            dx.resize(shape.inputs * size, 0.0);
            let mut planes: Vec<&mut [f32]> = dx.chunks_exact_mut(size).take(shape.inputs).collect();
            let weights = turned.group(stripe.part % shape.groups);
            let zeros = vec![0.0; shape.inputs];
            stripe::convolve(simd, &dy, transposed, weights, &zeros, 1.0, &mut planes);
            let inner = (stripe.top - top) * shape.width..(stripe.top - top + stripe.rows) * shape.width;
            let first = stripe.part % shape.groups * shape.inputs;
            for (input, (out, made)) in stripe.planes.iter_mut().zip(&planes).enumerate() {
                match operand {
                    Operand::Pooled(_) => spread(made, shape.width, out),
                    Operand::Joined { coarse, order, .. } if order[first + input] < coarse.channels => {
                        double_backward(made, shape.width, stripe.top - top, blend, out);
                    }
                    // What is folded is the network's input, whose gradient nobody wants.
                    Operand::Plain(_) | Operand::Folded(_) | Operand::Joined { .. } => {
                        out.copy_from_slice(&made[inner.clone()]);
                    }
                }
            }
        }
        let x = Padded::of(operand, shape, stripe.part, stripe.top, stripe.rows, x);
        correlate::share(simd, shape, &x, &dy, stripe.top - top)
    }
}

/// The gradient before a leaky ReLU that made `y`, from the gradient `dy` after it.
#[inline(always)]
fn before_leak(y: &[f32], dy: &[f32], leak: f32, out: &mut [f32]) {
    let (y, dy) = (&y[..out.len()], &dy[..out.len()]);
    for x in 0..out.len() {
        out[x] = if y[x] > 0.0 { dy[x] } else { leak * dy[x] };
    }
}

/// The gradient of 2x2 means, given that of the means, rows of `width`.
#[inline(always)]
fn spread(means: &[f32], width: usize, out: &mut [f32]) {
    for (means, rows) in means.chunks_exact(width).zip(out.chunks_exact_mut(4 * width)) {
        let (upper, lower) = rows.split_at_mut(2 * width);
        for x in 0..width {
            upper[2 * x] = 0.25 * means[x];
            upper[2 * x + 1] = 0.25 * means[x];
        }
        lower.copy_from_slice(upper);
    }
}

/// The gradient of bilinear doubling, given that of some rows of `width` of the doubled image: of these the
/// stripe's own begin at `first`, with what the image has on either side.
#[inline(always)]
fn double_backward(doubled: &[f32], width: usize, first: usize, blend: &mut Vec<f32>, out: &mut [f32]) {
    let last = doubled.len() / width - 1;
    let row = |y: usize| &doubled[y * width..][..width];
    blend.resize(width + 2, 0.0);
    for (y, out) in out.chunks_exact_mut(width / 2).enumerate() {
        let y = first + 2 * y;
        let (a, b) = (row(y), row(y + 1));
        let (c, d) = (row(y.saturating_sub(1)), row((y + 2).min(last)));
        let inner = &mut blend[1..=width];
        for x in 0..width {
            inner[x] = 0.75 * (a[x] + b[x]) + 0.25 * (c[x] + d[x]);
        }
        narrow(blend, out);
    }
}

/// The gradient of doubling a row, given that of the doubled row between two numbers to spare.
#[inline(always)]
fn narrow(row: &mut [f32], out: &mut [f32]) {
    let last = row.len() - 1;
    (row[0], row[last]) = (row[1], row[last - 1]);
    let row = &row[..2 * out.len() + 2];
    for x in 0..out.len() {
        out[x] = 0.75 * (row[2 * x + 1] + row[2 * x + 2]) + 0.25 * (row[2 * x] + row[2 * x + 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::parity;

    #[test]
    fn the_bits_do_not_depend_on_threads() {
        let shape =
            ConvShape { batch: 4, groups: 2, inputs: 8, outputs: 16, height: 130, width: 70, kernel: 3 };
        let images = shape.batch * shape.groups;
        assert!(shape.stripes().len() > images, "images are cut, so that there are shares to be added");
        let noise =
            |channels, height, width, seed| parity::noise(channels, height, width, seed).data().to_vec();
        let [x, y, dy] = [(shape.inputs, 1), (shape.outputs, 2), (shape.outputs, 3)]
            .map(|(channels, seed)| noise(images * channels, shape.height, shape.width, seed));
        let weight = noise(shape.groups * shape.outputs * shape.inputs, shape.kernel, shape.kernel, 4);
        let [data, made] = [&x, &y].map(|data| &data[..]);
        let channels = shape.groups * shape.inputs;
        let image = Image { data, channels, height: shape.height, width: shape.width };
        let gradients = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let made = Made { weight: &weight, y: made, dy: &dy, leak: 0.01 };
            let Gradients { operand, weight, bias } =
                pool.install(|| backward(shape, &Operand::Plain(image), made, true));
            let all = operand.concat().into_iter().chain(weight).chain(bias);
            all.map(f32::to_bits).collect::<Vec<u32>>()
        };
        let alone = gradients(1);
        for threads in [2, 7] {
            assert!(gradients(threads) == alone, "with {threads} threads");
        }
    }

    #[test]
    fn an_operand_whose_gradient_is_not_wanted_costs_none() {
        let shape = ConvShape { batch: 1, groups: 1, inputs: 2, outputs: 4, height: 8, width: 8, kernel: 3 };
        let (image, weight) = (parity::noise(2, 8, 8, 1), parity::noise(8, 3, 3, 2));
        let operand = Operand::Plain(Image { data: image.data(), channels: 2, height: 8, width: 8 });
        let made = vec![0.5; 4 * 64];
        let made = Made { weight: weight.data(), y: &made, dy: &made, leak: 0.1 };
        let images = |wants: bool| backward(shape, &operand, made, wants).operand.len();
        assert_eq!([images(true), images(false)], [1, 0]);
    }
}
