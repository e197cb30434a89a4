//! What a convolution reads, and the buffer into which the rows of a stripe of it are copied.
//!
//! Pooling, doubling and concatenation happen as rows are copied: none of what they make is ever stored as an
//! image. Loops, not iterators with closures, and these marked: else the compiler would not make them of the
//! instructions that `pulp` chooses.

use super::shape::ConvShape;
use std::borrow::Cow;

/// Images `[batch, channels, height, width]`.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    /// The numbers.
    pub data: &'a [f32],
    /// Channels of each image.
    pub channels: usize,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
}

impl<'a> Image<'a> {
    #[inline(always)]
    pub(super) fn row(&self, image: usize, channel: usize, y: usize) -> &'a [f32] {
        &self.data[((image * self.channels + channel) * self.height + y) * self.width..][..self.width]
    }
}

/// What a convolution reads.
#[derive(Clone, Debug)]
pub enum Operand<'a> {
    /// Images, continued at bottom and right by their last row and column where the frame is larger.
    Plain(Image<'a>),
    /// The pixels of squares of four as channels, space to depth, of images that are continued like those of
    /// [`Self::Plain`].
    Folded(Image<'a>),
    /// The 2x2 means of images.
    Pooled(Image<'a>),
    /// Coarse images, doubled bilinearly (half-pixel centres, edges replicated), concatenated with fine ones.
    Joined {
        /// Half as high and wide as the frame.
        coarse: Image<'a>,
        /// As large as the frame.
        fine: Image<'a>,
        /// For each channel that the convolution reads: which of the concatenation it is.
        order: Cow<'a, [usize]>,
    },
}

impl Operand<'_> {
    /// Copies a row of the frame.
    #[inline(always)]
    fn copy_row(&self, image: usize, channel: usize, y: usize, blend: &mut Vec<f32>, out: &mut [f32]) {
        match self {
            Self::Plain(plain) => continued(plain.row(image, channel, y.min(plain.height - 1)), out),
            Self::Folded(fine) => {
                let (square, channel) = (channel / fine.channels, channel % fine.channels);
                let row = fine.row(image, channel, (2 * y + square / 2).min(fine.height - 1));
                every_second(row, square % 2, out);
            }
            Self::Pooled(fine) => {
                pooled(fine.row(image, channel, 2 * y), fine.row(image, channel, 2 * y + 1), out);
            }
            Self::Joined { coarse, fine, order } => match order[channel].checked_sub(coarse.channels) {
                Some(channel) => out.copy_from_slice(fine.row(image, channel, y)),
                None => {
                    let near = coarse.row(image, order[channel], y / 2);
                    let far = coarse.row(image, order[channel], neighbour(y, coarse.height));
                    blend.resize(coarse.width + 2, 0.0);
                    blended(near, far, &mut blend[1..=coarse.width]);
                    widen(blend, out);
                }
            },
        }
    }
}

/// The row or column that doubled row or column `at` blends in with a weight of 1/4; the one in which it
/// lies, `at / 2`, has the rest.
pub const fn neighbour(at: usize, size: usize) -> usize {
    let near = at / 2;
    match at % 2 {
        0 => near.saturating_sub(1),
        _ if near + 1 < size => near + 1,
        _ => near,
    }
}

#[inline(always)]
fn continued(row: &[f32], out: &mut [f32]) {
    let (inside, beyond) = out.split_at_mut(row.len());
    inside.copy_from_slice(row);
    beyond.fill(row[row.len() - 1]);
}

/// Every second number of a row from the first or the second on, continued by the row's last.
#[inline(always)]
fn every_second(row: &[f32], first: usize, out: &mut [f32]) {
    let pairs = row.as_chunks::<2>().0;
    let inside = out.len().min(pairs.len());
    for x in 0..inside {
        out[x] = pairs[x][first];
    }
    out[inside..].fill(row[row.len() - 1]);
}

#[inline(always)]
fn pooled(upper: &[f32], lower: &[f32], out: &mut [f32]) {
    let (upper, lower) = (&upper[..2 * out.len()], &lower[..2 * out.len()]);
    for x in 0..out.len() {
        out[x] = 0.25 * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    }
}

#[inline(always)]
fn blended(near: &[f32], far: &[f32], out: &mut [f32]) {
    let (near, far) = (&near[..out.len()], &far[..out.len()]);
    for x in 0..out.len() {
        out[x] = 0.75 * near[x] + 0.25 * far[x];
    }
}

/// Doubles a row that stands between two numbers to spare.
#[inline(always)]
fn widen(row: &mut [f32], out: &mut [f32]) {
    let last = row.len() - 1;
    (row[0], row[last]) = (row[1], row[last - 1]);
    // One plain loop: of constant blocks the compiler makes single steps, with gathers and scatters.
    let pairs = out.as_chunks_mut::<2>().0;
    let row = &row[..pairs.len() + 2];
    for x in 0..pairs.len() {
        pairs[x] = [0.75 * row[x + 1] + 0.25 * row[x], 0.75 * row[x + 1] + 0.25 * row[x + 2]];
    }
}

/// Room for the rows of one stripe, to be used again for others.
#[derive(Debug, Default)]
pub struct Buffer {
    rows: Vec<f32>,
    blend: Vec<f32>,
}

/// Rows that a stripe reads, with a border of zeros: `[channels, rows + kernel - 1, stride]`.
#[derive(Clone, Copy, Debug)]
pub struct Padded<'a> {
    /// The values.
    pub data: &'a [f32],
    /// Length of a row: the width rounded up to whole vectors, and the border.
    pub stride: usize,
    /// Rows of the stripe itself.
    pub rows: usize,
}

