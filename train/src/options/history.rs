//! A network that reads what it made of the frame before, carried along to where its surfaces are now, so that its images
//! flicker less (Chaitanya et al. 2017, "Interactive reconstruction of Monte Carlo image sequences using a recurrent denoising
//! autoencoder"; as Thomas et al. 2020, "A reduced-precision network for image reconstruction", do, the image goes around and
//! not hidden features).

use super::fitted;
use crate::first_weights::of_layers;
use crate::loss::Target;
use crate::net::{to_planes, to_tensor};
use crate::rng::{Purpose, Rng};
use crate::{TrainConfig, TrainError, UNet};
use burn::tensor::{Device, Tensor};
use deepshade_infer::{Layer, NetSpec};
use deepshade_shaders::Planes;

/// Films to train on: frames that follow each other.
pub trait Films {
    /// Number of films.
    fn count(&self) -> usize;

    /// The frames of a film.
    ///
    /// # Errors
    /// If they cannot be had; the message names the file.
    fn frames(&self, film: usize) -> Result<Vec<Still>, String>;
}

/// A frame of a film.
#[derive(Clone, Debug)]
pub struct Still {
    /// What the network reads beside its history, `[input channels, height, width]`.
    pub input: Planes,
    /// What it should make, `[output channels, height, width]`.
    pub target: Planes,
    /// Variance of the noise of `target`, of its shape.
    pub variance: Planes,
    /// 1 where a surface is seen, `[1, height, width]`.
    pub valid: Planes,
    /// Where the surfaces were in the frame before.
    pub carry: Carry,
}

/// Where the surface of each pixel was in the frame before: pixels by their index, with weights that add up to 1, or are 0
/// where it was not seen.
#[derive(Clone, Debug)]
pub struct Carry(pub Vec<[(usize, f32); 4]>);

/// Whether a network knows what came before, and is asked to keep to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// Nothing: what it would read of the frame before is 0.
    None,
    /// It reads its own image of the frame before.
    Image,
    /// It also loses by what it changes and truth does not (Chaitanya et al. 2017, section 3.4.2).
    Kept,
}

/// A trained network.
pub struct Recurrent {
    memory: Memory,
    net: UNet,
}

impl Carry {
    /// What nothing came before.
    pub fn nothing(pixels: usize) -> Self {
        Self(vec![[(0, 0.0); 4]; pixels])
    }

    /// An image of the frame before where its surfaces are now, and as a last channel where they were seen, 1 or 0.
    pub fn carried(&self, before: &Planes) -> Planes {
        let [channels, height, width] = [before.channels(), before.height(), before.width()];
        Planes::from_fn(channels + 1, height, width, |channel, y, x| {
            let taps = self.0[y * width + x].iter().filter(|(_, weight)| *weight > 0.0);
            if channel == channels {
                return f32::from(u8::from(taps.count() > 0));
            }
            taps.map(|(at, weight)| weight * before.plane(channel)[*at]).sum()
        })
    }
}

impl Recurrent {
    /// Trains a network on whole films, as many a step as the settings' batch, for their number of steps.
    ///
    /// # Errors
    /// If the settings make no sense, a film cannot be had, or the loss is no number any more.
    pub fn train(memory: Memory, config: &TrainConfig, films: &dyn Films) -> Result<Self, TrainError> {
        config.check()?;
        let device = crate::device().autodiff();
        let layers = layers(&config.spec);
        let first = of_layers(&config.spec, &layers, &[], config.seed);
        let first = UNet::with_layers(&config.spec, layers.clone(), &first, &device);
        let net = fitted(config, first, |net, step| {
            Ok(film_loss(memory, config, net, &batch(config, films, step)?, &device))
        })?;
        Ok(Self { memory, net: UNet::with_layers(&config.spec, layers, &net.weights(), &crate::device()) })
    }

    /// The network's image of a frame, given that of the frame before.
    pub fn image(&self, still: &Still, before: Option<&Planes>) -> Planes {
        let history = history(self.memory, still, before);
        to_planes(self.net.forward(to_tensor(&[&joined(&still.input, &history)], &crate::device())))
    }
}

