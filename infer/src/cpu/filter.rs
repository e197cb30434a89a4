//! The filter of [`crate::filter`] on the processor: rows in parallel, every tap's row of light blended from two rows of its
//! level and then from neighbouring pixels.

use crate::NetSpec;
use crate::filter::Filter;
use deepshade_shaders::Planes;
use rayon::prelude::*;

/// The light of an image at a resolution.
struct Level {
    /// Pixels of the image along an axis for one of the level.
    scale: usize,
    light: Planes,
}

/// The network's image of its input, given what its last convolution makes of the image's pixels, `[taps, height, width]`.
pub fn filtered(spec: &NetSpec, filter: Filter, input: &Planes, made: &Planes) -> Planes {
    let (height, width) = (made.height(), made.width());
    let levels = pyramid(padded(&spec.light(input), spec.alignment()), filter.levels);
    let channels = spec.output_channels();
    let rows = (0..height).into_par_iter().map(|y| row(filter, &levels, made, y));
    let rows: Vec<Vec<f32>> = rows.collect();
    let data = (0..channels).flat_map(|c| rows.iter().flat_map(move |row| &row[c * width..][..width]));
    Planes::from_data(channels, height, width, data.copied().collect())
}

/// The light continued by its last row and column.
fn padded(light: &Planes, alignment: usize) -> Planes {
    let [height, width] = [light.height(), light.width()].map(|size| size.next_multiple_of(alignment));
    let mut data = Vec::with_capacity(light.channels() * height * width);
    for (channel, y) in (0..light.channels()).flat_map(|c| (0..height).map(move |y| (c, y))) {
        let row = &light.plane(channel)[y.min(light.height() - 1) * light.width()..][..light.width()];
        data.extend_from_slice(row);
        data.extend(std::iter::repeat_n(row[row.len() - 1], width - row.len()));
    }
    Planes::from_data(light.channels(), height, width, data)
}

fn pyramid(light: Planes, count: usize) -> Vec<Level> {
    let mut levels = vec![Level { scale: 1, light }];
    for level in 1..count {
        let finer = &levels[level - 1];
        levels.push(Level { scale: 2 * finer.scale, light: halved(&finer.light) });
    }
    levels
}

/// Means of 2x2 pixels.
fn halved(image: &Planes) -> Planes {
    let (height, width) = (image.height() / 2, image.width() / 2);
    let mut data = Vec::with_capacity(image.channels() * height * width);
    for rows in image.data().chunks_exact(2 * image.width()) {
        let (upper, lower) = rows.split_at(image.width());
        let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        data.extend(pairs.map(|(a, b)| 0.25 * (a[0] + a[1] + b[0] + b[1])));
    }
    Planes::from_data(image.channels(), height, width, data)
}

/// A row of the image, `[channels, width]`.
fn row(filter: Filter, levels: &[Level], made: &Planes, y: usize) -> Vec<f32> {
    let width = made.width();
    let weights = softmax(made, y);
    let mut image = vec![0.0; levels[0].light.channels() * width];
    let mut kernels = weights.chunks_exact(filter.kernel * width);
    for level in levels {
        let places = places(level, width);
        for offset in 0..filter.kernel {
            let Some(weights) = kernels.next() else { return image };
            for (channel, image) in image.chunks_exact_mut(width).enumerate() {
                let light = blended(level, channel, filter.kernel / 2, y, offset);
                for (shift, weights) in weights.chunks_exact(width).enumerate() {
                    add(image, weights, &places, &light[shift..]);
                }
            }
        }
    }
    image
}

/// Where the pixels of a row of the image lie in a level's row that begins one pixel earlier, and the share of the next pixel.
fn places(level: &Level, width: usize) -> Vec<(usize, f32)> {
    (0..width).map(|x| position(x, level.scale)).map(|(first, share)| ((first + 1) as usize, share)).collect()
}

/// The pixel of a level before a pixel of the image, and the share of the next one.
fn position(at: usize, scale: usize) -> (isize, f32) {
    let position = (at as f32 + 0.5) / scale as f32 - 0.5;
    (position.floor() as isize, position - position.floor())
}

/// The light between two rows of a level, continued at both ends as far as kernels see: by `radius` pixels and one more.
fn blended(level: &Level, channel: usize, radius: usize, y: usize, offset: usize) -> Vec<f32> {
    let (height, width) = (level.light.height(), level.light.width());
    let (first, share) = position(y, level.scale);
    let row = |index: isize| {
        let index = (index + offset as isize - radius as isize).clamp(0, height as isize - 1) as usize;
        &level.light.plane(channel)[index * width..][..width]
    };
    let (upper, lower) = (row(first), row(first + 1));
    let at = |x: usize| (1.0 - share) * upper[x] + share * lower[x];
    let mut light = vec![at(0); radius + 1];
    light.extend(upper.iter().zip(lower).map(|(upper, lower)| (1.0 - share) * upper + share * lower));
    light.extend(std::iter::repeat_n(at(width - 1), radius + 1));
    light
}

/// Adds a tap's share to a row of the image.
fn add(image: &mut [f32], weights: &[f32], places: &[(usize, f32)], light: &[f32]) {
    for ((value, weight), (at, share)) in image.iter_mut().zip(weights).zip(places) {
        *value += weight * ((1.0 - share) * light[*at] + share * light[at + 1]);
    }
}

/// The weights of a row, `[taps, width]`.
fn softmax(made: &Planes, y: usize) -> Vec<f32> {
    let width = made.width();
    let rows = || (0..made.channels()).map(|tap| &made.plane(tap)[y * width..][..width]);
    let mut largest = vec![f32::NEG_INFINITY; width];
    for row in rows() {
        largest.iter_mut().zip(row).for_each(|(largest, value)| *largest = largest.max(*value));
    }
    let mut weights = Vec::with_capacity(made.channels() * width);
    let mut sums = vec![0.0; width];
    for row in rows() {
        let first = weights.len();
        weights.extend(row.iter().zip(&largest).map(|(value, largest)| (value - largest).exp()));
        sums.iter_mut().zip(&weights[first..]).for_each(|(sum, weight)| *sum += weight);
    }
    for row in weights.chunks_exact_mut(width) {
        row.iter_mut().zip(&sums).for_each(|(weight, sum)| *weight /= sum);
    }
    weights
}
