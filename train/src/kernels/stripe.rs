//! The vector loops of a convolution: weighted sums over shifted rows, and products of shifted rows.
//!
//! Both keep a block of sums in registers: of some output channels at some neighbouring pixels, or of some output
//! channels and some weights. `pulp` chooses the instructions when the program runs.

use super::conv::{ConvShape, Padded};
use pulp::{Arch, Simd, WithSimd};

/// Rows are padded to a multiple of this, so that no block of any vector width reaches beyond them.
pub const TILE: usize = 64;

/// Convolves a stripe: bias, weighted sums, leaky ReLU.
///
/// `weight` is `[outputs, inputs, kernel, kernel]`, `rows` one `[rows, width]` an output channel.
pub fn convolve(
    x: &Padded,
    shape: ConvShape,
    weight: &[f32],
    bias: &[f32],
    leak: f32,
    rows: &mut [&mut [f32]],
) {
    let taps = x.taps(shape.inputs, shape.kernel);
    let job = Convolve { x, taps: &taps, weight, bias, leak, width: shape.width, rows };
    match shape.outputs % 4 {
        0 => Arch::new().dispatch(Blocked::<_, 4, 2>(job)),
        _ => Arch::new().dispatch(Blocked::<_, 1, 8>(job)),
    }
}

/// Gradient of the weights from a stripe: `[outputs, inputs, kernel, kernel]`.
pub fn correlate(x: &Padded, dy: &Padded, shape: ConvShape) -> Vec<f32> {
    let taps = x.taps(shape.inputs, shape.kernel);
    let starts = centres(dy, shape);
    let job = Correlate { x, dy, taps: &taps, starts: &starts, width: shape.width };
    match shape.outputs % 4 {
        0 => Arch::new().dispatch(Blocked::<_, 4, 3>(job)),
        _ => Arch::new().dispatch(Blocked::<_, 1, 9>(job)),
    }
}

/// Gradient of the biases from a stripe: `[outputs]`.
pub fn sums(dy: &Padded, shape: ConvShape) -> Vec<f32> {
    let sum = |start: usize| -> f32 {
        (0..dy.rows).map(|y| dy.data[start + y * dy.stride..][..shape.width].iter().sum::<f32>()).sum()
    };
    centres(dy, shape).into_iter().map(sum).collect()
}

/// Where the first pixel of each output channel lies inside the border.
fn centres(dy: &Padded, shape: ConvShape) -> Vec<usize> {
    let half = shape.kernel / 2;
    let plane = (dy.rows + 2 * half) * dy.stride;
    (0..shape.outputs).map(|output| output * plane + half * (dy.stride + 1)).collect()
}

/// A job with the shape of its block of registers: `A` output channels times `B` vectors or weights.
struct Blocked<J, const A: usize, const B: usize>(J);

struct Convolve<'a, 'b> {
    x: &'a Padded<'a>,
    taps: &'a [usize],
    weight: &'a [f32],
    bias: &'a [f32],
    leak: f32,
    width: usize,
    rows: &'a mut [&'b mut [f32]],
}

impl<const A: usize, const B: usize> WithSimd for Blocked<Convolve<'_, '_>, A, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let job = self.0;
        let tile = B * S::F32_LANES;
        for (block, rows) in job.rows.chunks_exact_mut(A).enumerate() {
            let weight = interleave::<A>(&job.weight[block * A * job.taps.len()..], job.taps.len());
            let bias: [S::f32s; A] = std::array::from_fn(|a| simd.splat_f32s(job.bias[block * A + a]));
            for y in 0..job.x.rows {
                for x in (0..job.width).step_by(tile) {
                    let at = y * job.x.stride + x;
                    let mut sums = bias.map(|bias| [bias; B]);
                    for (tap, weight) in job.taps.iter().zip(&weight) {
                        let pixels = &job.x.data[tap + at..][..tile];
                        let (pixels, _) = S::as_simd_f32s(pixels);
                        for a in 0..A {
                            let weight = simd.splat_f32s(weight[a]);
                            for b in 0..B {
                                sums[a][b] = simd.mul_add_e_f32s(weight, pixels[b], sums[a][b]);
                            }
                        }
                    }
                    let end = (x + tile).min(job.width);
                    for (row, sums) in rows.iter_mut().zip(&sums) {
                        store(simd, sums, job.leak, &mut row[y * job.width + x..y * job.width + end]);
                    }
                }
            }
        }
    }
}

