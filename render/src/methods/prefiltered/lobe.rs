//! What a map convolved with a whole lobe does not know: that reflected light is weighed by its cosine to the
//! normal and comes from above the surface only.
//!
//! Phong's lobe around the mirrored direction `m`, times the cosine, cut off at the horizon, is replaced by
//! another whole lobe of the same integral, the same mean direction and the same spread: a lobe `cos^e` has
//! the mean `(e + 1) / (e + 2)` along its axis. The three depend on the exponent and on the angle between `m`
//! and the normal `n`, and lie in a table. Seen straight from above, `cos^e` times the cosine is
//! `cos^(e + 1)`, and the lobe exact.

use super::filter::LEVELS;
use glam::{DVec2, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Rows of the table: exponents `2^(row / 2) - 1`, up to that of the smoothest surface.
pub const EXPONENTS: usize = 26;

/// Columns of the table: the cosine between mirrored direction and normal is `(column / (ANGLES - 1))^2`.
pub const ANGLES: usize = 32;

/// Steps of the integration.
const STEPS: usize = 512;

/// The table, row by row: energy, lean and level of each lobe.
pub fn table() -> &'static [Vec3] {
    static TABLE: LazyLock<Vec<Vec3>> = LazyLock::new(|| {
        let entry = |i: usize| {
            let exponent = (0.5 * (i / ANGLES) as f64).exp2() - 1.0;
            let cosine = ((i % ANGLES) as f64 / (ANGLES - 1) as f64).powi(2);
            replacement(exponent, cosine)
        };
        (0..EXPONENTS * ANGLES).map(entry).collect()
    });
    &TABLE
}

/// The lobe that replaces the one of an exponent around a direction at an angle to the normal: how much of
/// uniform light it reflects, how far its axis leans from the mirrored direction, 0, to the normal, 1, on the
/// straight line between the two, and the binary logarithm of its exponent.
fn replacement(exponent: f64, cosine: f64) -> Vec3 {
    // In the normal's own direction nothing leans; slightly beside it the lean has its limit.
    let cosine = cosine.min(0.9999);
    let sine = (1.0 - cosine * cosine).sqrt();
    let mut integral = 0.0;
    let mut moment = DVec2::ZERO;
    for step in 0..STEPS {
        // Evenly in the lobe's own weight, cos^e sin dt = -d cos^(e + 1) / (e + 1).
        let cos = ((step as f64 + 0.5) / STEPS as f64).powf(1.0 / (exponent + 1.0));
        let sin = (1.0 - cos * cos).sqrt();
        let [whole, across] = around(cosine * cos, sine * sin);
        integral += whole;
        moment += DVec2::new(cos * whole, sin * across);
    }
    let mean = moment / integral;
    let length = mean.length().min(1.0 - 1e-9);
    // mean = along * m + beside * n, where the normal is (cosine, sine).
    let beside = mean.y / sine;
    let along = mean.x - beside * cosine;
    let level = ((2.0 * length - 1.0) / (1.0 - length)).max(1.0).log2().min((LEVELS - 1) as f64);
    let energy = (exponent + 2.0) / (exponent + 1.0) * integral / (TAU * STEPS as f64);
    Vec3::new(energy as f32, (beside / (along + beside)) as f32, level as f32)
}

/// The integrals over the angle `p` around the lobe's axis of the cosine to the normal, `a + b cos p` where
/// that is positive, and of it times `cos p`.
fn around(a: f64, b: f64) -> [f64; 2] {
    if a >= b {
        return [TAU * a, PI * b];
    }
    let horizon = (-a / b).acos();
    let (sin, cos) = horizon.sin_cos();
    [2.0 * (a * horizon + b * sin), 2.0 * a * sin + b * (horizon + sin * cos)]
}
