//! The forward pass in plain Rust: slow, and written to be read beside `shaders/wgsl/net`.

mod filter;

use crate::spec::{channels, joined_order};
use crate::{Activation, BlockSource, Head, Layer, LayerWeights, NetSpec, Weights};
use deepshade_shaders::Planes;
use rayon::prelude::*;

/// The network's image, `[output channels, height, width]`, of an input `[input channels, height, width]`.
///
/// # Panics
/// If input or weights do not fit the spec.
pub fn forward(spec: &NetSpec, weights: &Weights, input: &Planes) -> Planes {
    let made = run(spec, weights, input).pop().expect("a network has a layer");
    image(spec, input, &made)
}

/// What every layer makes on the way to the network's image, in the order of computation.
///
/// # Panics
/// If input or weights do not fit the spec.
pub fn layers(spec: &NetSpec, weights: &Weights, input: &Planes) -> Vec<Activation> {
    let mut made = run(spec, weights, input);
    if let Some(last) = made.last_mut() {
        *last = image(spec, input, last);
    }
    spec.layers()
        .into_iter()
        .zip(made)
        .map(|(layer, planes)| Activation { layer: layer.name, planes })
        .collect()
}

/// The network's image, given what its last convolution makes of the padded input.
fn image(spec: &NetSpec, input: &Planes, made: &Planes) -> Planes {
    let made = unfolded(made, spec.last_level()).window(0, 0, input.height(), input.width());
    let pyramid_of = || padded(&channels(input, &spec.pyramid_channels()), spec.alignment());
    match spec.head {
        Head::Image => made,
        Head::Filter(filter) => filter::filtered(filter, &pyramid_of(), &made),
        Head::Correction(correction) => {
            let estimate = channels(input, &spec.channels_of(correction.of));
            filter::corrected(correction, spec.effect.range(), &estimate, &pyramid_of(), &made)
        }
    }
}

/// Channels that are the pixels of squares, `1 << level` along an axis, as those pixels: depth to space.
fn unfolded(image: &Planes, level: usize) -> Planes {
    let side = 1 << level;
    let channels = image.channels() / (side * side);
    Planes::from_fn(channels, image.height() * side, image.width() * side, |c, y, x| {
        image.at((y % side * side + x % side) * channels + c, y / side, x / side)
    })
}

/// The pixels of squares of four as channels, at half the resolution: space to depth.
fn folded(image: &Planes) -> Planes {
    let channels = image.channels();
    Planes::from_fn(4 * channels, image.height() / 2, image.width() / 2, |c, y, x| {
        let (square, c) = (c / channels, c % channels);
        image.at(c, 2 * y + square / 2, 2 * x + square % 2)
    })
}

fn run(spec: &NetSpec, weights: &Weights, input: &Planes) -> Vec<Planes> {
    assert_eq!(input.channels(), spec.input_channels(), "channels of the network's input");
    assert!(weights.fit(spec), "the weights belong to the spec");
    let input = padded(input, spec.alignment());
    let mut made = Vec::new();
    for (layer, weights) in spec.layers().iter().zip(&weights.0) {
        made.push(self::layer(spec, layer, weights, &input, &made));
    }
    made
}

/// One layer: what comes before the convolution, the convolution, the activation. `input` is the padded
/// input, and `made` what the earlier layers made of it.
pub(crate) fn layer(
    spec: &NetSpec,
    layer: &Layer,
    weights: &LayerWeights,
    input: &Planes,
    made: &[Planes],
) -> Planes {
    let convolved = |image: &Planes| convolved(image, layer, weights);
    let mut image = match layer.source {
        BlockSource::Input => convolved(input),
        BlockSource::Folded => convolved(&folded(input)),
        BlockSource::Plain(from) => convolved(&made[from]),
        BlockSource::Pooled(from) => convolved(&pooled(&made[from])),
        BlockSource::Joined { coarse, skip, groups } => {
            convolved(&joined(&doubled(&made[coarse]), &made[skip], groups))
        }
    };
    if layer.activation {
        image.data_mut().iter_mut().for_each(|value| *value = leaky(*value, spec.leak));
    }
    image
}

