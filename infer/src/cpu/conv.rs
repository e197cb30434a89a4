//! Grouped convolution with bias and leaky ReLU on the CPU.
//!
//! A task is a stripe of rows of one group of one image. It copies the rows that it reads into a buffer with a border
//! of zeros, so that the inner loops know no edges, and runs the vector loops of [`super::stripe`] on it. How the work
//! is cut depends on the shapes only, never on the number of threads.

use super::operand::{Buffer, Operand, Padded};
use super::stripe::{self, Packed};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Numbers that a stripe may read: they stay in the second-level cache.
const ROOM: usize = 160 * 1024;
/// Fewest and most rows of a stripe; even, as doubling and pooling are.
const ROWS: [usize; 2] = [4, 32];

/// The sizes of a convolution that keeps height and width (stride 1, zero padding, odd kernel).
#[derive(Clone, Copy, Debug)]
pub struct ConvShape {
    /// Number of images.
    pub batch: usize,
    /// Number of groups.
    pub groups: usize,
    /// Channels that a group reads.
    pub inputs: usize,
    /// Channels that a group makes.
    pub outputs: usize,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// Width and height of the kernel.
    pub kernel: usize,
}

impl ConvShape {
    /// Weights of a group.
    pub const fn group_weights(&self) -> usize {
        self.outputs * self.inputs * self.kernel * self.kernel
    }

    /// Numbers of what is made, `[batch, groups * outputs, height, width]`.
    pub const fn made(&self) -> usize {
        self.batch * self.groups * self.outputs * self.height * self.width
    }

    /// Rows of a stripe.
    pub fn stripe_rows(&self) -> usize {
        let row = self.inputs.max(self.outputs) * Padded::stride(self.width, self.kernel);
        let fitting = (ROOM / row).saturating_sub(self.kernel - 1) / 2 * 2;
        fitting.clamp(ROWS[0], ROWS[1])
    }

    /// The stripes of the work, without anything to write to.
    pub fn stripes<'a>(&self) -> Vec<Stripe<'a>> {
        let rows = self.stripe_rows();
        let tops = (0..self.height).step_by(rows);
        (0..self.batch * self.groups)
            .flat_map(|part| tops.clone().map(move |top| (part, top)))
            .map(|(part, top)| Stripe { part, top, rows: rows.min(self.height - top), planes: Vec::new() })
            .collect()
    }

    /// Deals the rows of images `[batch, positions, height, width] * scale` out to stripes whose groups have so many
    /// channels: `positions` says for each channel of an image which one of all groups' it is.
    pub fn deal<'a>(
        &self,
        stripes: &mut [Stripe<'a>],
        channels: usize,
        image: &'a mut [f32],
        positions: &[usize],
        scale: Scale,
    ) {
        let rows = self.stripe_rows();
        let count = self.height.div_ceil(rows);
        stripes.iter_mut().for_each(|stripe| stripe.planes.resize_with(channels, Default::default));
        for (at, plane) in image.chunks_exact_mut(scale.area(self.height * self.width)).enumerate() {
            let (image, position) = (at / positions.len(), positions[at % positions.len()]);
            let first = (image * self.groups + position / channels) * count;
            for (stripe, rows) in
                stripes[first..].iter_mut().zip(plane.chunks_mut(scale.area(rows * self.width)))
            {
                stripe.planes[position % channels] = rows;
            }
        }
    }
}

/// The size of an image beside the frame of a convolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Half as high and wide.
    Half,
    /// The same.
    Same,
    /// Twice as high and wide.
    Double,
}

impl Scale {
    /// Pixels of the image where the frame has `pixels`.
    pub const fn area(self, pixels: usize) -> usize {
        match self {
            Self::Half => pixels / 4,
            Self::Same => pixels,
            Self::Double => 4 * pixels,
        }
    }
}

/// A stripe of rows of one group of one image.
#[derive(Debug)]
pub struct Stripe<'a> {
    /// `image * groups + group`.
    pub part: usize,
    /// Its first row.
    pub top: usize,
    /// Its rows.
    pub rows: usize,
    /// Where the rows that it makes go, a slice a channel.
    pub planes: Vec<&'a mut [f32]>,
}

/// Convolution, bias, leaky ReLU (`leak` 1 for none) into `y`, `[batch, groups * outputs, height, width]`.
pub fn forward(
    shape: ConvShape,
    operand: &Operand<'_>,
    weights: &Packed,
    bias: &[f32],
    leak: f32,
    y: &mut [f32],
) {
    let mut stripes = shape.stripes();
    let channels: Vec<usize> = (0..shape.groups * shape.outputs).collect();
    shape.deal(&mut stripes, shape.outputs, y, &channels, Scale::Same);
    stripes.into_par_iter().for_each_init(Buffer::default, |buffer, stripe| {
        Arch::new().dispatch(Forward { shape, operand, weights, bias, leak, stripe, buffer });
    });
}

/// One stripe's convolution.
struct Forward<'a, 'b> {
    shape: ConvShape,
    operand: &'a Operand<'a>,
    weights: &'a Packed,
    bias: &'a [f32],
    leak: f32,
    stripe: Stripe<'b>,
    buffer: &'a mut Buffer,
}

impl WithSimd for Forward<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { shape, operand, weights, bias, leak, mut stripe, buffer } = self;
        let padded = Padded::of(operand, shape, stripe.part, stripe.top, stripe.rows, buffer);
        let group = stripe.part % shape.groups;
        let bias = &bias[group * shape.outputs..][..shape.outputs];
        stripe::convolve(simd, &padded, shape, weights.group(group), bias, leak, &mut stripe.planes);
    }
}
