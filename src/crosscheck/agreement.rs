//! Whether two noisy images can be means of the same.
//!
//! Each value has a mean and a variance on either side, both estimated from replicates, so their difference over its
//! error follows Student's t with Welch's degrees of freedom. Turned into a normal deviate, it lies beyond
//! [`BOUND`] with a known probability where the two agree. Where light is so rare that a value's samples met none or
//! little of it, they hardly vary, and its neighbours' variance is taken for its own. A small error everywhere hides in the noise of single
//! values, but not in that of the whole image, which is tested beside.

use deepshade_render::metrics::relative_mse;
use deepshade_render::path::Estimate;
use deepshade_shaders::Planes;
use serde_json::{Value, json};
use std::fmt;

/// Deviates beyond this are outside.
pub const BOUND: f64 = 3.0;

/// The probability of it, for a normal deviate.
pub const EXPECTED_OUTSIDE_SHARE: f64 = 0.0027;

/// The largest share of values outside of the bound that counts as agreement. Values whose noise is far from normal, a
/// few bright paths among many dark ones, make it more than expected by chance.
const LARGEST_OUTSIDE_SHARE: f64 = 0.01;

/// The largest relative difference of the images' means that counts as agreement whatever its deviate.
const LARGEST_MEAN_DIFFERENCE: f64 = 2e-3;

/// The largest deviate of the images' means that counts as agreement whatever its size.
const LARGEST_MEAN_DEVIATE: f64 = 4.0;

/// What two renderers may differ by without noise, relative: f32, ray offsets, interpolation of tables.
const ROUNDING: f64 = 1e-4;

/// Share of their neighbourhood's mean variance below which values are taken to have missed rare light.
const RARE: f32 = 0.25;

/// How many pixels a neighbourhood reaches to each side.
const REACH: usize = 2;

/// How well two estimates of an image agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Share of values beyond [`BOUND`].
    pub outside_share: f64,
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
}

impl Agreement {
    /// Compares two images of the same scene, each with the variance of its values from `replicates` renderings.
    ///
    /// # Panics
    /// If the images differ in shape or one comes without variance.
    pub fn of(ours: &Estimate, theirs: &Estimate, replicates: u32) -> Self {
        let [va, vb] = [ours, theirs].map(|image| image.variance.as_ref().expect("rendered in replicates"));
        let (a, b) = (&ours.mean, &theirs.mean);
        assert!(a.same_shape(b) && a.same_shape(va) && a.same_shape(vb), "images of one scene");
        let [guarded_a, guarded_b] = [va, vb].map(with_rare_light);
        let values = a.data().len();
        let deviate = |i: usize| {
            let at = |image: &Planes| f64::from(image.data()[i]);
            deviate([at(a), at(b)], [at(&guarded_a), at(&guarded_b)], replicates)
        };
        // What is not a number is not inside.
        let inside = (0..values).filter(|i| deviate(*i).abs() <= BOUND).count();
        let noise = |i: usize| {
            let truth = f64::from(b.data()[i]);
            (f64::from(va.data()[i]) + f64::from(vb.data()[i])) / (truth * truth + relative_mse::EPSILON)
        };
        let [mean_difference, mean_deviate] = (0..a.channels())
            .map(|channel| {
                mean_difference([a, b].map(|x| x.plane(channel)), [va, vb].map(|x| x.plane(channel)))
            })
            .max_by(|x, y| x[1].abs().total_cmp(&y[1].abs()))
            .expect("a channel");
        Self {
            outside_share: (values - inside) as f64 / values as f64,
            relative_mse: relative_mse(a, b),
            noise_relative_mse: (0..values).map(noise).sum::<f64>() / values as f64,
            means: [mean(a.data()), mean(b.data())],
            mean_difference,
            mean_deviate,
        }
    }

    /// Whether the two can be means of the same.
    pub fn agrees(&self) -> bool {
        // Each a comparison that what is not a number fails.
        let whole = self.mean_difference.abs() <= LARGEST_MEAN_DIFFERENCE
            || self.mean_deviate.abs() <= LARGEST_MEAN_DEVIATE;
        let lit = self.means.iter().all(|mean| *mean > 0.0);
        self.outside_share <= LARGEST_OUTSIDE_SHARE && whole && lit
    }

