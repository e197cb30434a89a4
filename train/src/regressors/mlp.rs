//! A shallow perceptron on patches, as in the thesis (7.5.5): two hidden layers of 50 nodes, then the value. What
//! lies between its layers the thesis does not say; here it is a ReLU.

use super::patches::{Frames, patches_of_rows};
use crate::rng::{Purpose, Rng};
use crate::{Optimiser, TrainError};
use burn::module::{Module, Param, ParamId};
use burn::optim::GradientsParams;
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_dataset::progress;
use deepshade_shaders::Planes;
use rayon::prelude::*;

/// Nodes of a hidden layer.
const HIDDEN: usize = 50;
/// Rows of an image whose patches are in memory at a time.
const ROWS: usize = 8;
/// The highest rate of training.
const RATE: f64 = 1e-3;

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
    layers: Layers,
    edge: usize,
}

#[derive(Module, Debug)]
struct Layers {
    layers: Vec<Dense>,
}

/// A layer of nodes, each of which sees all of those before.
#[derive(Module, Debug)]
struct Dense {
    /// `[inputs, outputs]`.
    weight: Param<Tensor<2>>,
    /// `[1, outputs]`.
    bias: Param<Tensor<2>>,
}

impl Mlp {
    /// Trains a perceptron on patches of `edge` x `edge` pixels, odd.
    ///
    /// # Errors
    /// If the loss is no number any more.
    pub fn train(frames: &Frames, edge: usize, schedule: Schedule) -> Result<Self, TrainError> {
        let Schedule { steps, batch, seed } = schedule;
        let device = crate::device().autodiff();
        let mut layers = Layers::random(frames.patch_len(edge), seed, &device);
        let optimiser = Optimiser::Adamw { rate: RATE, weight_decay: 1e-4, warm_up: steps.div_ceil(10) };
        let mut adamw = optimiser.start();
        let bar = progress::bar("steps", steps, 0);
        for step in 0..steps {
            let examples = frames.examples(edge, batch, seed, step as u64);
            let patches = rows(examples.patches, batch, &device);
            let difference = layers.forward(patches) - rows(examples.targets, batch, &device);
            let loss = (difference.clone() * difference).mean();
            let value: f32 = loss.clone().into_scalar();
            if !value.is_finite() {
                return Err(TrainError::Diverged { step, loss: value });
            }
            let gradients = GradientsParams::from_grads(loss.backward(), &layers);
            layers = adamw.step(optimiser.rate(step, steps), layers, gradients);
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(Self { layers: layers.on(&crate::device()), edge })
    }

    /// Number of weights and biases.
    pub fn weight_count(&self) -> usize {
        self.layers.num_params()
    }

    /// What it makes of a network's input, pixel by pixel: `[channels, height, width]` to `[1, height, width]`.
    pub fn image(&self, input: &Planes) -> Planes {
        let (height, width) = (input.height(), input.width());
        let device = crate::device();
        let parts: Vec<Vec<f32>> = (0..height.div_ceil(ROWS))
            .into_par_iter()
            .map(|part| {
                let range = part * ROWS..((part + 1) * ROWS).min(height);
                let count = range.len() * width;
                let patches = rows(patches_of_rows(input, self.edge, range), count, &device);
                let values = self.layers.forward(patches).into_data();
                values.try_into_vec::<f32>().expect("images are f32")
            })
            .collect();
        Planes::from_data(1, height, width, parts.concat())
    }
}

impl Layers {
    /// Normal weights of variance `2 / inputs` (He et al. 2015), biases 0.
    fn random(inputs: usize, seed: u64, device: &Device) -> Self {
        let sizes = [inputs, HIDDEN, HIDDEN, 1];
        let dense = |index: usize| {
            let (inputs, outputs) = (sizes[index], sizes[index + 1]);
            let mut rng = Rng::new(seed, Purpose::Weights, index as u64);
            let deviation = (2.0 / inputs as f64).sqrt();
            let weight = (0..inputs * outputs).map(|_| (deviation * rng.normal()) as f32).collect();
            let id = |part: u64| ParamId::from(2 * index as u64 + part);
            let param =
                |id, tensor: Tensor<2>| Param::initialized(id, tensor.set_require_grad(device.is_autodiff()));
            Dense {
                weight: param(id(0), rows(weight, inputs, device)),
                bias: param(id(1), rows(vec![0.0; outputs], 1, device)),
            }
        };
        Self { layers: (0..sizes.len() - 1).map(dense).collect() }
    }

    /// The values of patches: `[patches, numbers of a patch]` to `[patches, 1]`.
    fn forward(&self, patches: Tensor<2>) -> Tensor<2> {
        let last = self.layers.len() - 1;
        self.layers.iter().enumerate().fold(patches, |x, (index, layer)| {
            let sums = x.matmul(layer.weight.val()) + layer.bias.val();
            if index == last { sums } else { relu(sums) }
        })
    }

    /// The same on another device.
    fn on(&self, device: &Device) -> Self {
        let moved = |param: &Param<Tensor<2>>| {
            let tensor = Tensor::from_data(param.val().into_data(), device);
            Param::initialized(param.id, tensor.set_require_grad(device.is_autodiff()))
        };
        let dense = |layer: &Dense| Dense { weight: moved(&layer.weight), bias: moved(&layer.bias) };
        Self { layers: self.layers.iter().map(dense).collect() }
    }
}

/// Numbers as so many rows.
fn rows(numbers: Vec<f32>, count: usize, device: &Device) -> Tensor<2> {
    let shape = [count, numbers.len() / count];
    Tensor::from_data(TensorData::new(numbers, shape), device)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regressors::patches::tests::{error, noise};

    #[test]
    fn it_learns_what_lies_in_a_patch() {
        let (frames, input, target) = noise();
        let schedule = Schedule { steps: 3000, batch: 64, seed: 1 };
        let mlp = Mlp::train(&frames, 3, schedule).expect("trains");
        let untrained = Mlp::train(&frames, 3, Schedule { steps: 1, ..schedule }).expect("trains");
        let errors = [&mlp, &untrained].map(|mlp| error(&mlp.image(&input), &target));
        assert!(errors[0] < 0.01 && errors[1] > 0.1, "{errors:?}");
        assert_eq!(mlp.weight_count(), 9 * 50 + 50 + 50 * 50 + 50 + 50 + 1);
        let again = Mlp::train(&frames, 3, schedule).expect("trains");
        assert_eq!(again.image(&input), mlp.image(&input), "the same seed");
    }
}
