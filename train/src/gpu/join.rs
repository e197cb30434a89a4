//! Kernels that double an image bilinearly and put it together with one of that size, group by group, and their gradients.

use cubecl::prelude::*;

/// Sizes of a concatenation, of one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shares {
    /// Channels of the coarse image.
    pub coarse: usize,
    /// Channels of the fine one.
    pub fine: usize,
}

/// `joined` has in every group a share of `coarse`, doubled (half-pixel centres, edges replicated), then a share of `fine`. Units along
/// x are pixels, along y channels of what is made, along z images.
#[cube(launch)]
pub fn join(
    coarse: &[f32],
    fine: &[f32],
    joined: &mut [f32],
    height: u32,
    width: u32,
    groups: u32,
    #[comptime] shares: Shares,
) {
    let (height, width, groups) = (height as usize, width as usize, groups as usize);
    let pixel = ABSOLUTE_POS_X as usize;
    let area = height * width;
    if pixel >= area {
        terminate!();
    }
    let channels = comptime!(shares.coarse + shares.fine);
    let group = CUBE_POS_Y as usize / channels;
    let channel = CUBE_POS_Y as usize % channels;
    let image = CUBE_POS_Z as usize * groups + group;
    let at = (image * channels + channel) * area + pixel;
    if channel < shares.coarse {
        let plane = (image * shares.coarse + channel) * (area / 4);
        let (y, x) = (pixel / width, pixel % width);
        let (rows, columns) = (height / 2, width / 2);
        let (row, column) = (y / 2, x / 2);
        // Every value's two children lean a quarter towards its neighbour on their side.
        let next_row = if y % 2 == 0 { saturating_before(row) } else { before(row + 1, rows) };
        let next_column = if x % 2 == 0 { saturating_before(column) } else { before(column + 1, columns) };
        let near = plane + row * columns;
        let far = plane + next_row * columns;
        let near = coarse[near + column] * 0.75 + coarse[near + next_column] * 0.25;
        let far = coarse[far + column] * 0.75 + coarse[far + next_column] * 0.25;
        joined[at] = near * 0.75 + far * 0.25;
    } else {
        joined[at] = fine[(image * shares.fine + channel - shares.coarse) * area + pixel];
    }
}

/// The gradient of the fine image: its channels of that of what was joined. Units as in [`join`], of the fine image.
#[cube(launch)]
pub fn fine_gradient(gradient: &[f32], fine: &mut [f32], area: u32, groups: u32, #[comptime] shares: Shares) {
    let area = area as usize;
    let pixel = ABSOLUTE_POS_X as usize;
    if pixel >= area {
        terminate!();
    }
    let group = CUBE_POS_Y as usize / shares.fine;
    let channel = CUBE_POS_Y as usize % shares.fine;
    let image = CUBE_POS_Z as usize * groups as usize + group;
    let from = image * comptime!(shares.coarse + shares.fine) + shares.coarse + channel;
    fine[(image * shares.fine + channel) * area + pixel] = gradient[from * area + pixel];
}

/// The gradient of the coarse image, of so many rows and columns. Units as in [`join`], of the coarse image.
#[cube(launch)]
pub fn coarse_gradient(
    gradient: &[f32],
    coarse: &mut [f32],
    rows: u32,
    columns: u32,
    groups: u32,
    #[comptime] shares: Shares,
) {
    let (rows, columns) = (rows as usize, columns as usize);
    let pixel = ABSOLUTE_POS_X as usize;
    let area = rows * columns;
    if pixel >= area {
        terminate!();
    }
    let group = CUBE_POS_Y as usize / shares.coarse;
    let channel = CUBE_POS_Y as usize % shares.coarse;
    let image = CUBE_POS_Z as usize * groups as usize + group;
    let plane = (image * comptime!(shares.coarse + shares.fine) + channel) * area * 4;
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
    coarse[(image * shares.coarse + channel) * area + pixel] = sum;
}

/// How much of a value one of the four children that it reaches has. Beyond an edge a child counts for the one at the edge.
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
