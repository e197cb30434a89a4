//! Whether two implementations of the same network agree: the one comparator of the project.

use crate::model::file;
use crate::{Head, ModelError, NetSpec};
use deepshade_shaders::{Planes, random::random};
use std::path::Path;

/// How far elements of an image may be off: so much as these shares of the reference come to together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of its rms, or of 1 if that is greater.
    pub of_rms: f32,
    /// Of its largest magnitude, or of 1 if that is greater.
    pub of_largest: f32,
}

/// What 32-bit floats may do.
pub const TOLERANCE: Tolerance = Tolerance { of_rms: 1e-4, of_largest: 0.0 };

impl Tolerance {
    /// The largest difference that a reference allows.
    fn of(self, reference: &Planes) -> f32 {
        self.of_rms * rms(reference).max(1.0) + self.of_largest * largest(reference).max(1.0)
    }
}

/// What a layer made: its image after the activation, `[outputs, height, width]` of its level of the padded
/// frame. The last layer's image is cropped to the size of the network's input.
#[derive(Clone, Debug, PartialEq)]
pub struct Activation {
    /// Name of the layer.
    pub layer: String,
    /// Its image.
    pub planes: Planes,
}

/// How far an image is from a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Largest absolute difference of two elements; infinite where the shapes differ or a number is not
    /// finite.
    pub max_abs: f32,
    /// Largest difference allowed: by [`TOLERANCE`] where nothing else is stated.
    pub tolerance: f32,
}

impl Comparison {
    /// Compares `image` with `reference` element by element.
    pub fn new(reference: &Planes, image: &Planes) -> Self {
        Self::within(reference, image, TOLERANCE)
    }

    /// As [`Comparison::new`], with another tolerance.
    pub fn within(reference: &Planes, image: &Planes, tolerance: Tolerance) -> Self {
        let difference =
            |(a, b): (&f32, &f32)| if (a - b).is_finite() { (a - b).abs() } else { f32::INFINITY };
        let max_abs = if reference.same_shape(image) {
            reference.data().iter().zip(image.data()).map(difference).fold(0.0, f32::max)
        } else {
            f32::INFINITY
        };
        Self { max_abs, tolerance: tolerance.of(reference) }
    }

    /// Whether the difference is within the tolerance.
    pub fn agrees(&self) -> bool {
        self.max_abs <= self.tolerance
    }
}

/// The first layer whose image is not within the tolerance of the reference's, with how far it is off. Layers
/// are matched by their position and their name.
pub fn first_difference(reference: &[Activation], made: &[Activation]) -> Option<(String, Comparison)> {
    first_difference_within(reference, made, TOLERANCE)
}

/// As [`first_difference`], with another tolerance.
pub fn first_difference_within(
    reference: &[Activation],
    made: &[Activation],
    tolerance: Tolerance,
) -> Option<(String, Comparison)> {
    let missing = Activation { layer: String::new(), planes: Planes::filled(0, 0, 0, 0.0) };
    reference.iter().enumerate().find_map(|(index, reference)| {
        let made = made.get(index).filter(|made| made.layer == reference.layer).unwrap_or(&missing);
        let comparison = Comparison::within(&reference.planes, &made.planes, tolerance);
        (!comparison.agrees()).then(|| (reference.layer.clone(), comparison))
    })
}

/// Root of the mean square of all elements.
pub fn rms(image: &Planes) -> f32 {
    let sum: f64 = image.data().iter().map(|value| f64::from(*value).powi(2)).sum();
    (sum / image.data().len().max(1) as f64).sqrt() as f32
}

