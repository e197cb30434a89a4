//! Doubling an image bilinearly and putting it together with one of that size, group by group, and its
//! gradients.

use super::Gpu;
use super::launch::{buffer, cubes, dims, empty, units};
use burn_cubecl::kernel::into_contiguous;
use cubecl::prelude::*;

/// What a kernel is compiled for: of one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct JoinConfig {
    /// Channels of the coarse image.
    coarse: usize,
    /// Channels of the fine one.
    fine: usize,
}

impl JoinConfig {
    fn new(coarse: &Gpu, fine: &Gpu, groups: usize) -> Self {
        Self { coarse: dims::<4>(coarse)[1] / groups, fine: dims::<4>(fine)[1] / groups }
    }
}

/// In each of so many groups a share of `coarse`, doubled (half-pixel centres, edges replicated), then a
/// share of `fine`.
pub fn join(coarse: &Gpu, fine: &Gpu, groups: usize) -> Gpu {
    let [batch, channels, height, width] = dims(fine);
    let channels = channels + dims::<4>(coarse)[1];
    let joined = empty(fine, [batch, channels, height, width]);
    concatenation::launch(
        &fine.client,
        cubes(height * width, channels, batch),
        units(height * width),
        buffer(coarse),
        buffer(fine),
        buffer(&joined),
        height as u32,
        width as u32,
        groups as u32,
        JoinConfig::new(coarse, fine, groups),
    );
    joined
}

/// The gradients by `coarse` and `fine`, given that by what they were [joined](join()) to.
pub fn join_backward(gradient: &Gpu, coarse: &Gpu, fine: &Gpu, groups: usize) -> [Gpu; 2] {
    let [batch, coarse_channels, rows, columns] = dims(coarse);
    let [_, fine_channels, height, width] = dims(fine);
    let (by_coarse, by_fine) = (empty(coarse, dims::<4>(coarse)), empty(fine, dims::<4>(fine)));
    let config = JoinConfig::new(coarse, fine, groups);
    let gradient = into_contiguous(gradient.clone());
    coarse_gradient::launch(
        &coarse.client,
        cubes(rows * columns, coarse_channels, batch),
        units(rows * columns),
        buffer(&gradient),
        buffer(&by_coarse),
        rows as u32,
        columns as u32,
        groups as u32,
        config,
    );
    fine_gradient::launch(
        &fine.client,
        cubes(height * width, fine_channels, batch),
        units(height * width),
        buffer(&gradient),
        buffer(&by_fine),
        (height * width) as u32,
        groups as u32,
        config,
    );
    [by_coarse, by_fine]
}

/// Units along x are pixels, along y channels of what is made, along z images.
#[cube(launch)]
fn concatenation(
    coarse: &[f32],
    fine: &[f32],
    joined: &mut [f32],
    height: u32,
    width: u32,
    groups: u32,
    #[comptime] config: JoinConfig,
) {
    let (height, width, groups) = (height as usize, width as usize, groups as usize);
    let area = height * width;
    let channels = comptime!(config.coarse + config.fine);
    let group = CUBE_POS_Y as usize / channels;
    let channel = CUBE_POS_Y as usize % channels;
    let image = CUBE_POS_Z as usize * groups + group;
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        let at = (image * channels + channel) * area + pixel;
        if channel < config.coarse {
            let plane = (image * config.coarse + channel) * (area / 4);
            joined[at] = doubled(coarse, plane, pixel / width, pixel % width, height / 2, width / 2);
        } else {
            joined[at] = fine[(image * config.fine + channel - config.coarse) * area + pixel];
        }
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// Pixel `y`, `x` of an image of so many rows and columns, doubled.
#[cube]
fn doubled(coarse: &[f32], plane: usize, y: usize, x: usize, rows: usize, columns: usize) -> f32 {
    let (row, column) = (y / 2, x / 2);
    // Every value's two children lean a quarter towards its neighbour on their side.
    let next_row = select(y.is_multiple_of(2), saturating_before(row), before(row + 1, rows));
    let next_column = select(x.is_multiple_of(2), saturating_before(column), before(column + 1, columns));
    let near = plane + row * columns;
    let far = plane + next_row * columns;
    let near = coarse[near + column] * 0.75 + coarse[near + next_column] * 0.25;
    let far = coarse[far + column] * 0.75 + coarse[far + next_column] * 0.25;
    near * 0.75 + far * 0.25
}

/// The fine image's channels. Units along x are pixels, along y its channels, along z images.
#[cube(launch)]
fn fine_gradient(gradient: &[f32], fine: &mut [f32], area: u32, groups: u32, #[comptime] config: JoinConfig) {
    let area = area as usize;
    let group = CUBE_POS_Y as usize / config.fine;
    let channel = CUBE_POS_Y as usize % config.fine;
    let image = CUBE_POS_Z as usize * groups as usize + group;
    let from = image * comptime!(config.coarse + config.fine) + config.coarse + channel;
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        fine[(image * config.fine + channel) * area + pixel] = gradient[from * area + pixel];
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// Sums over the children of every pixel of the coarse image. Units along x are its pixels, along y its
/// channels, along z images.
#[cube(launch)]
fn coarse_gradient(
    gradient: &[f32],
    coarse: &mut [f32],
    rows: u32,
    columns: u32,
    groups: u32,
    #[comptime] config: JoinConfig,
) {
    let (rows, columns) = (rows as usize, columns as usize);
    let area = rows * columns;
    let group = CUBE_POS_Y as usize / config.coarse;
    let channel = CUBE_POS_Y as usize % config.coarse;
    let image = CUBE_POS_Z as usize * groups as usize + group;
    let plane = (image * comptime!(config.coarse + config.fine) + channel) * area * 4;
    let mut pixel = ABSOLUTE_POS_X as usize;
    while pixel < area {
        let (row, column) = (pixel / columns, pixel % columns);
        let mut sum = 0.0;
        #[unroll]
        for dy in 0..4usize {
            let y = child(row, dy, rows * 2);
            #[unroll]
            for dx in 0..4usize {
                let x = child(column, dx, columns * 2);
                let weight = comptime!(share(dy) * share(dx));
                sum += gradient[plane + y * columns * 2 + x] * weight;
            }
        }
        coarse[(image * config.coarse + channel) * area + pixel] = sum;
        pixel += CUBE_COUNT_X as usize * CUBE_DIM_X as usize;
    }
}

/// How much of a value one of the four children that it reaches has. Beyond an edge a child counts for the
/// one at the edge.
const fn share(child: usize) -> f32 {
    if child == 1 || child == 2 { 0.75 } else { 0.25 }
}

/// Position of one of the four children that a value reaches.
#[cube]
fn child(parent: usize, #[comptime] child: usize, size: usize) -> usize {
    if comptime!(child == 0) {
        saturating_before(parent * 2)
    } else {
        before(parent * 2 + comptime!(child - 1), size)
    }
}

/// One less, but for 0.
#[cube]
fn saturating_before(position: usize) -> usize {
    select(position == 0, 0, position - 1)
}

/// A position, or the last of so many.
#[cube]
fn before(position: usize, size: usize) -> usize {
    select(position < size, position, size - 1)
}