    /// The relative mean squared error that noise does not explain; 0 where it explains all.
    pub fn excess_relative_mse(&self) -> f64 {
        (self.relative_mse - self.noise_relative_mse).max(0.0)
    }

    /// Everything, for a command's details.
    pub fn to_json(self) -> Value {
        json!({
            "outside_share": self.outside_share,
            "relmse": self.relative_mse,
            "noise_relmse": self.noise_relative_mse,
            "mean": self.means[0],
            "mean_reference": self.means[1],
            "mean_difference": self.mean_difference,
            "mean_deviate": self.mean_deviate,
            "agrees": self.agrees(),
        })
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "outside {:.2} %  relMSE {:.2e} (noise {:.2e})  means {:.5} {:.5} ({:+.3} %, {:+.1} sigma)",
            100.0 * self.outside_share,
            self.relative_mse,
            self.noise_relative_mse,
            self.means[0],
            self.means[1],
            100.0 * self.mean_difference,
            self.mean_deviate,
        )
    }
}

/// Variances, those that are less than [`RARE`] of their neighbourhood's replaced by that. A variance of 32 replicates
/// without rare light is as small as that by chance in fewer than one of a million.
fn with_rare_light(variance: &Planes) -> Planes {
    let (height, width) = (variance.height(), variance.width());
    Planes::from_fn(variance.channels(), height, width, |channel, y, x| {
        let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
        let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
        let count = rows.len() * columns.len();
        let around = rows.flat_map(|y| columns.clone().map(move |x| (y, x)));
        let mean = around.map(|(y, x)| variance.at(channel, y, x)).sum::<f32>() / count as f32;
        let own = variance.at(channel, y, x);
        if own < RARE * mean { mean } else { own }
    })
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64
}

/// The relative difference of two planes' means, and that difference over its error; pixels are independent.
fn mean_difference([a, b]: [&[f32]; 2], [va, vb]: [&[f32]; 2]) -> [f64; 2] {
    let difference = mean(a) - mean(b);
    let variance = (mean(va) + mean(vb)) / a.len() as f64;
    let scale = mean(b).abs().max(f64::MIN_POSITIVE);
    [difference / scale, difference / (variance + (ROUNDING * scale).powi(2)).sqrt()]
}