/// Weights `[A, taps]` as `[taps, A]`.
fn interleave<const A: usize>(weight: &[f32], taps: usize) -> Vec<[f32; A]> {
    (0..taps).map(|tap| std::array::from_fn(|a| weight[a * taps + tap])).collect()
}

/// Leaky ReLU, then out to memory; the last block of a row may be cut short.
#[inline(always)]
fn store<S: Simd, const B: usize>(simd: S, sums: &[S::f32s; B], leak: f32, out: &mut [f32]) {
    let leak = simd.splat_f32s(leak);
    for (sum, out) in sums.iter().zip(out.chunks_mut(S::F32_LANES)) {
        let leaked = simd.mul_f32s(*sum, leak);
        let positive = simd.greater_than_f32s(*sum, simd.splat_f32s(0.0));
        let value = simd.select_f32s(positive, *sum, leaked);
        match S::as_mut_simd_f32s(out) {
            ([whole], _) => *whole = value,
            (_, part) => simd.partial_store_f32s(part, value),
        }
    }
}

struct Correlate<'a> {
    x: &'a Padded<'a>,
    dy: &'a Padded<'a>,
    taps: &'a [usize],
    starts: &'a [usize],
    width: usize,
}

impl<const A: usize, const B: usize> WithSimd for Blocked<Correlate<'_>, A, B> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f32> {
        let job = self.0;
        let count = job.taps.len();
        let mut made = vec![0.0; job.starts.len() * count];
        for (starts, sums) in job.starts.chunks_exact(A).zip(made.chunks_exact_mut(A * count)) {
            for first in (0..count).step_by(B) {
                // The last block may name a weight more than once; its sum is the same each time.
                let taps: [usize; B] = std::array::from_fn(|b| job.taps[(first + b).min(count - 1)]);
                let block = products::<S, A, B>(simd, &job, starts, taps);
                for b in 0..B.min(count - first) {
                    for a in 0..A {
                        sums[a * count + first + b] = simd.reduce_sum_f32s(block[a][b]);
                    }
                }
            }
        }
        made
    }
}

/// Sums over the stripe of `A` gradients times the pixels under `B` weights.
#[inline(always)]
fn products<S: Simd, const A: usize, const B: usize>(
    simd: S,
    job: &Correlate,
    starts: &[usize],
    taps: [usize; B],
) -> [[S::f32s; B]; A] {
    let lanes = S::F32_LANES;
    let mut sums = [[simd.splat_f32s(0.0); B]; A];
    for y in 0..job.x.rows {
        let (x_row, dy_row) = (y * job.x.stride, y * job.dy.stride);
        let pixels: [&[f32]; B] =
            std::array::from_fn(|b| &job.x.data[taps[b] + x_row..][..job.width.next_multiple_of(lanes)]);
        let gradients: [&[f32]; A] =
            std::array::from_fn(|a| &job.dy.data[starts[a] + dy_row..][..job.width.next_multiple_of(lanes)]);
        for x in (0..job.width).step_by(lanes) {
            let pixels: [S::f32s; B] = std::array::from_fn(|b| vector(simd, &pixels[b][x..x + lanes]));
            for a in 0..A {
                let gradient = vector(simd, &gradients[a][x..x + lanes]);
                for b in 0..B {
                    sums[a][b] = simd.mul_add_e_f32s(gradient, pixels[b], sums[a][b]);
                }
            }
        }
    }
    sums
}

/// A vector from as many numbers.
#[inline(always)]
fn vector<S: Simd>(_: S, numbers: &[f32]) -> S::f32s {
    S::as_simd_f32s(numbers).0[0]
}
