//! The filter of [`crate::filter`] on the processor: rows in parallel. A row of a level is blended from two
//! of its rows and spread to the image's pixels once, so that what a kernel's taps read of it are slices,
//! `scale` pixels apart.

use super::operand::Image;
use crate::NetSpec;
use crate::filter::Filter;
use crate::spec::channels;
use deepshade_shaders::Planes;
use rayon::prelude::*;

/// The light of an image at the resolutions that a filter reads.
#[derive(Debug)]
pub struct Light {
    filter: Filter,
    levels: Vec<Level>,
}

/// The light of an image at a resolution.
#[derive(Debug)]
struct Level {
    /// Pixels of the image along an axis for one of the level.
    scale: usize,
    light: Planes,
    /// Where the pixels of a row of the image, and as many beyond either end as kernels see, lie in
    /// [`Self::blend`]'s, and the share of the next pixel.
    places: Vec<(usize, f32)>,
}

impl Light {
    /// Of light whose height and width the coarsest level divides.
    pub fn new(filter: Filter, light: Planes) -> Self {
        debug_assert!(
            [light.height(), light.width()].map(|size| size % (1 << (filter.levels - 1))) == [0, 0]
        );
        let (width, radius) = (light.width(), filter.kernel / 2);
        let mut levels = vec![Level::new(1, light, width, radius)];
        for level in 1..filter.levels {
            let finer = &levels[level - 1];
            levels.push(Level::new(2 * finer.scale, halved(&finer.light), width, radius));
        }
        Self { filter, levels }
    }

    /// Channels of the light.
    pub fn channels(&self) -> usize {
        self.levels[0].light.channels()
    }

    /// Visits what the taps read along the first pixels of a row of the image: the tap's number, the channel,
    /// the light.
    #[inline(always)]
    pub fn visit_taps(&self, y: usize, width: usize, mut visit: impl FnMut(usize, usize, &[f32])) {
        let kernel = self.filter.kernel;
        let (mut blend, mut spread) = (Vec::new(), Vec::new());
        for (index, level) in self.levels.iter().enumerate() {
            for (offset, channel) in
                (0..kernel).flat_map(|offset| (0..self.channels()).map(move |channel| (offset, channel)))
            {
                level.blend(channel, kernel / 2, y, offset, &mut blend);
                spread.clear();
                let between = |(at, share): &(usize, f32)| (1.0 - share) * blend[*at] + share * blend[at + 1];
                spread.extend(level.places.iter().map(between));
                for shift in 0..kernel {
                    let tap = (index * kernel + offset) * kernel + shift;
                    visit(tap, channel, &spread[shift * level.scale..][..width]);
                }
            }
        }
    }
}

impl Level {
    /// Of an image of this width, for kernels of this radius.
    fn new(scale: usize, light: Planes, width: usize, radius: usize) -> Self {
        let place = |x| {
            let (first, share) = position(x, scale);
            // What is blended begins `radius + 1` pixels before the level, the first place `radius`: one
            // apart.
            ((first + 1) as usize, share)
        };
        Self { scale, light, places: (0..width + 2 * radius * scale).map(place).collect() }
    }

    /// The light between two rows of the level, continued at both ends as far as kernels see: by `radius`
    /// pixels and one more.
    fn blend(&self, channel: usize, radius: usize, y: usize, offset: usize, blend: &mut Vec<f32>) {
        let (height, width) = (self.light.height(), self.light.width());
        let (first, share) = position(y, self.scale);
        let row = |index: isize| {
            let index = (index + offset as isize - radius as isize).clamp(0, height as isize - 1) as usize;
            &self.light.plane(channel)[index * width..][..width]
        };
        let (upper, lower) = (row(first), row(first + 1));
        let at = |x: usize| (1.0 - share) * upper[x] + share * lower[x];
        blend.clear();
        blend.extend(std::iter::repeat_n(at(0), radius + 1));
        blend.extend(upper.iter().zip(lower).map(|(upper, lower)| (1.0 - share) * upper + share * lower));
        blend.extend(std::iter::repeat_n(at(width - 1), radius + 1));
    }
}

