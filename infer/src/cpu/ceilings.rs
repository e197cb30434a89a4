//! What the processor can do at best: the ceilings under which the engine's times are seen.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Numbers that a thread copies at a time: far more than caches hold.
const COPIED: usize = 1 << 24;
/// Turns of the loop of multiplications with additions.
const TURNS: usize = 1 << 20;
/// Sums side by side: more than an addition takes turns.
const SUMS: usize = 12;
/// Runs, of which the fastest counts.
const RUNS: usize = 3;

/// Bytes a second that a copy on all threads reads and writes, both counted.
pub fn copy() -> f64 {
    let threads = rayon::current_num_threads();
    let source = vec![1.0f32; COPIED * threads];
    let mut made = vec![0.0f32; source.len()];
    let seconds = fastest(|| {
        made.par_chunks_mut(COPIED)
            .zip(source.par_chunks(COPIED))
            .for_each(|(made, source)| made.copy_from_slice(source));
        black_box(&made);
    });
    2.0 * size_of_val(source.as_slice()) as f64 / seconds
}

/// Floating-point operations a second in multiplications with additions on all threads, two each.
pub fn multiply_add() -> f64 {
    let threads = rayon::current_num_threads();
    let mut lanes = 0;
    let seconds = fastest(|| {
        lanes = rayon::broadcast(|_| Arch::new().dispatch(Sums))[0];
    });
    (2 * threads * TURNS * SUMS * lanes) as f64 / seconds
}

fn fastest(mut work: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

/// Multiplies and adds in registers, and says in how many lanes.
struct Sums;

impl WithSimd for Sums {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let factor = simd.splat_f32s(black_box(0.999));
        let term = simd.splat_f32s(black_box(0.001));
        let mut sums = [term; SUMS];
        for _ in 0..TURNS {
            for sum in &mut sums {
                *sum = simd.mul_add_e_f32s(*sum, factor, term);
            }
        }
        for sum in sums {
            black_box(simd.reduce_sum_f32s(sum));
        }
        S::F32_LANES
    }
}
