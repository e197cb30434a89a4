//! Kernels of the filter of [`deepshade_infer::filter`] and of its gradient by what the last convolution makes. A unit makes a pixel.

use cubecl::prelude::*;

/// What a kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Form {
    /// Levels of the pyramid.
    pub levels: usize,
    /// Height and width of the kernel on every level.
    pub kernel: usize,
    /// Weights of a pixel, that of black included.
    pub weights: usize,
    /// Channels of the light.
    pub channels: usize,
}

/// The image, `[batch, channels, height, width]`, of what the last convolution `made`, `[batch, weights, height, width]`, and of the
/// pyramid of the light, `[batch, channels, pixels of all levels]`. Units along x are pixels, along y images.
#[cube(launch)]
pub fn filter(
    made: &[f32],
    pyramid: &[f32],
    image: &mut [f32],
    height: u32,
    width: u32,
    #[comptime] form: Form,
) {
    let (height, width) = (height as usize, width as usize);
    let area = height * width;
    let pixel = ABSOLUTE_POS_X as usize;
    if pixel >= area {
        terminate!();
    }
    let index = CUBE_POS_Y as usize;
    let first = index * form.weights * area + pixel;
    let (highest, scale) = softmax(made, first, area, form.weights);
    let mut sums = Array::<f32>::new(form.channels);
    #[unroll]
    for channel in 0..form.channels {
        sums[channel] = 0.0;
    }
    let size = pyramid_size(area, form.levels);
    let mut level_at = 0usize.runtime();
    #[unroll]
    for level in 0..form.levels {
        #[unroll]
        for tap in 0..comptime!(form.kernel * form.kernel) {
            let spot = spot(pixel, height, width, level, tap, form.kernel);
            let weight =
                f32::exp(made[first + comptime!(level * form.kernel * form.kernel + tap) * area] - highest)
                    * scale;
            #[unroll]
            for channel in 0..form.channels {
                let plane = (index * form.channels + channel) * size + level_at;
                sums[channel] += weight * read(pyramid, plane, &spot);
            }
        }
        level_at += area >> comptime!(2 * level as u32) as usize;
    }
    #[unroll]
    for channel in 0..form.channels {
        image[(index * form.channels + channel) * area + pixel] = sums[channel];
    }
}

/// The gradient of [`filter`] by `made`, given that by the image.
#[cube(launch)]
pub fn filter_gradient(
    made: &[f32],
    pyramid: &[f32],
    gradient: &[f32],
    by_made: &mut [f32],
    height: u32,
    width: u32,
    #[comptime] form: Form,
) {
    let (height, width) = (height as usize, width as usize);
    let area = height * width;
    let pixel = ABSOLUTE_POS_X as usize;
    if pixel >= area {
        terminate!();
    }
    let index = CUBE_POS_Y as usize;
    let first = index * form.weights * area + pixel;
    let (highest, scale) = softmax(made, first, area, form.weights);
    let size = pyramid_size(area, form.levels);
    // By every weight, then less their mean; black has a gradient of zero by its own.
    let mut mean = 0.0f32.runtime();
    let mut level_at = 0usize.runtime();
    #[unroll]
    for level in 0..form.levels {
        #[unroll]
        for tap in 0..comptime!(form.kernel * form.kernel) {
            let spot = spot(pixel, height, width, level, tap, form.kernel);
            let at = first + comptime!(level * form.kernel * form.kernel + tap) * area;
            let weight = f32::exp(made[at] - highest) * scale;
            let mut by_weight = 0.0f32.runtime();
            #[unroll]
            for channel in 0..form.channels {
                let plane = index * form.channels + channel;
                by_weight += gradient[plane * area + pixel] * read(pyramid, plane * size + level_at, &spot);
            }
            by_made[at] = by_weight;
            mean += weight * by_weight;
        }
        level_at += area >> comptime!(2 * level as u32) as usize;
    }
    for weight in 0..form.weights {
        let at = first + weight * area;
        let mut by_weight = 0.0f32.runtime();
        if weight < comptime!(form.levels * form.kernel * form.kernel) {
            by_weight = by_made[at];
        }
        by_made[at] = f32::exp(made[at] - highest) * scale * (by_weight - mean);
    }
}

/// The highest of a pixel's numbers, and what the exponentials of their distances from it are multiplied by.
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
    #[comptime] level: usize,
    #[comptime] tap: usize,
    #[comptime] kernel: usize,
) -> Spot {
    let (rows, columns) = (height >> level, width >> level);
    let y = position(pixel / width, level, comptime!((tap / kernel) as i32 - (kernel / 2) as i32));
    let x = position(pixel % width, level, comptime!((tap % kernel) as i32 - (kernel / 2) as i32));
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

/// Where a pixel lies on a level, so many of its pixels further.
#[cube]
fn position(pixel: usize, #[comptime] level: usize, #[comptime] offset: i32) -> f32 {
    let scale = comptime!(1.0 / (1 << level) as f32);
    (pixel as f32 + 0.5) * scale - 0.5 + comptime!(offset as f32)
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