/// The network's image of its input, given what its last convolution makes of the image's pixels,
/// `[weights, height, width]`.
pub fn filtered(spec: &NetSpec, filter: Filter, input: &Planes, made: &Planes) -> Planes {
    let (height, width) = (made.height(), made.width());
    let light = Light::new(filter, padded(&channels(input, &spec.pyramid_channels()), spec.alignment()));
    let made = Image { data: made.data(), channels: made.channels(), height, width };
    let row = |y| weighted(&light, &softmax(made, 0, y), y, width);
    let rows: Vec<Vec<f32>> = (0..height).into_par_iter().map(row).collect();
    Planes::from_data(light.channels(), height, width, planar(&rows, width))
}

/// Rows `[channels, width]` one below the other as `[channels, height, width]`.
pub fn planar(rows: &[Vec<f32>], width: usize) -> Vec<f32> {
    let channels = rows.first().map_or(0, |row| row.len() / width);
    (0..channels).flat_map(|c| rows.iter().flat_map(move |row| &row[c * width..][..width])).copied().collect()
}

/// The sum along a row of the image, `[channels, width]`, of the light that the taps read, with weights
/// `[weights, width]`.
pub fn weighted(light: &Light, weights: &[f32], y: usize, width: usize) -> Vec<f32> {
    let mut image = vec![0.0; light.channels() * width];
    light.visit_taps(y, width, |tap, channel, light| {
        let (image, weights) = (&mut image[channel * width..][..width], &weights[tap * width..][..width]);
        for x in 0..width {
            image[x] += weights[x] * light[x];
        }
    });
    image
}

/// The light continued by its last row and column.
pub(super) fn padded(light: &Planes, alignment: usize) -> Planes {
    let [height, width] = [light.height(), light.width()].map(|size| size.next_multiple_of(alignment));
    let mut data = Vec::with_capacity(light.channels() * height * width);
    for (channel, y) in (0..light.channels()).flat_map(|c| (0..height).map(move |y| (c, y))) {
        let row = &light.plane(channel)[y.min(light.height() - 1) * light.width()..][..light.width()];
        data.extend_from_slice(row);
        data.extend(std::iter::repeat_n(row[row.len() - 1], width - row.len()));
    }
    Planes::from_data(light.channels(), height, width, data)
}

/// What a block on a coarser level makes, as the pixels of an image of `[height, width]`: depth to space.
pub fn unfolded(made: &Planes, level: usize, [height, width]: [usize; 2]) -> Planes {
    let side = 1 << level;
    let channels = made.channels() / (side * side);
    let mut image = Planes::filled(channels, height, width, 0.0);
    for c in 0..channels {
        for (y, row) in image.plane_mut(c).chunks_exact_mut(width).enumerate() {
            unfold_row(made, level, c, y, row);
        }
    }
    image
}

/// A row of a channel of [`unfolded`].
pub(super) fn unfold_row(made: &Planes, level: usize, channel: usize, y: usize, row: &mut [f32]) {
    let side = 1 << level;
    let channels = made.channels() / (side * side);
    for first in 0..side {
        let from = made.plane((y % side * side + first) * channels + channel);
        let from = &from[y / side * made.width()..][..made.width()];
        row.iter_mut().skip(first).step_by(side).zip(from).for_each(|(to, from)| *to = *from);
    }
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

/// The pixel of a level before a pixel of the image, and the share of the next one.
fn position(at: usize, scale: usize) -> (isize, f32) {
    let position = (at as f32 + 0.5) / scale as f32 - 0.5;
    (position.floor() as isize, position - position.floor())
}

/// The weights of a row of an image, `[weights, width]`: the softmax of what the last convolution makes.
pub fn softmax(made: Image<'_>, image: usize, y: usize) -> Vec<f32> {
    let width = made.width;
    let rows = || (0..made.channels).map(|tap| made.row(image, tap, y));
    let mut largest = vec![f32::NEG_INFINITY; width];
    for row in rows() {
        largest.iter_mut().zip(row).for_each(|(largest, value)| *largest = largest.max(*value));
    }
    let mut weights = Vec::with_capacity(made.channels * width);
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