/// The difference of two means with variances from `replicates` each, as a normal deviate (Welch 1947; Student's t to
/// normal: Wallace 1959, equation 4.3).
fn deviate([a, b]: [f64; 2], [va, vb]: [f64; 2], replicates: u32) -> f64 {
    let rounding = (ROUNDING * a.abs().max(b.abs())).powi(2) + f64::MIN_POSITIVE;
    let degrees = f64::from(replicates - 1);
    let freedom = ((va + vb).powi(2) / (va * va + vb * vb).max(f64::MIN_POSITIVE)).max(1.0) * degrees;
    let t = (a - b) / (va + vb + rounding).sqrt();
    let size = (freedom * (t * t / freedom).ln_1p()).sqrt() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    size.copysign(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::split_mix::{STEP, finalised};

    const REPLICATES: u32 = 32;
    const VALUES: usize = 6144;

    /// A normal deviate, by the sum of twelve uniform numbers.
    fn normal(seed: u64) -> f64 {
        let uniform = |i: u64| finalised((seed * 12 + i).wrapping_mul(STEP)) as f64 / 2f64.powi(64);
        (0..12).map(uniform).sum::<f64>() - 6.0
    }

    /// An image of values around 0.5 * `scale` of 5 % noise, whose variance is estimated from replicates.
    fn noisy(seed: u64, scale: f64) -> Estimate {
        let mut planes = [0, 1].map(|_| Vec::with_capacity(VALUES));
        for value in 0..VALUES as u64 {
            let first = (seed * VALUES as u64 + value) * u64::from(REPLICATES);
            let draw = |i| scale * (0.5 + 0.025 * f64::from(REPLICATES).sqrt() * normal(first + i));
            let replicates: Vec<f64> = (0..u64::from(REPLICATES)).map(draw).collect();
            let mean = replicates.iter().sum::<f64>() / f64::from(REPLICATES);
            let squares = replicates.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            planes[0].push(mean as f32);
            planes[1].push((squares / f64::from(REPLICATES * (REPLICATES - 1))) as f32);
        }
        let [mean, variance] = planes.map(|values| Planes::from_data(1, 64, 96, values));
        Estimate { mean, variance: Some(variance), samples: REPLICATES }
    }

    #[test]
    fn as_many_values_are_outside_as_chance_has_it() {
        let agreement = Agreement::of(&noisy(1, 1.0), &noisy(2, 1.0), REPLICATES);
        // 16.6 of 6,144 values, with a standard deviation of 4.1.
        let outside = agreement.outside_share * VALUES as f64;
        assert!((outside - EXPECTED_OUTSIDE_SHARE * VALUES as f64).abs() < 3.0 * 4.1, "{outside}");
        assert!(agreement.agrees(), "{agreement}");
        let ratio = agreement.relative_mse / agreement.noise_relative_mse;
        assert!((ratio - 1.0).abs() < 0.06, "noise explains the error: {ratio}");
    }

    #[test]
    fn two_percent_more_light_is_found_in_five_percent_of_noise() {
        let agreement = Agreement::of(&noisy(1, 1.02), &noisy(2, 1.0), REPLICATES);
        assert!(!agreement.agrees(), "{agreement}");
        assert!((agreement.mean_difference - 0.02).abs() < 0.003);
    }

    #[test]
    fn an_error_of_few_values_is_found() {
        let (truth, mut wrong) = (noisy(2, 1.0), noisy(1, 1.0));
        // One row of 64, brighter by eight standard deviations.
        wrong.mean.data_mut()[..96].iter_mut().for_each(|value| *value += 0.2);
        assert!(!Agreement::of(&wrong, &truth, REPLICATES).agrees());
        let mut broken = noisy(1, 1.0);
        broken.mean.data_mut().fill(f32::NAN);
        assert!(!Agreement::of(&broken, &truth, REPLICATES).agrees());
    }

    #[test]
    fn values_without_noise_may_differ_by_rounding_only() {
        let one = |a: f64, b: f64| deviate([a, b], [0.0; 2], REPLICATES).abs() <= BOUND;
        assert!(one(1.0, 1.0) && one(1.0, 1.00005) && one(0.0, 0.0));
        assert!(!one(1.0, 1.001) && !one(0.0, 1e-6));
    }

    #[test]
    fn a_value_that_missed_rare_light_has_its_neighbours_variance() {
        let mut variance = Planes::filled(1, 5, 5, 1.0);
        variance.data_mut()[12] = 0.0;
        variance.data_mut()[0] = 0.5;
        let guarded = with_rare_light(&variance);
        assert!((guarded.at(0, 2, 2) - 23.5 / 25.0).abs() < 1e-6);
        assert_eq!((guarded.at(0, 0, 0), guarded.at(0, 4, 4)), (0.5, 1.0));
    }

    #[test]
    fn deviates_have_the_probabilities_of_their_t() {
        // Two-sided 0.27 % of Student's t: 3.0 without limit of degrees, 3.1667 of 62 (tables).
        let at = |t: f64| deviate([t, 0.0], [0.5, 0.5], REPLICATES);
        assert!((at(3.121) - 3.0).abs() < 0.02, "{}", at(3.121));
        assert!(at(-3.121) < 0.0 && at(3.0) < 3.0);
    }

    #[test]
    fn black_images_agree_with_nothing() {
        let black = Estimate {
            mean: Planes::filled(3, 2, 2, 0.0),
            variance: Some(Planes::filled(3, 2, 2, 0.0)),
            samples: 1,
        };
        assert!(!Agreement::of(&black, &black, REPLICATES).agrees());
    }
}
