//! Whether two noisy images can be means of the same.
//!
//! Each value has a mean and a variance on either side, both estimated from replicates, so their difference
//! over its error follows Student's t with Welch's degrees of freedom. Turned into a normal deviate, it lies
//! beyond [`BOUND`] with a known probability where the two agree, and the share of values that do may exceed
//! it by no more than chance has it. A small error everywhere hides in the noise of single values, but not in
//! that of the whole image, which is tested too and must be small.

use deepshade_render::metrics::relative_mse;
use deepshade_render::path::Estimate;
use deepshade_shaders::Planes;
use serde_json::{Value, json};
use std::fmt;

/// Deviates beyond this are outside.
pub const BOUND: f64 = 3.0;

/// The probability of it, for a normal deviate.
pub const EXPECTED_OUTSIDE_SHARE: f64 = 0.0027;

/// What counts as chance: so many standard deviations, of the share of values outside and of the images'
/// means.
const CHANCE: f64 = 4.0;

/// The largest standard error of the difference of the images' means that still shows an error of 2 % where
/// errors up to [`CHANCE`] pass; relative.
const LARGEST_MEAN_ERROR: f64 = 4e-3;

/// What two renderers may differ by without noise, relative: f32, ray offsets, interpolation of tables.
const ROUNDING: f64 = 1e-4;

/// How well two estimates of an image agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Share of values beyond [`BOUND`].
    pub outside_share: f64,
    /// The largest that counts as agreement.
    pub outside_limit: f64,
    /// Of ours, theirs being the truth.
    pub relative_mse: f64,
    /// What noise alone would make of it.
    pub noise_relative_mse: f64,
    /// Means over all values, ours and theirs.
    pub means: [f64; 2],
    /// Of ours from theirs, relative, of the colour where it is most significant.
    pub mean_difference: f64,
    /// That difference over its error.
    pub mean_deviate: f64,
    /// Standard error of such a difference, of the colour where it is largest.
    pub mean_error: f64,
}

impl Agreement {
    /// Compares two images of the same scene, each with the variance of its values from `replicates`
    /// renderings.
    ///
    /// # Panics
    /// If the images differ in shape or one comes without variance.
    pub fn of(ours: &Estimate, theirs: &Estimate, replicates: u32) -> Self {
        let variances = [ours, theirs].map(|image| image.variance.as_ref().expect("rendered in replicates"));
        let images = [&ours.mean, &theirs.mean];
        let [a, b] = images;
        assert!(a.same_shape(b) && variances.iter().all(|v| v.same_shape(a)), "images of one scene");
        let colours: Vec<Means> = (0..a.channels())
            .map(|c| Means::of(images.map(|x| x.plane(c)), variances.map(|x| x.plane(c))))
            .collect();
        let worst = colours.iter().max_by(|x, y| x.deviate.abs().total_cmp(&y.deviate.abs()));
        let worst = worst.expect("a channel");
        Self {
            outside_share: outside_share(images, variances, replicates),
            outside_limit: largest_share_by_chance(a.pixels()),
            relative_mse: relative_mse(a, b),
            noise_relative_mse: noise_of_difference(theirs, variances),
            means: images.map(|image| mean(image.data())),
            mean_difference: worst.difference,
            mean_deviate: worst.deviate,
            mean_error: largest(colours.iter().map(|colour| colour.error)),
        }
    }

    /// Whether the two can be means of the same, and are sure enough to tell.
    pub fn agrees(&self) -> bool {
        // Each a comparison that what is not a number fails.
        let whole = self.mean_deviate.abs() <= CHANCE && self.mean_error <= LARGEST_MEAN_ERROR;
        let lit = self.means.iter().all(|mean| *mean > 0.0);
        self.outside_share <= self.outside_limit && whole && lit
    }

    /// The relative mean squared error that noise does not explain; 0 where it explains all.
    pub fn excess_relative_mse(&self) -> f64 {
        let excess = self.relative_mse - self.noise_relative_mse;
        // `max` would drop what is not a number.
        if excess < 0.0 { 0.0 } else { excess }
    }

