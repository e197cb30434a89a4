//! The vector loops of a convolution: weighted sums over shifted rows.
//!
//! A block of sums stays in registers, of some output channels at some neighbouring pixels; `pulp` chooses
//! the instructions when the program runs. Loops, not `array::from_fn`: its closures would not be compiled
//! for those instructions.

use super::operand::Padded;
use super::shape::ConvShape;
use pulp::Simd;

/// Output channels that are computed together, the largest first.
const BLOCKS: [usize; 5] = [8, 4, 3, 2, 1];

/// Weights in the order in which the loops read them: for each group
/// `[blocks, inputs, kernel, kernel, block]`.
#[derive(Clone, Debug)]
pub struct Packed {
    weights: Vec<f32>,
    /// Weights of a group.
    group: usize,
    /// Output channels of a block.
    block: usize,
}

/// The weights of one group.
#[derive(Clone, Copy, Debug)]
pub struct GroupWeights<'a> {
    weights: &'a [f32],
    block: usize,
}

impl Packed {
    /// From weights `[groups * outputs, inputs, kernel, kernel]`.
    pub fn new(shape: ConvShape, weights: &[f32]) -> Self {
        let block = BLOCKS.into_iter().find(|block| shape.outputs.is_multiple_of(*block)).unwrap_or(1);
        let taps = shape.inputs * shape.kernel * shape.kernel;
        let mut packed = Vec::with_capacity(weights.len());
        for outputs in weights.chunks_exact(block * taps) {
            for tap in 0..taps {
                packed.extend((0..block).map(|output| outputs[output * taps + tap]));
            }
        }
        Self { weights: packed, group: shape.group_weights(), block }
    }

    /// The weights of a group.
    pub fn group(&self, group: usize) -> GroupWeights<'_> {
        GroupWeights { weights: &self.weights[group * self.group..][..self.group], block: self.block }
    }
}

/// Convolves a stripe: bias, weighted sums, leaky ReLU, into one `[rows, width]` an output channel.
#[inline(always)]
pub fn convolve<S: Simd>(
    simd: S,
    x: &Padded<'_>,
    shape: ConvShape,
    weights: GroupWeights<'_>,
    bias: &[f32],
    leak: f32,
    planes: &mut [&mut [f32]],
) {
    let taps = x.taps(shape.inputs, shape.kernel);
    let GroupWeights { weights, block } = weights;
    let blocks = weights.chunks_exact(block * taps.len());
    let outputs = bias.chunks_exact(block).zip(planes.chunks_exact_mut(block));
    for (weights, (bias, planes)) in blocks.zip(outputs) {
        let mut job = Job { x, taps: &taps, weights, bias, leak, width: shape.width, planes };
        // As many sums as registers hold beside the pixels and a weight: 32 of 16 lanes, or 16 of fewer.
        match (block, S::F32_LANES) {
            (8, 16) => job.run::<S, 8, 8, 3>(simd, 0),
            (8, _) => {
                job.run::<S, 8, 4, 3>(simd, 0);
                job.run::<S, 8, 4, 3>(simd, 4);
            }
            (4, 16) => job.run::<S, 4, 4, 4>(simd, 0),
            (4, _) => job.run::<S, 4, 4, 3>(simd, 0),
            (3, _) => job.run::<S, 3, 3, 4>(simd, 0),
            (2, _) => job.run::<S, 2, 2, 4>(simd, 0),
            _ => job.run::<S, 1, 1, 8>(simd, 0),
        }
    }
}

/// A block of output channels of a stripe.
struct Job<'a, 'b> {
    x: &'a Padded<'a>,
    taps: &'a [usize],
    weights: &'a [f32],
    bias: &'a [f32],
    leak: f32,
    width: usize,
    planes: &'a mut [&'b mut [f32]],
}

impl Job<'_, '_> {
    /// Computes `A` of the block's `BLOCK` channels, from `first` on, `B` vectors of pixels at a time where
    /// the rows are that long.
    #[inline(always)]
    fn run<S: Simd, const BLOCK: usize, const A: usize, const B: usize>(&mut self, simd: S, first: usize) {
        for y in 0..self.x.rows {
            let mut x = 0;
            while x < self.width {
                let missing = (self.width - x).div_ceil(S::F32_LANES);
                let vectors = match missing {
                    _ if missing >= B => {
                        self.tile::<S, BLOCK, A, B>(simd, first, y, x);
                        B
                    }
                    3.. if B > 3 => {
                        self.tile::<S, BLOCK, A, 3>(simd, first, y, x);
                        3
                    }
                    2.. => {
                        self.tile::<S, BLOCK, A, 2>(simd, first, y, x);
                        2
                    }
                    _ => {
                        self.tile::<S, BLOCK, A, 1>(simd, first, y, x);
                        1
                    }
                };
                x += vectors * S::F32_LANES;
            }
        }
    }

    /// Computes `B` vectors of pixels of `A` channels.
    #[inline(always)]
    fn tile<S: Simd, const BLOCK: usize, const A: usize, const B: usize>(
        &mut self,
        simd: S,
        first: usize,
        y: usize,
        x: usize,
    ) {
        let at = y * self.x.stride + x;
        let mut sums = [[simd.splat_f32s(0.0); B]; A];
        for (a, sums) in sums.iter_mut().enumerate() {
            *sums = [simd.splat_f32s(self.bias[first + a]); B];
        }
        for (tap, weights) in self.taps.iter().zip(self.weights.as_chunks::<BLOCK>().0) {
            let (pixels, _) = S::as_simd_f32s(&self.x.data[tap + at..][..B * S::F32_LANES]);
            for a in 0..A {
                let weight = simd.splat_f32s(weights[first + a]);
                for b in 0..B {
                    sums[a][b] = simd.mul_add_e_f32s(weight, pixels[b], sums[a][b]);
                }
            }
        }
        // Copied one by one, or else the compiler keeps the sums themselves in memory as well, for the loop
        // below.
        let mut made = [[simd.splat_f32s(0.0); B]; A];
        for a in 0..A {
            for b in 0..B {
                made[a][b] = sums[a][b];
            }
        }
        let end = (x + B * S::F32_LANES).min(self.width);
        for (a, made) in made.iter().enumerate() {
            let row = &mut self.planes[first + a][y * self.width + x..y * self.width + end];
            store(simd, made, self.leak, row);
        }
    }
}

/// Leaky ReLU, then out to memory; the last vector of a row may be cut short.
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
