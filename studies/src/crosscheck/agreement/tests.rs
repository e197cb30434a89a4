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
}

#[test]
fn what_is_not_a_number_agrees_with_nothing_and_is_not_forgotten() {
    let (truth, mut broken) = (noisy(2, 1.0), noisy(1, 1.0));
    broken.mean.data_mut()[7] = f32::NAN;
    let agreement = Agreement::of(&broken, &truth, REPLICATES);
    assert!(!agreement.agrees() && agreement.excess_relative_mse().is_nan(), "{agreement}");
    assert!(largest([1.0, -f64::NAN, 2.0].into_iter()).is_nan());
    assert_eq!(largest([1.0, 3.0, 2.0].into_iter()), 3.0);
}

#[test]
fn more_values_outside_than_chance_has_it_are_found() {
    let (truth, mut wrong) = (noisy(2, 1.0), noisy(1, 1.0));
    // 30 of 6,144 values besides the 17 of chance: below 1 %, above the 33 that chance has at most.
    wrong.mean.data_mut()[..30].iter_mut().for_each(|value| *value += 0.2);
    let agreement = Agreement::of(&wrong, &truth, REPLICATES);
    assert!((0.0054..0.0095).contains(&agreement.outside_share), "{agreement}");
    assert!(agreement.mean_deviate.abs() < CHANCE && !agreement.agrees(), "{agreement}");
}

#[test]
fn images_too_noisy_to_tell_do_not_agree() {
    let louder = |seed| {
        let mut image = noisy(seed, 1.0);
        let variance = image.variance.as_mut().expect("a variance");
        // 5 % of noise is 0.09 % of the mean's difference; seven times as much is too much.
        variance.data_mut().iter_mut().for_each(|value| *value *= 49.0);
        image
    };
    let agreement = Agreement::of(&louder(1), &louder(2), REPLICATES);
    assert!((agreement.mean_error - 0.0063).abs() < 2e-4, "{agreement}");
    assert!(!agreement.agrees(), "{agreement}");
}

#[test]
fn values_without_noise_may_differ_by_rounding_only() {
    let one = |a: f64, b: f64| deviate([a, b], [0.0; 2], REPLICATES).abs() <= BOUND;
    assert!(one(1.0, 1.0) && one(1.0, 1.00005) && one(0.0, 0.0));
    assert!(!one(1.0, 1.001) && !one(0.0, 1e-6));
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
