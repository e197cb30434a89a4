//! The filter of [`deepshade_infer::filter`] and its gradient by what the last convolution makes. A unit
//! makes a pixel.

use super::Gpu;
use super::launch::{buffer, cubes, dims, empty, units};
use cubecl::prelude::*;
use deepshade_infer::Filter;

/// What a kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct FilterConfig {
    /// Levels of the pyramid.
    levels: usize,
    /// Height and width of the kernel on every level.
    kernel: usize,
    /// Weights of a pixel, that of black included.
    weights: usize,
    /// Channels of the light.
    channels: usize,
}

impl FilterConfig {
    fn new(filter: Filter, pyramid: &Gpu) -> Self {
        let [_, channels, _] = dims(pyramid);
        Self { levels: filter.levels, kernel: filter.kernel, weights: filter.weight_count(), channels }
    }
}

/// The filter's image of what the last convolution `made`, `[batch, weights, height, width]`, and of the
/// light's pyramid, `[batch, channels, pixels of all levels]`.
pub fn filtered(filter: Filter, made: &Gpu, pyramid: &Gpu) -> Gpu {
    let [batch, _, height, width] = dims(made);
    let config = FilterConfig::new(filter, pyramid);
    let image = empty(made, [batch, config.channels, height, width]);
    weighted_sum::launch(
        &made.client,
        cubes(height * width, batch, 1),
        units(height * width),
        buffer(made),
        buffer(pyramid),
        buffer(&image),
        height as u32,
        width as u32,
        config,
    );
    image
}

/// The gradient of [`filtered`] by `made`, given that by the image.
pub fn filtered_backward(filter: Filter, made: &Gpu, pyramid: &Gpu, gradient: &Gpu) -> Gpu {
    let [batch, _, height, width] = dims(made);
    let by_made = empty(made, dims::<4>(made));
    weights_gradient::launch(
        &made.client,
        cubes(height * width, batch, 1),
        units(height * width),
        buffer(made),
        buffer(pyramid),
        buffer(gradient),
        buffer(&by_made),
        height as u32,
        width as u32,
        FilterConfig::new(filter, pyramid),
    );
    by_made
}

