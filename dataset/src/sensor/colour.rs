//! Colours of a small camera: noise of photons and of reading them out, and bytes.
//!
//! The linear model of the EMVA Standard 1288: electrons are as many as photons bring, with a Poisson
//! distribution, plus normal noise of the circuit; so many of them are white. The Poisson distribution is
//! taken as the normal one of its variance (Foi, Trimeche, Katkovnik and Egiazarian 2008), which differs
//! where there are few electrons.

use super::normal::gaussian;
use crate::vary::purpose;
use deepshade_shaders::Planes;
use deepshade_shaders::colour::{LINEAR_OF_SRGB, srgb_byte};

/// Electrons of a pixel that is white: those of a webcam's small pixels.
const FULL_WELL: f32 = 5000.0;
/// Standard deviation of reading them out, electrons.
const READ_NOISE: f32 = 8.0;

/// The photograph of some radiance, `[3, height, width]`: radiance of the nearest byte, at most 1, which is
/// white.
pub fn photograph(radiance: &Planes, seed: u32) -> Planes {
    let mut photograph = radiance.clone();
    for (index, value) in photograph.data_mut().iter_mut().enumerate() {
        let noise = gaussian([u64::from(seed), purpose::SENSOR_COLOUR, index as u64], 0);
        *value = read_out(*value, noise);
    }
    photograph
}

/// What is read out of a pixel at a radiance, with noise of deviation 1.
fn read_out(radiance: f32, noise: f32) -> f32 {
    let electrons = radiance.clamp(0.0, 1.0) * FULL_WELL;
    let noisy = electrons + (electrons + READ_NOISE * READ_NOISE).sqrt() * noise;
    LINEAR_OF_SRGB[srgb_byte(noisy / FULL_WELL) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation of a photograph of one radiance.
    fn moments(radiance: f32) -> [f64; 2] {
        let photograph = photograph(&Planes::filled(3, 100, 100, radiance), 7);
        let count = photograph.data().len() as f64;
        let mean = photograph.data().iter().map(|value| f64::from(*value)).sum::<f64>() / count;
        let square = |value: &f32| (f64::from(*value) - mean).powi(2);
        [mean, (photograph.data().iter().map(square).sum::<f64>() / count).sqrt()]
    }

    #[test]
    fn noise_grows_with_the_root_of_light_and_has_no_mean() {
        for radiance in [0.1f32, 0.3, 0.5, 0.8] {
            let electrons = f64::from(radiance * FULL_WELL);
            let expected = (electrons + f64::from(READ_NOISE).powi(2)).sqrt() * f64::from(FULL_WELL).recip();
            let [mean, deviation] = moments(radiance);
            // Four standard errors of the mean of 30,000, and a little for the steps.
            assert!((mean - f64::from(radiance)).abs() < 0.025 * expected + 1e-3, "{radiance}: {mean}");
            assert!((deviation / expected - 1.0).abs() < 0.03, "{radiance}: {deviation}, not {expected}");
        }
    }

    #[test]
    fn values_are_those_of_bytes_up_to_white() {
        let photograph = photograph(&Planes::from_fn(3, 40, 40, |_, y, x| 0.002 * (40 * y + x) as f32), 1);
        for value in photograph.data() {
            assert_eq!(*value, LINEAR_OF_SRGB[srgb_byte(*value) as usize]);
        }
        assert_eq!(read_out(9.0, 0.0), 1.0);
        assert_eq!(read_out(0.0, -1.0), 0.0);
    }

    #[test]
    fn frames_and_channels_have_noise_of_their_own() {
        let grey = Planes::filled(3, 8, 8, 0.5);
        let [first, again, other] = [1, 1, 2].map(|seed| photograph(&grey, seed));
        assert_eq!(first, again);
        assert_ne!(first, other);
        assert_ne!(first.plane(0), first.plane(1));
    }
}