/// Largest magnitude of all elements.
pub(crate) fn largest(image: &Planes) -> f32 {
    image.data().iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// Random numbers, evenly distributed in [-sqrt(3), sqrt(3)) and so of rms 1: an input for comparisons.
pub fn noise(channels: usize, height: usize, width: usize, seed: u32) -> Planes {
    Planes::from_fn(channels, height, width, |c, y, x| {
        (2.0 * random(x as u32, y as u32, seed, c as u32) - 1.0) * 3f32.sqrt()
    })
}

/// Noise that a network may be given, `[input channels, height, width]`: estimates lie within the effect's
/// range, as methods make them. The correction cuts its image to that range, so that errors would else be
/// held against an image smaller than what was added up.
pub fn noise_for(spec: &NetSpec, [height, width]: [usize; 2], seed: u32) -> Planes {
    let mut noise = noise(spec.input_channels(), height, width, seed);
    if let Head::Correction(correction) = spec.head {
        let [least, most] = spec.effect.range();
        let spread = if most.is_finite() { (most - least) / (2.0 * 3f32.sqrt()) } else { 1.0 };
        let mut channels = [correction.of, correction.over].map(|read| spec.channels_of(read)).concat();
        channels.sort_unstable();
        channels.dedup();
        for channel in channels {
            let plane = &mut noise.data_mut()[channel * height * width..][..height * width];
            plane.iter_mut().for_each(|value| *value = least + spread * (*value + 3f32.sqrt()));
        }
    }
    noise
}

/// An input of a trained network and what the network made of it when it was exported: `parity.safetensors`.
#[derive(Clone, Debug, PartialEq)]
pub struct Parity {
    /// `[input channels, height, width]`.
    pub input: Planes,
    /// `[output channels, height, width]`.
    pub output: Planes,
}

impl Parity {
    /// Reads it from the model folder of a network.
    ///
    /// # Errors
    /// If the file cannot be read, or does not hold an input and an image of that network, both of the same
    /// height and width.
    pub fn load(folder: &Path, spec: &NetSpec) -> Result<Self, ModelError> {
        let tensors = file::Tensors::open(&folder.join(file::PARITY), file::MOST_PARITY_BYTES)?;
        let parity = Self { input: tensors.image("input")?, output: tensors.image("output")? };
        let [height, width] = [parity.input.height().max(1), parity.input.width().max(1)];
        for (name, image, channels) in [
            ("input", &parity.input, spec.input_channels()),
            ("output", &parity.output, spec.output_channels()),
        ] {
            let expected = vec![channels, height, width];
            let found = vec![image.channels(), image.height(), image.width()];
            if found != expected {
                return Err(tensors.shape_error(name, expected, found));
            }
        }
        Ok(parity)
    }

    /// Writes it into a model folder, which is made where there is none.
    ///
    /// # Errors
    /// If the file cannot be written; then an older one is still whole.
    pub fn save(&self, folder: &Path) -> Result<(), ModelError> {
        let shape = |planes: &Planes| vec![planes.channels(), planes.height(), planes.width()];
        let tensors = [
            ("input".to_owned(), shape(&self.input), self.input.data()),
            ("output".to_owned(), shape(&self.output), self.output.data()),
        ];
        file::write_tensors(&folder.join(file::PARITY), &tensors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticEstimate, ChannelOrder, Correction, Reach};
    use deepshade_shaders::{Attribute, Effect};

    fn spec() -> NetSpec {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        NetSpec::ao(ChannelOrder::Interleaved, reach)
    }

    fn image() -> Planes {
        noise(4, 13, 11, 1)
    }

    #[test]
    fn equal_and_nearly_equal_images_agree() {
        let image = image();
        let mut near = image.clone();
        near.data_mut()[7] += 5e-5;
        assert!(Comparison::new(&image, &image).agrees());
        assert!(Comparison::new(&image, &near).agrees());
    }

    #[test]
    fn every_wrong_image_is_rejected() {
        let image = image();
        let (height, width) = (image.height(), image.width());
        let made = |value: &dyn Fn(usize, usize, usize) -> f32| Planes::from_fn(4, height, width, value);
        let mut lone = image.clone();
        lone.data_mut()[300] += 1e-3;
        let mut poisoned = image.clone();
        poisoned.data_mut()[300] = f32::NAN;
        let wrong = [
            ("flipped along x", made(&|c, y, x| image.at(c, y, width - 1 - x))),
            ("flipped along y", made(&|c, y, x| image.at(c, height - 1 - y, x))),
            ("shifted by a pixel", made(&|c, y, x| image.at(c, y, (x + 1) % width))),
            ("shifted by a row", made(&|c, y, x| image.at(c, (y + 1) % height, x))),
            ("scaled by 1 %", made(&|c, y, x| 1.01 * image.at(c, y, x))),
            ("two channels swapped", made(&|c, y, x| image.at([1, 0, 2, 3][c], y, x))),
            ("two groups permuted", made(&|c, y, x| image.at([2, 3, 0, 1][c], y, x))),
            ("one element off", lone),
            ("not a number", poisoned),
            ("smaller", image.window(0, 0, height - 1, width)),
        ];
        for (what, wrong) in wrong {
            assert!(!Comparison::new(&image, &wrong).agrees(), "{what}");
        }
    }

    #[test]
    fn a_share_of_the_largest_element_is_allowed_and_no_more() {
        let image = Planes::from_data(1, 1, 3, vec![0.5, -8.0, 2.0]);
        let tolerance = Tolerance { of_rms: 0.0, of_largest: 1e-3 };
        let off = |by: f32| Planes::from_data(1, 1, 3, vec![0.5 + by, -8.0, 2.0]);
        assert!(Comparison::within(&image, &off(7.9e-3), tolerance).agrees());
        assert!(!Comparison::within(&image, &off(8.1e-3), tolerance).agrees());
        let dim = Planes::filled(1, 1, 3, 0.01);
        let near = Planes::filled(1, 1, 3, 0.0109);
        assert!(Comparison::within(&dim, &near, tolerance).agrees(), "of 1 at least");
    }

    #[test]
    fn noise_for_light_that_is_its_own_pyramid_reaches_down_to_black() {
        let openness = AnalyticEstimate::new("gtao", "low").of(Effect::Ao);
        let estimates = [AnalyticEstimate::new("surfel", "low"), openness];
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::corrected(Effect::Gi, 8, estimates.to_vec(), reach).expect("it has one");
        let made = noise_for(&spec, [64, 48], 2);
        for channel in spec.channels_of(Attribute::Estimate) {
            let least = made.plane(channel).iter().copied().reduce(f32::min);
            assert!(least >= Some(0.0) && least < Some(0.05), "{least:?}");
        }
    }

    #[test]
    fn noise_for_a_correction_has_estimates_within_the_range() {
        let (of, over) = (Attribute::Openness, Attribute::RawOpenness);
        let correction = Correction { of, over, levels: 2, kernel: 3, gain: false, gated: false };
        let inputs = vec![Attribute::Normal, of, over];
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::correcting(Effect::Ao, inputs, Vec::new(), correction, 8, reach);
        let made = noise_for(&spec, [16, 24], 2);
        assert!(made.plane(0).iter().any(|value| *value < 0.0), "a normal's component");
        for channel in [3, 4] {
            let plane = made.plane(channel);
            let [least, most] = [f32::min, f32::max].map(|of| plane.iter().copied().reduce(of));
            assert!(least >= Some(0.0) && least < Some(0.05), "{least:?}");
            assert!(most <= Some(1.0) && most > Some(0.95), "{most:?}");
        }
    }

    #[test]
    fn two_poisoned_images_do_not_agree() {
        let poisoned = Planes::filled(1, 2, 2, f32::NAN);
        assert!(!Comparison::new(&poisoned, &poisoned).agrees());
    }

    #[test]
    fn the_first_layer_that_differs_is_named() {
        let layer = |name: &str, seed| Activation { layer: name.to_owned(), planes: noise(1, 4, 4, seed) };
        let reference = [layer("down0", 1), layer("down1", 2), layer("up0", 3)];
        assert_eq!(first_difference(&reference, &reference), None);
        let wrong = [layer("down0", 1), layer("down1", 9), layer("up0", 9)];
        assert_eq!(first_difference(&reference, &wrong).map(|(name, _)| name), Some("down1".to_owned()));
        let short = first_difference(&reference, &reference[..2]);
        assert_eq!(short.map(|(name, _)| name), Some("up0".to_owned()));
    }

    #[test]
    fn a_written_parity_file_reads_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let parity = Parity { input: noise(6, 5, 7, 1), output: noise(1, 5, 7, 2) };
        parity.save(folder.path()).expect("writes");
        assert_eq!(Parity::load(folder.path(), &spec()).expect("reads"), parity);
    }

    #[test]
    fn images_of_another_network_are_refused_by_name() {
        let cases = [
            ([5, 5, 7], [1, 5, 7], "`input` has shape [5, 5, 7], expected [6, 5, 7]"),
            ([6, 5, 7], [2, 5, 7], "`output` has shape [2, 5, 7], expected [1, 5, 7]"),
            ([6, 5, 7], [1, 5, 8], "`output` has shape [1, 5, 8], expected [1, 5, 7]"),
            ([6, 0, 7], [1, 0, 7], "`input` has shape [6, 0, 7], expected [6, 1, 7]"),
        ];
        for (input, output, expected) in cases {
            let folder = tempfile::tempdir().expect("a folder");
            let image = |[channels, height, width]: [usize; 3]| noise(channels, height, width, 1);
            Parity { input: image(input), output: image(output) }.save(folder.path()).expect("writes");
            let error = Parity::load(folder.path(), &spec()).expect_err(expected).to_string();
            assert!(error.contains("parity.safetensors") && error.contains(expected), "{error}");
        }
    }
}
