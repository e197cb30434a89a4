//! Batches: pairs decoded, cropped and turned on threads of their own, in an order that depends on seed and
//! step only.

use crate::feed::Feed;
use crate::loss::Target;
use crate::pairs::{HalfPair, Scale};
use crate::rng::{Purpose, Rng};
use crate::{Stop, TrainConfig, TrainError};
use burn::tensor::{Device, Tensor, TensorData};
use deepshade_dataset::{Pair, Symmetry, augment};
use deepshade_infer::NetSpec;
use deepshade_shaders::Planes;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

/// Batches that a worker may be ahead.
pub const AHEAD: usize = 2;
/// How often whoever waits for a batch looks whether it is still wanted.
const GLANCE: Duration = Duration::from_millis(100);
/// A crop that shows fewer surfaces is drawn again, ...
const VALID_SHARE: f32 = 0.25;
/// ... so many times.
const DRAWS: usize = 8;

/// Images that a network reads, with what it should make of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    images: usize,
    size: [usize; 2],
    input: Vec<f32>,
    target: Vec<f32>,
    variance: Vec<f32>,
    valid: Vec<f32>,
    exposure: Vec<f32>,
}

/// A batch as tensors, `[images, channels, height, width]`.
pub struct Tensors {
    /// What the network reads.
    pub input: Tensor<4>,
    /// What it should make, exposed.
    pub target: Target,
    /// What its image is multiplied by to be compared with `target`: `[images, 1, 1, 1]`.
    pub exposure: Tensor<4>,
}

impl Batch {
    /// Adds what one of the network's [runs](NetSpec::runs) reads and makes of a pair, with the same
    /// [input](NetSpec::input) that the network gets wherever it runs.
    pub fn push(&mut self, pair: &Pair, Scale { scaling, exposure }: Scale, spec: &NetSpec, run: usize) {
        let input =
            spec.input(&pair.gbuffer, scaling, run).expect("pairs are kept with what the network reads");
        let seen = pair.gbuffer.seen().expect("pairs are kept with their validity");
        self.images += 1;
        self.size = [input.height(), input.width()];
        self.input.extend_from_slice(input.data());
        let values = spec.output_channels() * pair.target.pixels();
        let of_run = |image: &Planes| image.data()[run * values..][..values].to_vec();
        self.target.extend(of_run(&pair.target).iter().map(|value| exposure * value));
        let variance = pair.variance.as_ref().map_or_else(|| vec![0.0; values], of_run);
        self.variance.extend(variance.iter().map(|value| exposure * exposure * value));
        self.exposure.push(exposure / scaling.light);
        // Light that spreads from surfaces over what is beside them counts there, too.
        let everywhere = spec.inputs.iter().any(|input| spec.is_everywhere(*input));
        self.valid.extend(seen.into_iter().map(|seen| f32::from(u8::from(seen || everywhere))));
    }

    /// Number of images.
    pub const fn images(&self) -> usize {
        self.images
    }

    /// The images in their order, dealt out as evenly as can be; at most one share an image.
    pub fn shared(mut self, shares: usize) -> Vec<Self> {
        let mut left = self.images;
        let mut shared = Vec::with_capacity(shares);
        for share in 0..shares {
            let images = left.div_ceil(shares - share);
            let taken = |data: &mut Vec<f32>| {
                let rest = data.split_off(data.len() / left * images);
                std::mem::replace(data, rest)
            };
            shared.push(Self {
                images,
                size: self.size,
                input: taken(&mut self.input),
                target: taken(&mut self.target),
                variance: taken(&mut self.variance),
                valid: taken(&mut self.valid),
                exposure: taken(&mut self.exposure),
            });
            left -= images;
        }
        shared
    }

    /// As tensors.
    pub fn into_tensors(self, device: &Device) -> Tensors {
        let pixels = self.size[0] * self.size[1];
        let [input, image, variance, valid] =
            [self.input, self.target, self.variance, self.valid].map(|data| {
                let channels = data.len() / self.images / pixels;
                let shape = [self.images, channels, self.size[0], self.size[1]];
                Tensor::from_data(TensorData::new(data, shape), device)
            });
        let exposure = TensorData::new(self.exposure, [self.images, 1, 1, 1]);
        let target = Target { image, variance, valid };
        Tensors { input, target, exposure: Tensor::from_data(exposure, device) }
    }
}

/// What decides which crops a run sees.
struct Sampler {
    feed: Arc<Feed>,
    config: TrainConfig,
}

impl Sampler {
    /// The batch of a step.
    fn batch(&self, step: usize) -> Result<Batch, TrainError> {
        let mut batch = Batch::default();
        for position in step * self.config.batch..(step + 1) * self.config.batch {
            let (pair, scale, run) = self.crop(position)?;
            batch.push(&pair, scale, &self.config.spec, run);
        }
        Ok(batch)
    }

    /// The crop at a position in the training, what its numbers are multiplied by, and which of the network's
    /// runs is trained on it.
    fn crop(&self, position: usize) -> Result<(Pair, Scale, usize), TrainError> {
        let (index, pair) = self.feed.pair(self.config.seed, position)?;
        let mut rng = Rng::new(self.config.seed, Purpose::Crop, position as u64);
        let crop = cut(&pair, self.config.crop, &mut rng).ok_or_else(|| TrainError::Pair {
            index,
            problem: format!("is {} by {}, smaller than `crop`", pair.height(), pair.width()),
        })?;
        let symmetries = Symmetry::of(self.config.spec.effect);
        let turned = augment(&crop, symmetries[rng.below(symmetries.len())]);
        Ok((turned, pair.scale(), rng.below(self.config.spec.runs())))
    }
}