/// The image continued at bottom and right by its last row and column, up to a multiple of `alignment`.
pub(crate) fn padded(image: &Planes, alignment: usize) -> Planes {
    let (height, width) = (image.height(), image.width());
    Planes::from_fn(
        image.channels(),
        height.next_multiple_of(alignment),
        width.next_multiple_of(alignment),
        |c, y, x| image.at(c, y.min(height - 1), x.min(width - 1)),
    )
}

/// Leaky ReLU.
fn leaky(value: f32, leak: f32) -> f32 {
    if value < 0.0 { leak * value } else { value }
}

/// Grouped convolution (a correlation, as everywhere in this field) with zeros around the image, plus bias.
fn convolved(image: &Planes, layer: &Layer, weights: &LayerWeights) -> Planes {
    let kernel = layer.kernel;
    let (height, width) = (image.height(), image.width());
    let share = layer.inputs / layer.groups;
    let mut made = Planes::filled(layer.outputs, height, width, 0.0);
    made.data_mut().par_chunks_mut(width).enumerate().for_each(|(index, row)| {
        let (output, y) = (index / height, index % height);
        let group = output / (layer.outputs / layer.groups);
        row.fill(weights.bias[output]);
        for input in 0..share {
            let plane = image.plane(group * share + input);
            for ky in 0..kernel {
                let Some(sy) = (y + ky).checked_sub(kernel / 2).filter(|sy| *sy < height) else { continue };
                let first = ((output * share + input) * kernel + ky) * kernel;
                let taps = &weights.weight[first..first + kernel];
                add_row(row, &plane[sy * width..][..width], taps);
            }
        }
    });
    made
}

/// Adds one row of an image, weighted by one row of a kernel, to a row of sums.
fn add_row(sums: &mut [f32], row: &[f32], taps: &[f32]) {
    let (width, radius) = (row.len(), taps.len() / 2);
    for (kx, weight) in taps.iter().enumerate() {
        let first = radius.saturating_sub(kx);
        let end = (width + radius).saturating_sub(kx).min(width);
        if first < end {
            let shifted = &row[first + kx - radius..];
            sums[first..end].iter_mut().zip(shifted).for_each(|(sum, value)| *sum += weight * value);
        }
    }
}

/// Means of 2x2 pixels.
fn pooled(image: &Planes) -> Planes {
    Planes::from_fn(image.channels(), image.height() / 2, image.width() / 2, |c, y, x| {
        let at = |dy, dx| image.at(c, 2 * y + dy, 2 * x + dx);
        0.25 * (at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1))
    })
}

/// Twice the size by bilinear interpolation between pixel centres, the edge continued outwards: every new
/// pixel is 3/4 the old pixel it lies in and 1/4 the next one, along each axis.
fn doubled(image: &Planes) -> Planes {
    let (height, width) = (image.height(), image.width());
    let wide = Planes::from_fn(image.channels(), height, 2 * width, |c, y, x| {
        let (near, far) = neighbours(x, width);
        0.75 * image.at(c, y, near) + 0.25 * image.at(c, y, far)
    });
    Planes::from_fn(image.channels(), 2 * height, 2 * width, |c, y, x| {
        let (near, far) = neighbours(y, height);
        0.75 * wide.at(c, near, x) + 0.25 * wide.at(c, far, x)
    })
}

/// The old pixel in which new pixel `at` lies, and the next one on the side towards which it lies.
fn neighbours(at: usize, size: usize) -> (usize, usize) {
    let near = at / 2;
    let far = if at.is_multiple_of(2) { near.saturating_sub(1) } else { (near + 1).min(size - 1) };
    (near, far)
}

/// The two images one after the other, their channels dealt out in groups.
fn joined(coarse: &Planes, skip: &Planes, groups: usize) -> Planes {
    let order = joined_order(coarse.channels(), skip.channels(), groups);
    let mut data = Vec::with_capacity(order.len() * skip.pixels());
    for channel in &order {
        data.extend_from_slice(match channel.checked_sub(coarse.channels()) {
            None => coarse.plane(*channel),
            Some(channel) => skip.plane(channel),
        });
    }
    Planes::from_data(order.len(), skip.height(), skip.width(), data)
}

#[cfg(test)]
mod tests;
