//! What the processor can do at best: the ceilings under which the engine's times are seen.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::hint::black_box;
use web_time::Instant;

/// Numbers that all threads together copy: far more than caches hold.
const COPIED: usize = 1 << 26;
/// Turns of the loop of multiplications with additions.
const TURNS: usize = 1 << 20;
/// Sums side by side: more than an addition takes turns.
const SUMS: usize = 12;
/// Runs, of which the fastest counts.
const RUNS: usize = 3;

/// Bytes a second that a copy on all threads reads and writes, both counted.
pub fn copy() -> f64 {
    let share = COPIED.div_ceil(rayon::current_num_threads());
    let source = vec![1.0f32; COPIED];
    let mut made = vec![0.0f32; COPIED];
    let seconds = fastest(|| {
        made.par_chunks_mut(share)
            .zip(source.par_chunks(share))
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
        for (start, sum) in sums.iter_mut().enumerate() {
            *sum = simd.splat_f32s(start as f32);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_processor_computes_faster_than_it_copies() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let (operations, bytes) = pool.install(|| (multiply_add(), copy()));
        assert!(operations > bytes && bytes > 0.0, "{operations} operations and {bytes} bytes a second");
    }
}
