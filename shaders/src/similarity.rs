//! The numbers of structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004, equation 13), for values of
//! a range of 1, over tiles that do not overlap (thesis 7.3.3): what the metric of `render` and the loss of
//! `train` share.

/// Height and width of a tile, pixels.
pub const TILE: usize = 8;
/// Steadies the comparison of means; `(0.01 * range)^2`.
pub const C1: f64 = 0.01 * 0.01;
/// Steadies the comparison of variances; `(0.03 * range)^2`.
pub const C2: f64 = 0.03 * 0.03;