impl<'a> Padded<'a> {
    /// The rows of an operand that a stripe of `rows` rows from `top` on of the group of the image `part`
    /// (`image * groups + group`) reads.
    #[inline(always)]
    pub fn of(
        operand: &Operand<'_>,
        shape: ConvShape,
        part: usize,
        top: usize,
        rows: usize,
        buffer: &'a mut Buffer,
    ) -> Self {
        let Buffer { rows: numbers, blend } = buffer;
        let (image, group) = (part / shape.groups, part % shape.groups);
        Self::filled(
            shape,
            shape.inputs,
            top,
            rows,
            numbers,
            #[inline(always)]
            |channel, y, row| operand.copy_row(image, group * shape.inputs + channel, y, blend, row),
        )
    }

    /// Rows that `fill` makes: it gets channel, row and where the row goes.
    #[inline(always)]
    pub fn filled(
        shape: ConvShape,
        channels: usize,
        top: usize,
        rows: usize,
        buffer: &'a mut Vec<f32>,
        mut fill: impl FnMut(usize, usize, &mut [f32]),
    ) -> Self {
        let half = shape.kernel / 2;
        let stride = shape.stride();
        let height = rows + 2 * half;
        let length = channels * height * stride;
        if buffer.len() < length {
            buffer.resize(length, 0.0);
        }
        let data = &mut buffer[..length];
        for (at, row) in data.chunks_exact_mut(stride).enumerate() {
            let (channel, y) = (at / height, top + at % height);
            if (half..shape.height + half).contains(&y) {
                row[..half].fill(0.0);
                row[half + shape.width..].fill(0.0);
                fill(channel, y - half, &mut row[half..half + shape.width]);
            } else {
                row.fill(0.0);
            }
        }
        Self { data, stride, rows }
    }

    /// Where the first pixel of the window of each weight `[channels, kernel, kernel]` lies.
    pub fn taps(&self, channels: usize, kernel: usize) -> Vec<usize> {
        let plane = (self.rows + kernel - 1) * self.stride;
        let mut taps = Vec::with_capacity(channels * kernel * kernel);
        for channel in 0..channels {
            for y in 0..kernel {
                taps.extend((0..kernel).map(|x| channel * plane + y * self.stride + x));
            }
        }
        taps
    }
}
