//! How far an image is from another: structural similarity, peak signal-to-noise ratio, relative squared
//! error and FLIP.
//!
//! All of them read raw linear values; light is first multiplied by one [`exposure()`] an image. Two images
//! that are compared have one shape, `[channels, height, width]`; comparing images of different shapes is a
//! mistake of the program, not of its input, and panics. A value that is not a number makes the result not a
//! number: it is never hidden.

mod exposure;
pub mod flip;
pub mod psnr;
pub mod relative_mse;
mod ssim;

#[cfg(test)]
mod controls;

pub use exposure::{exposed, exposure};
pub use flip::{flip, flip_map};
pub use psnr::psnr;
pub use relative_mse::relative_mse;
pub use ssim::ssim;

use deepshade_shaders::Planes;

/// Every metric of an image against truth.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Scores {
    /// Structural similarity, 1 where equal; higher is better.
    pub ssim: f64,
    /// Peak signal-to-noise ratio, decibels, [`psnr::MOST`] where equal; higher is better.
    pub psnr: f64,
    /// Mean FLIP, 0 where equal, at most 1; lower is better.
    pub flip: f64,
    /// Relative mean squared error, 0 where equal; lower is better.
    pub relative_mse: f64,
}

impl Scores {
    /// Scores of an image against truth.
    ///
    /// # Panics
    /// If the two differ in shape, or have neither one nor three channels.
    pub fn new(image: &Planes, truth: &Planes) -> Self {
        Self {
            ssim: ssim(image, truth),
            psnr: psnr(image, truth),
            flip: flip(image, truth),
            relative_mse: relative_mse(image, truth),
        }
    }
}

/// Asserts that two images can be compared.
fn assert_same_shape(a: &Planes, b: &Planes) {
    let shape = |image: &Planes| (image.channels(), image.height(), image.width());
    assert_eq!(shape(a), shape(b), "compared images have one [channels, height, width]");
}

/// Mean of a function of two images' values, pixel by pixel; NaN for images without pixels.
fn mean_over_values(a: &Planes, b: &Planes, value: impl Fn(f64, f64) -> f64) -> f64 {
    assert_same_shape(a, b);
    let pairs = a.data().iter().zip(b.data());
    pairs.map(|(a, b)| value(f64::from(*a), f64::from(*b))).sum::<f64>() / a.data().len() as f64
}
