//! How a picture looks to eyes in the dark, where rods see and cones do not: bluish without other colours,
//! blurred but for strong edges, and noisy. After Thompson, Shirley and Ferwerda 2002, "A Spatial
//! Post-Processing Algorithm for Images of Night Scenes", which the thesis' pictures of phosphorescence have
//! been through (section 8.5); how much of each is up to the viewer.
//!
//! The blur is one of visual angle: what eyes at the camera lose at night. Pictures so small that a pixel is
//! coarser than that have nothing to lose (at 80 rows of 50 degrees the standard deviation is a sixth of a
//! pixel). The blue is that of a bluish grey, at the chromaticity (0.30, 0.30); how blue it is does not
//! depend on how bright.

use crate::scene::Camera;
use deepshade_shaders::Planes;
use deepshade_shaders::colour::luminance;
use deepshade_shaders::random::random;
use glam::{Mat3, Vec3};

/// The colour of what rods alone see (Krawczyk, Myszkowski and Seidel 2005, "Perceptual Effects in Real-Time
/// Tone Mapping", equation 7).
const NIGHT: Vec3 = Vec3::new(1.05, 0.97, 1.27);

/// Standard deviation of the blur, radians: of a grating of 3 cycles a degree, the finest that eyes see at
/// 0.001 cd/m² (Larson, Rushmeier and Piatko 1997, their fit of what Shlaer measured in 1937), it leaves a
/// tenth of the contrast.
const ACUITY: f32 = 0.002;

/// How much wider the second blur is, of whose difference from the first edges are made.
const WIDER: f32 = 1.6;

/// Differences below 1 grow by this root: edges stand out of the blur.
const EDGE_ROOT: f32 = 1.25;

/// XYZ of linear sRGB (IEC 61966-2-1), in columns.
const XYZ_OF_SRGB: Mat3 = Mat3::from_cols(
    Vec3::new(0.412_4, 0.212_6, 0.019_3),
    Vec3::new(0.357_6, 0.715_2, 0.119_2),
    Vec3::new(0.180_5, 0.072_2, 0.950_5),
);

/// How eyes see in the dark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scotopic {
    /// How much of what is seen rods see: 0 is day, 1 is night.
    pub share: f32,
    /// Standard deviation of the blur, pixels.
    pub blur: f32,
    /// Standard deviation of the noise, over white.
    pub noise: f32,
    /// Chooses the noise.
    pub seed: u32,
}

impl Scotopic {
    /// Slight amounts, as the thesis has them, in a camera's picture of so many rows.
    pub fn slight(share: f32, camera: &Camera, height: usize, seed: u32) -> Self {
        Self { share, blur: ACUITY * camera.focal_length(height), noise: 0.012, seed }
    }

    /// A picture, `[3, height, width]` linear values on a screen, as eyes in the dark see it.
    ///
    /// # Panics
    /// If the picture has not three planes.
    #[must_use]
    pub fn seen(&self, picture: &Planes) -> Planes {
        assert_eq!(picture.channels(), 3, "a picture in colour");
        let (height, width) = (picture.height(), picture.width());
        let colour =
            |y: usize, x: usize| Vec3::new(picture.at(0, y, x), picture.at(1, y, x), picture.at(2, y, x));
        let rods = Planes::from_fn(1, height, width, |_, y, x| by_rods(colour(y, x)));
        let [near, far] = [self.blur, WIDER * self.blur].map(|deviation| blurred(&rods, deviation));
        // Rods take blue for far brighter than cones do; eyes adapt, so that nothing outshines the screen.
        let tint = NIGHT / luminance(NIGHT.to_array());
        let brightest = tint.max_element() * near.data().iter().copied().fold(0.0, f32::max);
        let tint = tint / brightest.max(1.0);
        let night = |y: usize, x: usize| {
            let edge = near.at(0, y, x) - far.at(0, y, x);
            let sharpened = far.at(0, y, x) + edge.signum() * edge.abs().min(1.0).powf(1.0 / EDGE_ROOT);
            let value = sharpened + self.noise * self.normal(x, y);
            tint * value.max(0.0)
        };
        let pixels: Vec<Vec3> = (0..height * width)
            .map(|pixel| (pixel / width, pixel % width))
            .map(|(y, x)| colour(y, x).lerp(night(y, x), self.share))
            .collect();
        Planes::from_fn(3, height, width, |c, y, x| pixels[y * width + x][c])
    }

