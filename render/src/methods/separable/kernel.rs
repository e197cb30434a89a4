//! The profile of truth as a separable kernel.
//!
//! The profile `R(r) = (exp(-r / d) + exp(-r / (3 d))) / (8 pi d r)` (Christensen and Burley 2015, equation
//! 2) is no product of a row's and a column's weights. Of those that are, the kernel whose rows are the
//! profile integrated over columns is exact for light that varies along one axis only (the pre-integrated
//! kernel of Jimenez et al. 2015). With `K0(x) = integral over t > 0 of exp(-x cosh t)` that is
//! `(K0(x / d) + K0(x / (3 d))) / (4 pi d)`, and its share beyond `a` on one side, integrated over `x` first,
//! `1 / (4 pi d) * sum over s in {d, 3 d} of the integral over t > 0 of s exp(-a cosh(t) / s) / cosh(t)`.

use super::MOST_TAPS;
use std::f64::consts::PI;

/// The share of the profile beyond a line at a distance in mean free paths: half of it for 0.
pub fn beyond(distance: f64) -> f64 {
    // What is integrated falls faster than any exponential, so that sums in the middles of steps converge as
    // fast.
    const STEP: f64 = 0.1;
    let share = |scale: f64| {
        let at = |i: u32| {
            let cosh = ((f64::from(i) + 0.5) * STEP).cosh();
            scale * (-distance * cosh / scale).exp() / cosh
        };
        (0..240).map(at).sum::<f64>() * STEP
    };
    (share(1.0) + share(3.0)) / (4.0 * PI)
}

/// Taps on one side, the middle first: distance in mean free paths, and the share of the profile between the
/// middles to the taps before and after; the middle's is that of both sides, the last has all that is beyond.
/// `[distance, share, 0, 0]`.
///
/// Distances grow as squares up to `reach`, as the original's do.
pub fn taps(count: usize, reach: f32) -> [[f32; 4]; MOST_TAPS] {
    let count = count.clamp(2, MOST_TAPS);
    let distance = |tap: usize| f64::from(reach) * (tap as f64 / (count - 1) as f64).powi(2);
    let left_beyond = |tap: usize| match tap + 1 {
        next if next < count => beyond(0.5 * (distance(tap) + distance(next))),
        _ => 0.0,
    };
    std::array::from_fn(|tap| match tap {
        0 => [0.0, 1.0 - 2.0 * left_beyond(0) as f32, 0.0, 0.0],
        _ if tap < count => {
            [distance(tap) as f32, (left_beyond(tap - 1) - left_beyond(tap)) as f32, 0.0, 0.0]
        }
        _ => [0.0; 4],
    })
}