/// Units along x are pixels, along y images.
#[cube(launch)]
fn weighted_sum(
    made: &[f32],
    pyramid: &[f32],
    image: &mut [f32],
    height: u32,
    width: u32,
    #[comptime] config: FilterConfig,
) {
    let FilterConfig { levels, kernel, weights, channels } = comptime!(config);
    let (height, width) = (height as usize, width as usize);
    let area = height * width;
    let size = pyramid_size(area, levels);
    let index = CUBE_POS_Y as usize;
    let taps = comptime!(kernel * kernel);
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        let first = index * weights * area + pixel;
        let (highest, scale) = softmax(made, first, area, weights);
        let mut sums = Array::<f32>::new(channels);
        #[unroll]
        for channel in 0..channels {
            sums[channel] = 0.0;
        }
        let mut level_at = 0usize.runtime();
        #[unroll]
        for level in 0..levels {
            for tap in 0..taps {
                let spot = spot(pixel, height, width, tap, level, kernel);
                let weight = f32::exp(made[first + (comptime!(level * taps) + tap) * area] - highest) * scale;
                #[unroll]
                for channel in 0..channels {
                    sums[channel] +=
                        weight * read(pyramid, (index * channels + channel) * size + level_at, &spot);
                }
            }
            level_at += area >> comptime!(2 * level as u32) as usize;
        }
        #[unroll]
        for channel in 0..channels {
            image[(index * channels + channel) * area + pixel] = sums[channel];
        }
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// Units along x are pixels, along y images. Until a pixel's last loop `by_made` has its gradients by
/// weights.
#[cube(launch)]
fn weights_gradient(
    made: &[f32],
    pyramid: &[f32],
    gradient: &[f32],
    by_made: &mut [f32],
    height: u32,
    width: u32,
    #[comptime] config: FilterConfig,
) {
    let FilterConfig { levels, kernel, weights, channels } = comptime!(config);
    let (height, width) = (height as usize, width as usize);
    let area = height * width;
    let size = pyramid_size(area, levels);
    let index = CUBE_POS_Y as usize;
    let taps = comptime!(kernel * kernel);
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        let first = index * weights * area + pixel;
        let (highest, scale) = softmax(made, first, area, weights);
        let mut mean = 0.0f32.runtime();
        let mut level_at = 0usize.runtime();
        #[unroll]
        for level in 0..levels {
            for tap in 0..taps {
                let spot = spot(pixel, height, width, tap, level, kernel);
                let at = first + (comptime!(level * taps) + tap) * area;
                let mut by_weight = 0.0f32.runtime();
                #[unroll]
                for channel in 0..channels {
                    let plane = index * channels + channel;
                    by_weight +=
                        gradient[plane * area + pixel] * read(pyramid, plane * size + level_at, &spot);
                }
                by_made[at] = by_weight;
                mean += f32::exp(made[at] - highest) * scale * by_weight;
            }
            level_at += area >> comptime!(2 * level as u32) as usize;
        }
        // The gradient of a softmax: a weight times its own gradient less their mean. Black adds nothing to
        // the image: its own is 0.
        for weight in 0..weights {
            let at = first + weight * area;
            let mut by_weight = 0.0f32.runtime();
            if weight < comptime!(levels * taps) {
                by_weight = by_made[at];
            }
            by_made[at] = f32::exp(made[at] - highest) * scale * (by_weight - mean);
        }
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// The maximum of a pixel's logits, and one over the sum of exponentials of their distances from it.
#[cube]
fn softmax(made: &[f32], first: usize, area: usize, #[comptime] weights: usize) -> (f32, f32) {
    let mut highest = made[first];
    for weight in 1..weights {
        highest = max(highest, made[first + weight * area]);
    }
    let mut sum = 0.0f32.runtime();
    for weight in 0..weights {
        sum += f32::exp(made[first + weight * area] - highest);
    }
    (highest, 1.0 / sum)
}

/// Pixels of all levels.
#[cube]
fn pyramid_size(area: usize, #[comptime] levels: usize) -> usize {
    let mut size = 0usize.runtime();
    #[unroll]
    for level in 0..levels {
        size += area >> comptime!(2 * level as u32) as usize;
    }
    size
}

/// Four pixels of a level, and how far between them a tap lies.
#[derive(CubeType)]
struct Spot {
    upper: usize,
    lower: usize,
    left: usize,
    right: usize,
    down: f32,
    along: f32,
}

/// Where a tap of a pixel lies on a level.
#[cube]
fn spot(
    pixel: usize,
    height: usize,
    width: usize,
    tap: usize,
    #[comptime] level: usize,
    #[comptime] kernel: usize,
) -> Spot {
    let (rows, columns) = (height >> level, width >> level);
    let y = position(pixel / width, tap / kernel, level, kernel);
    let x = position(pixel % width, tap % kernel, level, kernel);
    let (row, column) = (f32::floor(y), f32::floor(x));
    Spot {
        upper: clamped(row as i32, rows) * columns,
        lower: clamped(row as i32 + 1, rows) * columns,
        left: clamped(column as i32, columns),
        right: clamped(column as i32 + 1, columns),
        down: y - row,
        along: x - column,
    }
}

/// Where a row or column of a kernel lies on a level.
#[cube]
fn position(pixel: usize, offset: usize, #[comptime] level: usize, #[comptime] kernel: usize) -> f32 {
    let scale = comptime!(1.0 / (1 << level) as f32);
    (pixel as f32 + 0.5) * scale - 0.5 + offset as f32 - comptime!((kernel / 2) as f32)
}

#[cube]
fn clamped(position: i32, size: usize) -> usize {
    clamp(position, 0, size as i32 - 1) as usize
}

/// The pyramid's number at a spot.
#[cube]
fn read(pyramid: &[f32], plane: usize, spot: &Spot) -> f32 {
    let upper = pyramid[plane + spot.upper + spot.left] * (1.0 - spot.along)
        + pyramid[plane + spot.upper + spot.right] * spot.along;
    let lower = pyramid[plane + spot.lower + spot.left] * (1.0 - spot.along)
        + pyramid[plane + spot.lower + spot.right] * spot.along;
    upper * (1.0 - spot.down) + lower * spot.down
}