    /// A number of a pixel's own, normally distributed (Box and Muller 1958).
    fn normal(&self, x: usize, y: usize) -> f32 {
        let uniform = |dimension| random(x as u32, y as u32, self.seed, dimension);
        (-2.0 * (1.0 - uniform(0)).ln()).sqrt() * (std::f32::consts::TAU * uniform(1)).cos()
    }
}

/// What rods see of a colour, white being 1 (Larson, Rushmeier and Piatko 1997, section 4.2: scotopic
/// luminance of XYZ).
fn by_rods(colour: Vec3) -> f32 {
    let of = |colour: Vec3| {
        let Vec3 { x, y, z } = XYZ_OF_SRGB * colour;
        if x > 0.0 { (y * (1.33 * (1.0 + (y + z) / x) - 1.68)).max(0.0) } else { 0.0 }
    };
    of(colour.max(Vec3::ZERO)) / of(Vec3::ONE)
}

/// A plane, blurred by a Gaussian of a standard deviation in pixels; edges go on beyond the image.
fn blurred(plane: &Planes, deviation: f32) -> Planes {
    let (height, width) = (plane.height(), plane.width());
    let weights = weights(deviation, height.max(width));
    let reach = (weights.len() / 2) as i64;
    let total: f32 = weights.iter().sum();
    let mean = |value: &dyn Fn(usize) -> f32, at: usize, count: usize| {
        let near = |offset: usize| (at as i64 + offset as i64 - reach).clamp(0, count as i64 - 1) as usize;
        weights.iter().enumerate().map(|(offset, weight)| weight * value(near(offset))).sum::<f32>() / total
    };
    let across = Planes::from_fn(1, height, width, |_, y, x| mean(&|x| plane.at(0, y, x), x, width));
    Planes::from_fn(1, height, width, |_, y, x| mean(&|y| across.at(0, y, x), y, height))
}

