//! A shallow perceptron on patches, as in the thesis (7.5.5): two hidden layers of 50 nodes, then the value.
//! What lies between its layers the thesis does not say; here it is a ReLU.

use super::Random;
use super::patches::{Examples, Frames, patches_of_rows};
use anyhow::{Result, ensure};
use deepshade_dataset::progress;
use deepshade_shaders::Planes;
use deepshade_train::Optimiser;
use ndarray::{Array2, Axis, Zip};
use rayon::prelude::*;

/// Nodes of a hidden layer.
const HIDDEN: usize = 50;
/// Rows of an image whose patches are in memory at a time.
const ROWS: usize = 8;
/// The highest rate of training.
const RATE: f64 = 1e-3;
/// How much of themselves Adam's means of gradients and of their squares keep.
const BETAS: [f32; 2] = [0.9, 0.99];
/// What roots of those squares are kept away from 0 by.
const EPSILON: f32 = 1e-8;

/// How a perceptron is trained.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    /// Steps of the optimiser.
    pub steps: usize,
    /// Patches a step, drawn anew.
    pub batch: usize,
    /// Seed of weights and patches.
    pub seed: u64,
}

/// A trained perceptron.
pub struct Mlp {
    layers: Vec<Dense>,
    edge: usize,
}

/// A layer of nodes, each of which sees all of those before.
struct Dense {
    /// `[inputs, outputs]`.
    weight: Parameter,
    /// `[1, outputs]`.
    bias: Parameter,
}

/// Numbers that are learned, with Adam's means (Kingma and Ba 2015).
struct Parameter {
    value: Array2<f32>,
    mean: Array2<f32>,
    square: Array2<f32>,
}

impl Mlp {
    /// Trains a perceptron on patches of `edge` x `edge` pixels, odd.
    ///
    /// # Errors
    /// If the loss is no number any more.
    pub fn train(frames: &Frames, edge: usize, schedule: Schedule) -> Result<Self> {
        let Schedule { steps, batch, seed } = schedule;
        let mut mlp = Self { layers: random(frames.patch_len(edge), seed), edge };
        let rates = Optimiser::Adamw { rate: RATE, weight_decay: 0.0, warm_up: steps.div_ceil(10) };
        let bar = progress::bar("steps", steps, 0);
        for step in 0..steps {
            let Examples { patches, targets } = frames.examples(edge, batch, seed, step as u64);
            let mut made = mlp.forward(rows(patches, batch)?);
            let difference = made.pop().expect("a layer's") - rows(targets, batch)?;
            let loss = difference.pow2().mean().unwrap_or(f32::NAN);
            ensure!(loss.is_finite(), "the perceptron's loss is {loss} at step {step}");
            mlp.learn(&made, difference * (2.0 / batch as f32), rates.rate(step, steps) as f32, step);
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(mlp)
    }

    /// What it makes of a network's input, pixel by pixel: `[channels, height, width]` to `[1, height,
    /// width]`.
    ///
    /// # Errors
    /// If the input has other channels than those that it was trained on.
    pub fn image(&self, input: &Planes) -> Result<Planes> {
        let (height, width) = (input.height(), input.width());
        let part = |part: usize| -> Result<Vec<f32>> {
            let range = part * ROWS..((part + 1) * ROWS).min(height);
            let count = range.len() * width;
            let patches = rows(patches_of_rows(input, self.edge, range), count)?;
            ensure!(patches.ncols() == self.layers[0].weight.value.nrows(), "trained on other channels");
            Ok(self.forward(patches).pop().expect("a layer's").into_iter().collect())
        };
        let parts: Vec<Vec<f32>> =
            (0..height.div_ceil(ROWS)).into_par_iter().map(part).collect::<Result<_>>()?;
        Ok(Planes::from_data(1, height, width, parts.concat()))
    }

    /// Patches, `[patches, numbers of a patch]`, what each hidden layer makes of them, and the values,
    /// `[patches, 1]`.
    fn forward(&self, patches: Array2<f32>) -> Vec<Array2<f32>> {
        let mut made = vec![patches];
        for (index, layer) in self.layers.iter().enumerate() {
            let sums = made[index].dot(&layer.weight.value) + &layer.bias.value;
            made.push(if index + 1 == self.layers.len() { sums } else { sums.mapv(|sum| sum.max(0.0)) });
        }
        made
    }

    /// One step of Adam, by what each layer read and the gradient of the values.
    fn learn(&mut self, read: &[Array2<f32>], values: Array2<f32>, rate: f32, step: usize) {
        let mut gradient = values;
        for (layer, read) in self.layers.iter_mut().zip(read).rev() {
            let below = gradient.dot(&layer.weight.value.t());
            layer.weight.learn(&read.t().dot(&gradient), rate, step);
            layer.bias.learn(&gradient.sum_axis(Axis(0)).insert_axis(Axis(0)), rate, step);
            // What a ReLU has cut off has no gradient.
            gradient = below * read.mapv(|value| if value > 0.0 { 1.0 } else { 0.0 });
        }
    }
}

impl Parameter {
    fn new(value: Array2<f32>) -> Self {
        let zeros = Array2::zeros(value.raw_dim());
        Self { value, mean: zeros.clone(), square: zeros }
    }