/// The layers of the paper's network, of which the first also reads the history.
fn layers(spec: &NetSpec) -> Vec<Layer> {
    let mut layers = spec.layers();
    layers.iter_mut().take(1).for_each(|first| first.inputs += spec.output_channels() + 1);
    layers
}

/// What a network reads of the frame before, `[output channels + 1, height, width]`.
fn history(memory: Memory, still: &Still, before: Option<&Planes>) -> Planes {
    let target = &still.target;
    match (memory, before) {
        (Memory::Image | Memory::Kept, Some(before)) => still.carry.carried(before),
        _ => Planes::filled(target.channels() + 1, target.height(), target.width(), 0.0),
    }
}

/// Images of the same size as channels of one.
fn joined(a: &Planes, b: &Planes) -> Planes {
    Planes::from_data(a.channels() + b.channels(), a.height(), a.width(), [a.data(), b.data()].concat())
}

/// The films of a step, each once an epoch, each epoch in another order.
fn batch(config: &TrainConfig, films: &dyn Films, step: usize) -> Result<Vec<Vec<Still>>, TrainError> {
    let position = |number: usize| step * config.batch + number;
    let film = |number: usize| {
        let (epoch, at) = (position(number) / films.count(), position(number) % films.count());
        let order = Rng::new(config.seed, Purpose::Order, epoch as u64).permutation(films.count());
        films.frames(order[at]).map_err(|problem| TrainError::Pair { index: order[at], problem })
    };
    (0..config.batch).map(film).collect()
}

/// The mean loss over the frames of films of one length. Histories are taken as given: no gradient goes through them.
fn film_loss(
    memory: Memory,
    config: &TrainConfig,
    net: &UNet,
    films: &[Vec<Still>],
    device: &Device,
) -> Tensor<1> {
    let length = films.iter().map(Vec::len).min().unwrap_or(0);
    let mut before: Vec<Option<[Planes; 2]>> = vec![None; films.len()];
    let mut sum = Tensor::<1>::zeros([1], device);
    for frame in 0..length {
        let stills: Vec<&Still> = films.iter().map(|film| &film[frame]).collect();
        let read: Vec<Planes> = stills
            .iter()
            .zip(&before)
            .map(|(still, before)| {
                joined(&still.input, &history(memory, still, before.as_ref().map(|[made, _]| made)))
            })
            .collect();
        let tensor = |images: Vec<&Planes>| to_tensor(&images, device);
        let made = net.forward(tensor(read.iter().collect()));
        let image = tensor(stills.iter().map(|still| &still.target).collect());
        let variance = tensor(stills.iter().map(|still| &still.variance).collect());
        let valid = tensor(stills.iter().map(|still| &still.valid).collect());
        sum = sum + config.loss.of(made.clone(), Target { image: image.clone(), variance, valid });
        if memory == Memory::Kept && frame > 0 {
            sum = sum + change(made.clone(), image, &stills, &before, device);
        }
        let images = made.detach().split(1, 0).into_iter().map(to_planes);
        before = images.zip(&stills).map(|(made, still)| Some([made, still.target.clone()])).collect();
    }
    sum / length as f32
}

/// The mean absolute difference between how images changed since the frame before and how truth did, where surfaces were
/// seen in both.
fn change(
    made: Tensor<4>,
    target: Tensor<4>,
    stills: &[&Still],
    before: &[Option<[Planes; 2]>],
    device: &Device,
) -> Tensor<1> {
    let carried = |which: usize| -> Tensor<4> {
        let images: Vec<Planes> = stills
            .iter()
            .zip(before)
            .filter_map(|(still, before)| Some(still.carry.carried(&before.as_ref()?[which])))
            .collect();
        to_tensor(&images.iter().collect::<Vec<_>>(), device)
    };
    let [images, truths] = [carried(0), carried(1)];
    let channels = made.dims()[1];
    let seen = images.clone().narrow(1, channels, 1);
    let [images, truths] = [images, truths].map(|carried| carried.narrow(1, 0, channels));
    (((made - images) - (target - truths)) * seen).abs().mean()
}

#[cfg(test)]
mod tests;