/// A random square window that shows something, where a few draws find one.
fn cut(pair: &HalfPair, size: usize, rng: &mut Rng) -> Option<Pair> {
    let rows = (pair.height() + 1).checked_sub(size)?;
    let columns = (pair.width() + 1).checked_sub(size)?;
    let mut corner = [0; 2];
    for _ in 0..DRAWS {
        corner = [rng.below(rows), rng.below(columns)];
        if pair.valid_share(corner[0], corner[1], size, size) >= VALID_SHARE {
            break;
        }
    }
    Some(pair.window(corner[0], corner[1], size, size))
}

/// Threads that make batches ahead of the training.
pub struct Loader {
    /// One a worker; worker `w` makes the steps that leave remainder `w`.
    batches: Vec<Receiver<Result<Batch, TrainError>>>,
    step: usize,
}

impl Loader {
    /// Starts making batches from a step on, up to the config's last.
    pub fn start(feed: &Arc<Feed>, config: &TrainConfig, step: usize) -> Self {
        let sampler = Arc::new(Sampler { feed: Arc::clone(feed), config: config.clone() });
        let workers = config.workers;
        let start = |worker: usize| {
            let (sender, receiver) = sync_channel(AHEAD);
            let sampler = Arc::clone(&sampler);
            let steps = (step..config.steps).filter(move |step| step % workers == worker);
            thread::spawn(move || work(&sampler, steps, &sender));
            receiver
        };
        Self { batches: (0..workers).map(start).collect(), step }
    }

    /// The next step's batch; none where the run is asked to end while it is waited for.
    ///
    /// # Errors
    /// If one of its pairs cannot be read.
    pub fn next(&mut self, stop: &Stop) -> Result<Option<Batch>, TrainError> {
        let worker = self.step % self.batches.len();
        self.step += 1;
        while !stop.is_asked() {
            match self.batches[worker].recv_timeout(GLANCE) {
                Ok(batch) => return batch.map(Some),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    unreachable!("a worker lives until its last step or error was taken")
                }
            }
        }
        Ok(None)
    }
}

/// Makes batches until all are made, one fails, or nobody wants them any more.
fn work(
    sampler: &Sampler,
    steps: impl Iterator<Item = usize>,
    sender: &SyncSender<Result<Batch, TrainError>>,
) {
    for step in steps {
        let batch = sampler.batch(step);
        let failed = batch.is_err();
        if sender.send(batch).is_err() || failed {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach, Scaling};
    use deepshade_shaders::{Attribute, Effect, GBuffer};

    #[test]
    fn a_batch_holds_what_the_network_reads_its_targets_and_where_they_count() {
        let reach = Reach { radius: 0.5, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let attributes = vec![Attribute::Position, Attribute::Valid, Attribute::Normal];
        let pair = Pair {
            gbuffer: GBuffer::new(
                attributes,
                Planes::from_fn(7, 1, 2, |c, _, x| if c == 3 { x as f32 } else { (10 * c + x) as f32 }),
            ),
            target: Planes::filled(1, 1, 2, 0.25),
            variance: None,
            radius: 2.0,
        };
        let mut batch = Batch::default();
        let scale = Scale::new(&pair, &spec).expect("no light is read");
        batch.push(&pair, scale, &spec, 0);
        batch.push(&pair, scale, &spec, 0);
        // Of the first pixel nothing is seen; positions are scaled by the trained over the wanted radius.
        let image = [0.0, 41.0, 0.0, 51.0, 0.0, 61.0, 0.0, 0.25, 0.0, 2.75, 0.0, 5.25];
        assert_eq!(batch.input, [image, image].concat());
        assert_eq!(batch.input[..12], *spec.input(&pair.gbuffer, scale.scaling, 0).expect("an input").data());
        assert_eq!(batch.valid, [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(batch.target, [0.25; 4]);
        assert_eq!(batch.exposure, [1.0; 2]);
        let Tensors { input, target, exposure } = batch.into_tensors(&crate::device());
        let shapes =
            [input, target.image, target.variance, target.valid, exposure].map(|tensor| tensor.dims());
        assert_eq!(shapes, [[2, 6, 1, 2], [2, 1, 1, 2], [2, 1, 1, 2], [2, 1, 1, 2], [2, 1, 1, 1]]);
    }

    #[test]
    fn a_run_of_a_mono_network_gets_its_own_colour_channel() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::published(Effect::Aa, ChannelOrder::Interleaved, reach).expect("it has one");
        let attributes = vec![Attribute::Depth, Attribute::Light, Attribute::Valid];
        let pair = Pair {
            gbuffer: GBuffer::new(attributes, Planes::from_fn(5, 1, 1, |c, _, _| (c + 1) as f32)),
            target: Planes::from_fn(3, 1, 1, |c, _, _| 0.1 * c as f32),
            variance: Some(Planes::from_fn(3, 1, 1, |c, _, _| 0.01 * c as f32)),
            radius: 1.0,
        };
        let mut batch = Batch::default();
        let scale = Scale { scaling: Scaling { length: 1.0, light: 0.5 }, exposure: 3.0 };
        batch.push(&pair, scale, &spec, 2);
        batch.push(&pair, Scale::new(&pair, &spec).expect("there is light"), &spec, 0);
        // The light of the first is halved, of the second that of the brightest but one is 1, as its target
        // is.
        assert_eq!(batch.input, [1.0, 2.0, 1.0, 2.0 / 3.0]);
        assert_eq!((batch.target, batch.exposure), (vec![3.0 * 0.2, 0.0], vec![6.0, 30.0]));
        assert_eq!(batch.variance, [9.0 * 0.02, 0.0]);
    }
}
