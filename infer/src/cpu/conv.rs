//! Grouped convolution with bias and leaky ReLU on the CPU.
//!
//! A task is a stripe of rows of one group of one image. It copies the rows that it reads into a buffer with
//! a border of zeros, so that the inner loops know no edges, and runs the vector loops of [`super::stripe`]
//! on it. How the work is cut depends on the shapes only, never on the number of threads.

use super::operand::{Buffer, Operand, Padded};
use super::shape::{ConvShape, Scale, Stripe};
use super::stripe::{self, Packed};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::cell::RefCell;

thread_local! {
    /// A thread keeps it from stripe to stripe and from run to run.
    static BUFFER: RefCell<Buffer> = RefCell::default();
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
    shape.distribute(&mut stripes, shape.outputs, y, &channels, Scale::Same);
    stripes.into_par_iter().for_each(|stripe| {
        BUFFER.with_borrow_mut(|buffer| {
            Arch::new().dispatch(Forward { shape, operand, weights, bias, leak, stripe, buffer });
        });
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