    fn learn(&mut self, gradient: &Array2<f32>, rate: f32, step: usize) {
        let unbiased = BETAS.map(|beta| 1.0 / (1.0 - beta.powi(step as i32 + 1)));
        let all = Zip::from(&mut self.value).and(&mut self.mean).and(&mut self.square).and(gradient);
        all.for_each(|value, mean, square, &gradient| {
            *mean += (1.0 - BETAS[0]) * (gradient - *mean);
            *square += (1.0 - BETAS[1]) * (gradient * gradient - *square);
            *value -= rate * *mean * unbiased[0] / ((*square * unbiased[1]).sqrt() + EPSILON);
        });
    }
}

/// Layers with normal weights of variance `2 / inputs` (He et al. 2015), biases 0.
fn random(inputs: usize, seed: u64) -> Vec<Dense> {
    let sizes = [inputs, HIDDEN, HIDDEN, 1];
    let layers = sizes.windows(2).enumerate().map(|(index, size)| {
        let mut random = Random::new(seed, u64::MAX - index as u64);
        let deviation = (2.0 / size[0] as f64).sqrt();
        let weight = Array2::from_shape_fn((size[0], size[1]), |_| (deviation * random.normal()) as f32);
        Dense { weight: Parameter::new(weight), bias: Parameter::new(Array2::zeros((1, size[1]))) }
    });
    layers.collect()
}

/// Numbers as so many rows.
fn rows(numbers: Vec<f32>, count: usize) -> Result<Array2<f32>> {
    Ok(Array2::from_shape_vec((count, numbers.len() / count), numbers)?)
}

#[cfg(test)]
mod tests {
    use super::super::patches::tests::{error, noise};
    use super::*;

    #[test]
    fn it_learns_what_lies_in_a_patch() {
        let (frames, input, target) = noise();
        let schedule = Schedule { steps: 3000, batch: 64, seed: 1 };
        let mlp = Mlp::train(&frames, 3, schedule).expect("trains");
        let untrained = Mlp::train(&frames, 3, Schedule { steps: 1, ..schedule }).expect("trains");
        let image = |mlp: &Mlp| mlp.image(&input).expect("an image");
        let errors = [&mlp, &untrained].map(|mlp| error(&image(mlp), &target));
        assert!(errors[0] < 0.01 && errors[1] > 0.1, "{errors:?}");
        let again = Mlp::train(&frames, 3, schedule).expect("trains");
        assert_eq!(image(&again), image(&mlp), "the same seed");
        assert!(mlp.image(&Planes::filled(2, 4, 4, 0.0)).is_err(), "other channels");
    }
}