    /// Everything, for a command's details.
    pub fn to_json(self) -> Value {
        json!({
            "outside_share": self.outside_share,
            "outside_limit": self.outside_limit,
            "relmse": self.relative_mse,
            "noise_relmse": self.noise_relative_mse,
            "mean": self.means[0],
            "mean_reference": self.means[1],
            "mean_difference": self.mean_difference,
            "mean_deviate": self.mean_deviate,
            "mean_error": self.mean_error,
            "agrees": self.agrees(),
        })
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "outside {:.2} % of at most {:.2} %  relMSE {:.1e} (noise {:.1e})  means {:.5} {:.5} ({:+.3} %, \
            {:+.1} sigma; 1 sigma at most {:.3} %)",
            100.0 * self.outside_share,
            100.0 * self.outside_limit,
            self.relative_mse,
            self.noise_relative_mse,
            self.means[0],
            self.means[1],
            100.0 * self.mean_difference,
            self.mean_deviate,
            100.0 * self.mean_error,
        )
    }
}

/// The largest size of some numbers; not a number where one of them is none.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    // In the total order, what is not a number is above all others if its sign is plus.
    values.map(f64::abs).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// The share of values outside that chance has at most, in an image of so many pixels. A pixel's colours are
/// carried by the same paths and count as one value: nothing is known of how much they have in common.
fn largest_share_by_chance(pixels: usize) -> f64 {
    let variance = EXPECTED_OUTSIDE_SHARE * (1.0 - EXPECTED_OUTSIDE_SHARE) / pixels as f64;
    EXPECTED_OUTSIDE_SHARE + CHANCE * variance.sqrt()
}

/// Share of the values of two images whose deviate is beyond [`BOUND`].
fn outside_share([a, b]: [&Planes; 2], [va, vb]: [&Planes; 2], replicates: u32) -> f64 {
    let at = |image: &Planes, i: usize| f64::from(image.data()[i]);
    let deviate = |i| deviate([at(a, i), at(b, i)], [at(va, i), at(vb, i)], replicates);
    let values = a.data().len();
    // What is not a number is not inside.
    let inside = (0..values).filter(|i| deviate(*i).abs() <= BOUND).count();
    (values - inside) as f64 / values as f64
}

/// What noise on both sides makes of a relative mean squared error.
fn noise_of_difference(theirs: &Estimate, [va, vb]: [&Planes; 2]) -> f64 {
    let mut variance = va.clone();
    variance.data_mut().iter_mut().zip(vb.data()).for_each(|(sum, other)| *sum += other);
    let both = Estimate { mean: theirs.mean.clone(), variance: Some(variance), samples: theirs.samples };
    both.noise_relmse(1.0).expect("a variance")
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64
}

/// The means of one colour of two images.
struct Means {
    /// Relative.
    difference: f64,
    /// Standard error of that, relative.
    error: f64,
    /// One over the other, with rounding besides.
    deviate: f64,
}

impl Means {
    /// Of two planes and their variances; pixels are independent.
    fn of([a, b]: [&[f32]; 2], [va, vb]: [&[f32]; 2]) -> Self {
        let scale = mean(b).abs().max(f64::MIN_POSITIVE);
        let difference = (mean(a) - mean(b)) / scale;
        let error = ((mean(va) + mean(vb)) / a.len() as f64).sqrt() / scale;
        Self { difference, error, deviate: difference / error.hypot(ROUNDING) }
    }
}

/// The difference of two means with variances from `replicates` each, as a normal deviate (Welch 1947;
/// Student's t to normal: Wallace 1959, equation 4.3).
fn deviate([a, b]: [f64; 2], [va, vb]: [f64; 2], replicates: u32) -> f64 {
    let rounding = (ROUNDING * a.abs().max(b.abs())).powi(2) + f64::MIN_POSITIVE;
    let degrees = f64::from(replicates - 1);
    let freedom = ((va + vb).powi(2) / (va * va + vb * vb).max(f64::MIN_POSITIVE)).max(1.0) * degrees;
    let t = (a - b) / (va + vb + rounding).sqrt();
    let size = (freedom * (t * t / freedom).ln_1p()).sqrt() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    size.copysign(t)
}

#[cfg(test)]
mod tests;
