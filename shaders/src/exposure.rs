//! By how much light is scaled so that a dim scene is to a network, and to those who compare images, what a
//! bright one is.

use crate::{Effect, Planes};

/// Share of the positive values that do not exceed 1 when light is exposed: lights and their reflections may.
const WITHIN: f64 = 0.99;

/// Largest factor: light that is darker is as good as black, and what is brighter in the same image stays
/// finite.
const MOST: f32 = 1e18;

/// The factor, at most 1e18, by which 99 % of the positive finite values of an image come to at most 1; 1 if
/// there is none.
pub fn of_values(values: impl Iterator<Item = f32>) -> f32 {
    let mut lit: Vec<f32> = values.filter(|value| *value > 0.0 && value.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let index = ((lit.len() - 1) as f64 * WITHIN) as usize;
    let (_, bright, _) = lit.select_nth_unstable_by(index, f32::total_cmp);
    (1.0 / *bright).min(MOST)
}

/// The factor that an image of an effect and its truth, `[channels, height, width]`, are multiplied by before
/// they are compared or looked at: 1 for shares of a hemisphere; for light [that of truth's
/// values](of_values).
pub fn of_image(effect: Effect, truth: &Planes) -> f32 {
    if effect == Effect::Ao { 1.0 } else { of_values(truth.data().iter().copied()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_bright_comes_to_one_and_darkness_stays() {
        let ramp = |scale: f32| (0..=1000).map(move |i| scale * i as f32);
        assert!((of_values(ramp(1.0)) * 990.0 - 1.0).abs() < 2e-3);
        assert!((of_values(ramp(0.02)) * 0.02 / of_values(ramp(1.0)) - 1.0).abs() < 1e-5);
        assert_eq!(of_values([0.0, -3.0, f32::NAN, f32::INFINITY].into_iter()), 1.0);
        assert_eq!(of_values([0.0, 0.25, f32::NAN].into_iter()), 4.0);
        assert_eq!(of_values([f32::from_bits(1)].into_iter()), MOST);
    }
}
