//! The filter's image and its gradient by what the last convolution makes, a row of the image at a time. The light is data.

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

/// What the filter was run with: of every image its light, and of every row of every image its weights, `[taps, width]`.
#[derive(Clone)]
pub struct Run {
    lights: Arc<[Light]>,
    weights: Arc<[Vec<f32>]>,
}

impl std::fmt::Debug for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run").field("images", &self.lights.len()).finish_non_exhaustive()
    }
}

impl Run {
    /// Of `made` `[batch, taps, height, width]` and `light` `[batch, channels, height, width]`.
    pub fn new(filter: Filter, made: &Cpu, light: &Cpu) -> Self {
        let [_, channels, height, width] = dims(light);
        let lights = numbers(light)
            .par_chunks_exact(channels * height * width)
            .map(|light| Light::new(filter, Planes::from_data(channels, height, width, light.to_vec())));
        let rows = 0..dims::<4>(made)[0] * height;
        let weights = rows.into_par_iter().map(|row| softmax(image(made), row / height, row % height));
        let (lights, weights): (Vec<_>, Vec<_>) = (lights.collect(), weights.collect());
        Self { lights: lights.into(), weights: weights.into() }
    }

    /// The image, `[batch, channels, height, width]`, of `made`'s height and width.
    pub fn image(&self, [height, width]: [usize; 2]) -> Cpu {
        self.stacked([height, width], |light, weights, _, y| weighted(light, weights, y, width))
    }

    /// The gradient by what the last convolution makes, `[batch, taps, height, width]`, given that by the image.
    fn gradient(&self, dy: &Cpu) -> Cpu {
        let [_, channels, height, width] = dims(dy);
        let dy = numbers(dy);
        self.stacked([height, width], |light, weights, index, y| {
            let row = |channel| &dy[((index * channels + channel) * height + y) * width..][..width];
            let mut by_weight = vec![0.0; weights.len()];
            light.visit_taps(y, width, |tap, channel, light| {
                let (gradient, dy) = (&mut by_weight[tap * width..][..width], row(channel));
                for x in 0..width {
                    gradient[x] += dy[x] * light[x];
                }
            });
            softmax_backward(weights, by_weight, width)
        })
    }

    /// What is made of every row of every image given its light, its weights, its number and the row's, as images.
    fn stacked(
        &self,
        [height, width]: [usize; 2],
        row: impl Fn(&Light, &[f32], usize, usize) -> Vec<f32> + Sync,
    ) -> Cpu {
        let rows = (0..self.weights.len()).into_par_iter();
        let rows: Vec<Vec<f32>> = rows
            .map(|at| row(&self.lights[at / height], &self.weights[at], at / height, at % height))
            .collect();
        let images = self.lights.len();
        let data: Vec<Vec<f32>> = rows.par_chunks_exact(height).map(|rows| planar(rows, width)).collect();
        let data = data.concat();
        let channels = data.len() / (images * height * width);
        tensor(data, [images, channels, height, width])
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
    type State = Run;

    fn backward(self, ops: Ops<Run, 1>, grads: &mut Gradients, _: &mut Checkpointer) {
        let dy = grads.consume::<Flex>(&ops.node).to_contiguous();
        if let [Some(made)] = ops.parents {
            grads.register::<Flex>(made.id, ops.state.gradient(&dy));
        }
    }
}
