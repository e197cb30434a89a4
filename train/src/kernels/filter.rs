//! The filter's image and its gradient by what the last convolution makes, a row of the image at a time. The
//! light is data.

use super::{Cpu, dims, image, numbers, tensor};
use burn::backend::Flex;
use burn::backend::autodiff::checkpoint::base::Checkpointer;
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops};
use deepshade_infer::Filter;
use deepshade_infer::cpu::filter::{Light, planar, softmax, weighted};
use deepshade_shaders::Planes;
use rayon::prelude::*;
use std::sync::Arc;

/// What the filter was run with: the light of every image, and what the last convolution made,
/// `[batch, weights, height, width]`.
#[derive(Clone, Debug)]
pub struct FilterState {
    lights: Arc<[Light]>,
    made: Cpu,
}

impl FilterState {
    /// Of `made` `[batch, weights, height, width]` and `light` `[batch, channels, height, width]`.
    pub fn new(filter: Filter, made: Cpu, light: &Cpu) -> Self {
        let [_, channels, height, width] = dims(light);
        let lights = numbers(light)
            .par_chunks_exact(channels * height * width)
            .map(|light| Light::new(filter, Planes::from_data(channels, height, width, light.to_vec())));
        let lights: Vec<Light> = lights.collect();
        Self { lights: lights.into(), made }
    }

    /// The image, `[batch, channels, height, width]`.
    pub fn image(&self) -> Cpu {
        let width = image(&self.made).width;
        self.stacked(|light, weights, _, y| weighted(light, &weights, y, width))
    }

    /// The gradient by what the last convolution made, given that by the image.
    fn gradient(&self, dy: &Cpu) -> Cpu {
        let [_, channels, height, width] = dims(dy);
        let dy = numbers(dy);
        self.stacked(|light, weights, index, y| {
            let mut by_weight = vec![0.0; weights.len()];
            light.visit_taps(y, width, |tap, channel, light| {
                let gradient = &mut by_weight[tap * width..][..width];
                let dy = &dy[((index * channels + channel) * height + y) * width..][..width];
                for x in 0..width {
                    gradient[x] += dy[x] * light[x];
                }
            });
            softmax_backward(&weights, by_weight, width)
        })
    }

    /// What is made of every row given its image's light, its weights, `[weights, width]`, and the numbers of
    /// image and row, put together to images.
    fn stacked(&self, row: impl Fn(&Light, Vec<f32>, usize, usize) -> Vec<f32> + Sync) -> Cpu {
        let made = image(&self.made);
        let images = self.lights.iter().enumerate().map(|(index, light)| {
            let row = |y| row(light, softmax(made, index, y), index, y);
            let rows: Vec<Vec<f32>> = (0..made.height).into_par_iter().map(row).collect();
            planar(&rows, made.width)
        });
        let images: Vec<Vec<f32>> = images.collect();
        let channels = images[0].len() / (made.height * made.width);
        tensor(images.concat(), [images.len(), channels, made.height, made.width])
    }
}

/// The gradient by what a softmax over rows of `width` is of, given that by its weights.
fn softmax_backward(weights: &[f32], mut by_weight: Vec<f32>, width: usize) -> Vec<f32> {
    let mut mean = vec![0.0; width];
    for (weights, by_weight) in weights.chunks_exact(width).zip(by_weight.chunks_exact(width)) {
        for x in 0..width {
            mean[x] += weights[x] * by_weight[x];
        }
    }
    for (weights, by_weight) in weights.chunks_exact(width).zip(by_weight.chunks_exact_mut(width)) {
        for x in 0..width {
            by_weight[x] = weights[x] * (by_weight[x] - mean[x]);
        }
    }
    by_weight
}

/// The backward step of the filter.
#[derive(Debug)]
pub struct Filtered;

impl Backward<Flex, 1> for Filtered {
    type State = FilterState;

    fn backward(self, ops: Ops<FilterState, 1>, grads: &mut Gradients, _: &mut Checkpointer) {
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        if let [Some(made)] = ops.parents {
            grads.register::<Flex>(made.id, ops.state.gradient(&dy));
        }
    }
}
