//! Convolutions that know which of their pixels count (Liu et al. 2018, "Image inpainting for irregular holes using partial
//! convolutions", equation 1): pixels outside the image and pixels that show nothing are left out, and sums are multiplied by
//! the kernel's area over the number of pixels that were left. Unlike there, pixels that do not count stay so in all layers.

use crate::UNet;
use crate::device::ops::convolve;
use crate::plain::{join, leaky};
use burn::tensor::Tensor;
use burn::tensor::module::avg_pool2d;
use burn::tensor::ops::{AvgPoolOptions, PadMode};
use deepshade_infer::Source;

/// The network's image.
///
/// # Shapes
/// `x` `[batch, input channels, height, width]` and `valid` `[batch, 1, height, width]`, 1 where a surface is seen.
pub fn forward(net: &UNet, x: Tensor<4>, valid: Tensor<4>) -> Tensor<4> {
    let [_, _, height, width] = x.dims();
    let spec = net.spec();
    let missing = |size: usize| size.next_multiple_of(spec.alignment()) - size;
    let pads = (0, missing(width), 0, missing(height));
    let [x, valid] = [x, valid].map(|image| image.pad(pads, PadMode::Constant(0.0)));
    let masks = masks(valid, spec.levels);
    let mut made: Vec<Tensor<4>> = Vec::new();
    for (layer, weight, bias) in net.parts() {
        let image = match layer.source {
            Source::Input => x.clone(),
            Source::Plain(from) => made[from].clone(),
            Source::Pooled(from) => pooled(made[from].clone(), masks[layer.level - 1].clone()),
            Source::Joined { coarse, skip } => {
                join(made[coarse].clone(), made[skip].clone(), spec.join_groups(layer.groups))
            }
        };
        let sums = masked(image, masks[layer.level].clone(), weight, bias);
        made.push(if layer.activation { leaky(sums, spec.leak) } else { sums });
    }
    let image = made.pop().expect("a network has a layer");
    image.narrow(2, 0, height).narrow(3, 0, width)
}

/// Which pixels count on every level: those of which one below them counts.
fn masks(valid: Tensor<4>, levels: usize) -> Vec<Tensor<4>> {
    let mut masks = vec![valid];
    for level in 1..levels {
        masks.push(halved(masks[level - 1].clone()).sign());
    }
    masks
}

/// The means of those of 2x2 pixels that count.
fn pooled(image: Tensor<4>, mask: Tensor<4>) -> Tensor<4> {
    halved(image * mask.clone()) * inverse(halved(mask))
}

/// A grouped convolution of the pixels that count, with bias.
pub fn masked(image: Tensor<4>, mask: Tensor<4>, weight: Tensor<4>, bias: Tensor<1>) -> Tensor<4> {
    let [outputs, _, kernel, _] = weight.dims();
    let device = mask.device();
    let none = |count: usize| Tensor::<1>::zeros([count], &device);
    let mean = Tensor::<4>::full([1, 1, kernel, kernel], 1.0 / (kernel * kernel) as f64, &device);
    let share = convolve(mask.clone(), mean, none(1), false, 1.0);
    let sums = convolve(image * mask, weight, none(outputs), false, 1.0);
    sums * inverse(share) + bias.reshape([1, outputs, 1, 1])
}

/// One over a share of pixels, and 0 where none counts.
fn inverse(share: Tensor<4>) -> Tensor<4> {
    share.clone().sign() / share.clamp_min(1e-3)
}

fn halved(image: Tensor<4>) -> Tensor<4> {
    avg_pool2d(image, AvgPoolOptions::new([2, 2]))
}
