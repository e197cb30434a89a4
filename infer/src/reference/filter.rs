//! The filter of [`crate::filter`] in plain Rust.

use super::pooled;
use crate::Correction;
use crate::filter::{Filter, Tap};
use deepshade_shaders::Planes;

/// The image, `[light channels, height, width]`, of the padded light and of what the last convolution makes
/// of the image's pixels, `[weights, height, width]`.
pub fn filtered(filter: Filter, light: &Planes, made: &Planes) -> Planes {
    let pyramid = pyramid(light, filter.levels);
    let weights = softmax(made);
    Planes::from_fn(light.channels(), made.height(), made.width(), |c, y, x| {
        let read = |Tap { level, offset }| sample(&pyramid[level], level, c, [y, x], offset);
        filter.taps().enumerate().map(|(tap, at)| weights.at(tap, y, x) * read(at)).sum()
    })
}

/// The image, `[channels, height, width]`, of an estimate of that shape, of what its pyramid is of, padded,
/// and of what the last block makes of the image's pixels, `[biases + weights, height, width]`.
pub fn corrected(
    correction: Correction,
    [least, most]: [f32; 2],
    estimate: &Planes,
    over: &Planes,
    made: &Planes,
) -> Planes {
    let pyramid = pyramid(over, correction.levels);
    let channels = estimate.channels();
    let biases = correction.bias_count(channels);
    Planes::from_fn(channels, made.height(), made.width(), |c, y, x| {
        let begun = estimate.at(c, y, x);
        let tap = |(index, Tap { level, offset }): (usize, Tap)| {
            let there = sample(&pyramid[level], level, c, [y, x], offset);
            made.at(biases + index, y, x) * (there - begun)
        };
        let sum: f32 = correction.taps().enumerate().map(tap).sum();
        let added = match correction.gain {
            true => made.at(made.channels() - 1, y, x) * begun,
            false => made.at(c, y, x),
        };
        let difference = |c: usize| (over.at(c, y, x) - estimate.at(c, y, x)).abs();
        let difference = (0..channels).map(difference).fold(0.0, f32::max);
        (begun + correction.gate(difference) * (added + sum)).clamp(least, most)
    })
}

/// The light at full and at further resolutions, each half the one before.
fn pyramid(light: &Planes, levels: usize) -> Vec<Planes> {
    let mut pyramid = vec![light.clone()];
    for level in 1..levels {
        pyramid.push(pooled(&pyramid[level - 1]));
    }
    pyramid
}

/// Softmax over the channels; what is largest is subtracted first, so that no power overflows.
fn softmax(made: &Planes) -> Planes {
    let over = |y, x| (0..made.channels()).map(move |tap| made.at(tap, y, x));
    Planes::from_fn(made.channels(), made.height(), made.width(), |tap, y, x| {
        let largest = over(y, x).fold(f32::NEG_INFINITY, f32::max);
        let sum: f32 = over(y, x).map(|value| (value - largest).exp()).sum();
        (made.at(tap, y, x) - largest).exp() / sum
    })
}

/// A level of the pyramid at a pixel of the image, so many of the level's rows and columns further.
fn sample(image: &Planes, level: usize, channel: usize, at: [usize; 2], offset: [isize; 2]) -> f32 {
    let [(top, bottom, low), (left, right, far)] =
        [0, 1].map(|axis| between(at[axis], level, offset[axis], [image.height(), image.width()][axis]));
    let row = |y| (1.0 - far) * image.at(channel, y, left) + far * image.at(channel, y, right);
    (1.0 - low) * row(top) + low * row(bottom)
}

/// The two pixels of a level's axis between whose centres a pixel of the image lies, moved by some pixels of
/// the level, and the share of the second.
fn between(at: usize, level: usize, offset: isize, size: usize) -> (usize, usize, f32) {
    let position = (at as f32 + 0.5) / (1 << level) as f32 - 0.5;
    let first = position.floor();
    let inside = |index: isize| index.clamp(0, size as isize - 1) as usize;
    let index = first as isize + offset;
    (inside(index), inside(index + 1), position - first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parity::noise;

    const FILTER: Filter = Filter { levels: 3, kernel: 3, black: false };

    /// What a last convolution makes that chooses one tap everywhere.
    fn only(tap: usize, height: usize, width: usize) -> Planes {
        // Far beyond where a power overflows.
        Planes::from_fn(FILTER.weight_count(), height, width, |c, _, _| if c == tap { 1000.0 } else { 0.0 })
    }

    #[test]
    fn a_single_tap_of_full_resolution_moves_the_image() {
        let light = noise(2, 8, 12, 1);
        let [centre, right] = [4, 5].map(|tap| filtered(FILTER, &light, &only(tap, 7, 11)));
        assert_eq!(centre, light.window(0, 0, 7, 11));
        assert_eq!(right, light.window(0, 1, 7, 11));
    }

    #[test]
    fn coarser_levels_are_the_light_where_it_is_a_plane() {
        // Bilinear interpolation of means keeps what is linear, away from the edge.
        let light = Planes::from_fn(1, 32, 32, |_, y, x| (3 * x + 2 * y) as f32);
        for (tap, moved) in [(4, 0.0), (9 + 4, 0.0), (18 + 4, 0.0), (9 + 5, 6.0), (18 + 1, -8.0)] {
            let image = filtered(FILTER, &light, &only(tap, 32, 32));
            for (y, x) in (8..24).flat_map(|y| (8..24).map(move |x| (y, x))) {
                let expected = light.at(0, y, x) + moved;
                assert!((image.at(0, y, x) - expected).abs() < 1e-4, "tap {tap}: {}", image.at(0, y, x));
            }
        }
    }

    #[test]
    fn weights_add_up_to_one() {
        let made = noise(FILTER.tap_count(), 5, 9, 2);
        let image = filtered(FILTER, &Planes::filled(1, 8, 12, 0.75), &made);
        assert!(image.data().iter().all(|value| (value - 0.75).abs() < 1e-6));
        let weights = softmax(&made);
        let logarithm = (weights.at(3, 2, 4) / weights.at(20, 2, 4)).ln();
        assert!((logarithm - (made.at(3, 2, 4) - made.at(20, 2, 4))).abs() < 1e-5);
    }

    #[test]
    fn the_weight_of_black_is_light_that_is_taken_away() {
        let filter = Filter { black: true, ..FILTER };
        let made = noise(filter.weight_count(), 5, 9, 2);
        let image = filtered(filter, &Planes::filled(1, 8, 12, 0.75), &made);
        let weights = softmax(&made);
        for (index, value) in image.data().iter().enumerate() {
            let share = weights.plane(filter.tap_count())[index];
            assert!((value - 0.75 * (1.0 - share)).abs() < 1e-6 && share > 0.001, "{value}, {share}");
        }
    }

    #[test]
    fn beyond_the_edge_is_as_at_the_edge() {
        let light = noise(1, 4, 4, 3);
        let up = filtered(FILTER, &light, &only(1, 4, 4));
        assert_eq!(up.plane(0)[..4], light.plane(0)[..4]);
        assert_eq!(up.plane(0)[4..8], light.plane(0)[..4]);
        // The only pixel of level 2 is the mean, wherever it is read.
        let mean = light.data().iter().sum::<f32>() / 16.0;
        let corner = filtered(FILTER, &light, &only(26, 4, 4));
        assert!(corner.data().iter().all(|value| (value - mean).abs() < 1e-6));
    }
}
