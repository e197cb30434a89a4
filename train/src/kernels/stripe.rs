//! The vector loops of a convolution: weighted sums over shifted rows, and products of shifted rows.
//!
//! Both keep a block of sums in registers: of some output channels at some neighbouring pixels, or of some output
//! channels and some weights. `pulp` chooses the instructions when the program runs. Loops, not `array::from_fn`:
//! its closures would not be compiled for those instructions.

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
        (0..dy.rows).map(|y| row_sum(&dy.data[start + y * dy.stride..][..shape.width])).sum()
    };
    centres(dy, shape).into_iter().map(sum).collect()
}

/// The sum of a row, as eight sums side by side so that no addition waits for the one before.
fn row_sum(row: &[f32]) -> f32 {
    let (eights, rest) = row.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for eight in eights {
        for (sum, number) in sums.iter_mut().zip(eight) {
            *sum += number;
        }
    }
    sums.iter().chain(rest).sum()
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
            let mut bias = [[simd.splat_f32s(0.0); B]; A];
            for (a, bias) in bias.iter_mut().enumerate() {
                *bias = [simd.splat_f32s(job.bias[block * A + a]); B];
            }
            for y in 0..job.x.rows {
                for x in (0..job.width).step_by(tile) {
                    let at = y * job.x.stride + x;
                    let mut sums = bias;
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
    let mut sums = [[simd.splat_f32s(0.0); B]; A];
    for y in 0..job.x.rows {
        let (x_row, dy_row) = (y * job.x.stride, y * job.dy.stride);
        let mut pixels: [&[S::f32s]; B] = [&[]; B];
        for b in 0..B {
            pixels[b] = vectors(simd, &job.x.data[taps[b] + x_row..], job.width);
        }
        let mut gradients: [&[S::f32s]; A] = [&[]; A];
        for a in 0..A {
            gradients[a] = vectors(simd, &job.dy.data[starts[a] + dy_row..], job.width);
        }
        for x in 0..job.width.div_ceil(S::F32_LANES) {
            let mut under = [simd.splat_f32s(0.0); B];
            for b in 0..B {
                under[b] = pixels[b][x];
            }
            for a in 0..A {
                let gradient = gradients[a][x];
                for b in 0..B {
                    sums[a][b] = simd.mul_add_e_f32s(gradient, under[b], sums[a][b]);
                }
            }
        }
    }
    sums
}

/// The first `width` numbers as vectors, the last of which may reach beyond.
#[inline(always)]
fn vectors<S: Simd>(_: S, numbers: &[f32], width: usize) -> &[S::f32s] {
    S::as_simd_f32s(&numbers[..width.next_multiple_of(S::F32_LANES)]).0
}

/// The gradient before a leaky ReLU that made `y`, from the gradient `dy` after it.
pub fn leaky_backward(y: &[f32], dy: &[f32], leak: f32, out: &mut [f32]) {
    Arch::new().dispatch(LeakyBackward { y, dy, leak, out });
}

struct LeakyBackward<'a> {
    y: &'a [f32],
    dy: &'a [f32],
    leak: f32,
    out: &'a mut [f32],
}

impl WithSimd for LeakyBackward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (y, y_rest) = S::as_simd_f32s(self.y);
        let (dy, dy_rest) = S::as_simd_f32s(self.dy);
        let (out, out_rest) = S::as_mut_simd_f32s(self.out);
        let leak = simd.splat_f32s(self.leak);
        for ((out, y), dy) in out.iter_mut().zip(y).zip(dy) {
            let positive = simd.greater_than_f32s(*y, simd.splat_f32s(0.0));
            *out = simd.select_f32s(positive, *dy, simd.mul_f32s(*dy, leak));
        }
        for ((out, y), dy) in out_rest.iter_mut().zip(y_rest).zip(dy_rest) {
            *out = if *y > 0.0 { *dy } else { self.leak * dy };
        }
    }
}