/// Weights of a Gaussian, from as far on one side as on the other: to where nothing is left of it, or by
/// `farthest` pixels at most, beyond which an image has nothing.
fn weights(deviation: f32, farthest: usize) -> Vec<f32> {
    let reach = ((3.0 * deviation).ceil() as i64).min(farthest as i64);
    let weight = |at: i64| if deviation > 0.0 { (-0.5 * (at as f32 / deviation).powi(2)).exp() } else { 1.0 };
    (-reach..=reach).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    fn even(colour: Vec3) -> Planes {
        Planes::from_fn(3, 12, 16, |c, _, _| colour[c])
    }

    fn night(share: f32, noise: f32) -> Scotopic {
        Scotopic { share, blur: 1.5, noise, seed: 5 }
    }

    /// Of a grating of 3 cycles a degree a tenth is left, however many pixels the picture has and however
    /// much it shows.
    #[test]
    fn the_blur_is_of_visual_angle() {
        let blur = |degrees: f32, height: usize| {
            let vertical_fov = degrees.to_radians();
            let camera = Camera { vertical_fov, ..Camera::look_at(Vec3::Z, Vec3::ZERO) };
            let pixels_of_a_degree = camera.focal_length(height) * 1f32.to_radians();
            (Scotopic::slight(1.0, &camera, height, 0).blur, pixels_of_a_degree)
        };
        for (degrees, height) in [(50.0, 512), (50.0, 2048), (10.0, 300)] {
            let (deviation, pixels) = blur(degrees, height);
            let period = pixels / 3.0;
            let grating = Planes::from_fn(1, 1, 4001, |_, _, x| (TAU * (x as f32 - 2000.0) / period).cos());
            let left = blurred(&grating, deviation).at(0, 0, 2000);
            assert!((left - 0.1).abs() < 0.02, "{degrees} degrees, {height} rows: {left}");
        }
    }

    /// However little a picture shows, weights are no more than it has pixels to either side.
    #[test]
    fn no_weight_is_beyond_the_image() {
        assert_eq!(
            [0.0, 1.5, 1e6, f32::INFINITY].map(|deviation| weights(deviation, 16).len()),
            [1, 11, 33, 33]
        );
        let blurred = blurred(&Planes::from_fn(1, 12, 16, |_, _, x| f32::from(u8::from(x > 7))), 1e6);
        assert!((blurred.at(0, 6, 7) - 0.5).abs() < 0.05, "{}", blurred.at(0, 6, 7));
    }

    #[test]
    fn by_day_nothing_changes() {
        let picture = Planes::from_fn(3, 12, 16, |c, y, x| (c + y * x) as f32 / 200.0);
        assert_eq!(night(0.0, 0.1).seen(&picture).data(), picture.data());
    }

    #[test]
    fn at_night_grey_turns_blue_and_keeps_its_luminance() {
        let seen = night(1.0, 0.0).seen(&even(Vec3::splat(0.4)));
        let colour = [0, 1, 2].map(|c| seen.at(c, 5, 7));
        assert!((luminance(colour) - 0.4).abs() < 1e-4 && colour[2] > 1.2 * colour[0], "{colour:?}");
    }

    /// The shift that Purkinje saw: of red and blue that are as bright by day, blue is brighter at night.
    #[test]
    fn blue_outshines_red() {
        let bright = |colour: Vec3| {
            let colour = colour * (0.05 / luminance(colour.to_array()));
            night(1.0, 0.0).seen(&even(colour)).at(1, 5, 7)
        };
        assert!(bright(Vec3::Z) > 3.0 * bright(Vec3::X), "{} {}", bright(Vec3::Z), bright(Vec3::X));
    }

    #[test]
    fn nothing_outshines_the_screen() {
        let seen = night(1.0, 0.0).seen(&even(Vec3::new(0.0, 0.5, 1.0)));
        assert!((seen.at(2, 5, 7) - 1.0).abs() < 1e-4 && seen.at(0, 5, 7) < 0.9, "{}", seen.at(2, 5, 7));
    }

    #[test]
    fn detail_goes_and_strong_edges_stay() {
        let stripes = Planes::from_fn(3, 12, 32, |_, _, x| 0.3 + 0.05 * (x % 2) as f32);
        let edge = Planes::from_fn(3, 12, 32, |_, _, x| f32::from(u8::from(x > 15)));
        let step = |picture: &Planes, x: usize| (picture.at(1, 6, x + 1) - picture.at(1, 6, x)).abs();
        let (stripes, edge) = (night(1.0, 0.0).seen(&stripes), night(1.0, 0.0).seen(&edge));
        assert!(
            step(&stripes, 15) < 0.005 && step(&edge, 15) > 0.2,
            "{} {}",
            step(&stripes, 15),
            step(&edge, 15)
        );
    }

    #[test]
    fn noise_is_as_strong_as_asked_and_its_own_in_each_pixel() {
        let seen = night(1.0, 0.05).seen(&Planes::filled(3, 64, 64, 0.5));
        let values: Vec<f32> =
            seen.plane(1).iter().map(|value| value * luminance(NIGHT.to_array()) / NIGHT.y).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let deviation =
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / values.len() as f32).sqrt();
        assert!((mean - 0.5).abs() < 0.004 && (deviation / 0.05 - 1.0).abs() < 0.05, "{mean} {deviation}");
    }
}
