//! Networks of other shapes than a spec can say, for the study that compares them with the paper's. They are trained on the
//! same crops in the same order; of their weights the last ones count, at the end of the rate's fall.

pub mod history;
mod masked;
mod space_to_depth;

use crate::loader::{Loader, Tensors};
use crate::net::{to_planes, to_tensor};
use crate::pairs::Cache;
use crate::training::Split;
use crate::{PairSource, TrainConfig, TrainError, UNet};
use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_dataset::progress;
use deepshade_infer::{Layer, NetSpec};
use deepshade_shaders::Planes;
use std::sync::Arc;

/// What differs from the paper's network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It works at half the resolution, on the four pixels of a square as four times the channels.
    SpaceToDepth,
    /// Pixels outside the image and those that show nothing do not count.
    Masked,
}

/// A trained network of a kind.
pub struct Variant {
    kind: Kind,
    net: UNet,
}

impl Kind {
    /// The layers of the paper's network, as they are with this difference.
    fn layers(self, spec: &NetSpec) -> Vec<Layer> {
        match self {
            Self::SpaceToDepth => space_to_depth::layers(spec),
            Self::Masked => spec.layers(),
        }
    }

    /// Multiply-adds of the convolutions for a pixel of a run's image.
    pub fn multiply_adds(self, spec: &NetSpec) -> f64 {
        let halved = usize::from(self == Self::SpaceToDepth);
        let of = |layer: &Layer| {
            let products = layer.weight_count(spec.kernel) - layer.outputs;
            products as f64 / (1 << (2 * (layer.level + halved))) as f64
        };
        self.layers(spec).iter().map(of).sum()
    }

    fn first(self, spec: &NetSpec, seed: u64, device: &Device) -> UNet {
        match self {
            Self::SpaceToDepth => space_to_depth::first(spec, seed, device),
            Self::Masked => UNet::random(spec, seed, device),
        }
    }

    /// `[batch, input channels, height, width]` and `[batch, 1, height, width]` to `[batch, output channels, height, width]`.
    fn forward(self, net: &UNet, x: Tensor<4>, valid: Tensor<4>) -> Tensor<4> {
        match self {
            Self::SpaceToDepth => space_to_depth::forward(net, x),
            Self::Masked => masked::forward(net, x, valid),
        }
    }
}

impl Variant {
    /// Trains a network for as many steps as the settings say.
    ///
    /// # Errors
    /// If the settings make no sense, a pair cannot be read, or the loss is no number any more.
    pub fn train(kind: Kind, config: &TrainConfig, source: Arc<dyn PairSource>) -> Result<Self, TrainError> {
        config.check()?;
        let split = Split::new(&*source, config.validation_pairs)?;
        let cache = Arc::new(Cache::new(source, config.spec.clone(), config.cache_megabytes << 20));
        let device = crate::device().autodiff();
        let mut loader = Loader::start(&cache, split.training, config, 0);
        let first = kind.first(&config.spec, config.seed, &device);
        let net = fitted(config, first, |net, _| {
            let Tensors { input, target, exposure } = loader.next()?.into_tensors(&device);
            let image = kind.forward(net, input, target.valid.clone()) * exposure;
            Ok(config.loss.of(image, target))
        })?;
        let layers = kind.layers(&config.spec);
        let net = UNet::with_layers(&config.spec, layers, &net.weights(), &crate::device());
        Ok(Self { kind, net })
    }

    /// A run's image, `[output channels, height, width]`, of its input and of which pixels show a surface.
    pub fn image(&self, input: &Planes, seen: &[bool]) -> Planes {
        let device = crate::device();
        let valid = seen.iter().map(|seen| f32::from(u8::from(*seen))).collect();
        let shape = [1, 1, input.height(), input.width()];
        let valid = Tensor::from_data(TensorData::new::<f32, _>(valid, shape), &device);
        to_planes(self.kind.forward(&self.net, to_tensor(&[input], &device), valid))
    }
}

/// A network after all steps of a run, given what it loses at each.
fn fitted(
    config: &TrainConfig,
    mut net: UNet,
    mut loss: impl FnMut(&UNet, usize) -> Result<Tensor<1>, TrainError>,
) -> Result<UNet, TrainError> {
    let mut optimiser = config.optimiser.start();
    let bar = progress::bar("steps", config.steps, 0);
    for step in 0..config.steps {
        let loss = loss(&net, step)?;
        let value: f32 = loss.clone().into_scalar();
        if !value.is_finite() {
            return Err(TrainError::Diverged { step, loss: value });
        }
        let gradients = GradientsParams::from_grads(loss.backward(), &net);
        net = optimiser.step(config.optimiser.rate(step, config.steps), net, gradients);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(net)
}

#[cfg(test)]
mod tests;
