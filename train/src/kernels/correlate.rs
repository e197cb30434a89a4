//! The vector loops of a convolution's gradient by its weights: products of shifted rows.
//!
//! A block of sums stays in registers, of some output channels and some weights. Loops, not `array::from_fn`:
//! its closures would not be compiled for the instructions that `pulp` chooses.

use deepshade_infer::cpu::operand::Padded;
use deepshade_infer::cpu::shape::ConvShape;
use pulp::Simd;

/// What a stripe adds to the gradients of its group.
pub struct Share {
    /// `[outputs, inputs, kernel, kernel]`.
    pub weight: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// What the rows of `x` add, given the gradients `dy`, whose rows begin `before` rows earlier.
#[inline(always)]
pub fn share<S: Simd>(simd: S, shape: ConvShape, x: &Padded<'_>, dy: &Padded<'_>, before: usize) -> Share {
    let taps = x.taps(shape.inputs, shape.kernel);
    let half = shape.kernel / 2;
    let plane = (dy.rows + 2 * half) * dy.stride;
    let first = (half + before) * dy.stride + half;
    let starts: Vec<usize> = (0..shape.outputs).map(|output| output * plane + first).collect();
    let job = Job { x, dy, taps: &taps, starts: &starts, width: shape.width };
    let row = |start: usize, y: usize| row_sum(&dy.data[start + y * dy.stride..][..shape.width]);
    let bias = starts.iter().map(|start| (0..x.rows).map(|y| row(*start, y)).sum()).collect();
    let outputs = shape.outputs;
    let weight = match S::F32_LANES {
        16 if outputs.is_multiple_of(8) => job.sums::<S, 8, 3>(simd),
        _ if outputs.is_multiple_of(4) => job.sums::<S, 4, 3>(simd),
        _ if outputs.is_multiple_of(3) => job.sums::<S, 3, 4>(simd),
        _ => job.sums::<S, 1, 9>(simd),
    };
    Share { weight, bias }
}

/// The sum of a row, as eight sums side by side so that no addition waits for the one before.
#[inline(always)]
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

struct Job<'a> {
    x: &'a Padded<'a>,
    dy: &'a Padded<'a>,
    taps: &'a [usize],
    starts: &'a [usize],
    width: usize,
}

impl Job<'_> {
    /// For each output channel the sums for each weight, `A` channels and `B` weights at a time.
    #[inline(always)]
    fn sums<S: Simd, const A: usize, const B: usize>(&self, simd: S) -> Vec<f32> {
        let count = self.taps.len();
        let mut made = vec![0.0; self.starts.len() * count];
        for (starts, sums) in self.starts.chunks_exact(A).zip(made.chunks_exact_mut(A * count)) {
            for first in (0..count).step_by(B) {
                // The last block may name a weight more than once; its sum is the same each time.
                let mut taps = [0; B];
                for (b, tap) in taps.iter_mut().enumerate() {
                    *tap = self.taps[(first + b).min(count - 1)];
                }
                let block = self.products::<S, A, B>(simd, starts, taps);
                for b in 0..B {
                    for a in 0..A {
                        // Past the last weight the last one's sum is written again.
                        sums[a * count + (first + b).min(count - 1)] = simd.reduce_sum_f32s(block[a][b]);
                    }
                }
            }
        }
        made
    }

    /// Sums over the stripe of `A` gradients times the pixels under `B` weights.
    #[inline(always)]
    fn products<S: Simd, const A: usize, const B: usize>(
        &self,
        simd: S,
        starts: &[usize],
        taps: [usize; B],
    ) -> [[S::f32s; B]; A] {
        let mut sums = [[simd.splat_f32s(0.0); B]; A];
        for y in 0..self.x.rows {
            let mut pixels: [&[S::f32s]; B] = [&[]; B];
            for b in 0..B {
                pixels[b] = self.row::<S>(self.x, taps[b], y);
            }
            let mut gradients: [&[S::f32s]; A] = [&[]; A];
            for a in 0..A {
                gradients[a] = self.row::<S>(self.dy, starts[a], y);
            }
            for x in 0..self.width.div_ceil(S::F32_LANES) {
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

    /// A row from where it begins in row 0, as vectors, the last of which may reach into the border.
    #[inline(always)]
    fn row<'a, S: Simd>(&self, of: &Padded<'a>, start: usize, y: usize) -> &'a [S::f32s] {
        let numbers = &of.data[start + y * of.stride..][..self.width.next_multiple_of(S::F32_LANES)];
        S::as_simd_f32s(numbers).0
    }
}
