//! Where pairs come from, and pairs as training keeps them: only what the network reads and is held against,
//! as half floats.

use crate::TrainError;
use deepshade_dataset::{Dataset, EstimateError, EstimateInputs, Estimator, Manifest, Pair, with_estimates};
use deepshade_infer::{AnalyticEstimate, NetSpec, Scaling};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, exposure, shows_surface};
use half::f16;
use half::slice::HalfFloatSliceExt;
use std::sync::{Arc, OnceLock};

/// Something that pairs are read from by their index.
pub trait PairSource: Send + Sync {
    /// What tells these pairs from all others.
    ///
    /// # Errors
    /// If it cannot be found out; the message names the file.
    fn hash(&self) -> Result<String, String>;

    /// Number of pairs.
    fn count(&self) -> usize;

    /// Indices of the pairs to train on.
    fn training(&self) -> Vec<usize>;

    /// Indices of the pairs that are held apart from training.
    fn validation(&self) -> Vec<usize>;

    /// Reads a pair.
    ///
    /// # Errors
    /// If it cannot be read; the message names the file.
    fn read(&self, index: usize) -> Result<Pair, String>;
}

impl PairSource for Dataset {
    fn hash(&self) -> Result<String, String> {
        Manifest::file_hash(self.folder()).map_err(|error| error.to_string())
    }

    fn count(&self) -> usize {
        self.len()
    }

    fn training(&self) -> Vec<usize> {
        Self::training(self)
    }

    fn validation(&self) -> Vec<usize> {
        Self::validation(self)
    }

    fn read(&self, index: usize) -> Result<Pair, String> {
        self.pair(index).map_err(|error| error.to_string())
    }
}

/// A pair as half floats: the channels that a network reads, validity, and the target with the root of its
/// variance, which half floats hold where they would round variance to nothing.
#[derive(Debug)]
pub struct HalfPair {
    attributes: Vec<Attribute>,
    height: usize,
    width: usize,
    gbuffer: Vec<f16>,
    /// What the g-buffer's planes were divided by, powers of two: half floats do not hold a position 100 km
    /// away.
    divisors: Vec<f32>,
    target: Vec<f16>,
    deviation: Option<Vec<f16>>,
    radius: f32,
    scale: Scale,
}

/// What the numbers of a pair are multiplied by, found from the whole of it and the same in all its windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What the network's input is.
    pub scaling: Scaling,
    /// What image and target are before they are compared, as wherever images are compared.
    pub exposure: f32,
}

impl Scale {
    /// That of a pair.
    ///
    /// # Errors
    /// If its g-buffer lacks light that the network reads.
    pub fn new(pair: &Pair, spec: &NetSpec) -> Result<Self, MissingAttribute> {
        let scaling = spec.scaling(&pair.gbuffer, pair.radius)?;
        Ok(Self { scaling, exposure: exposure::of_image(spec.effect, &pair.target) })
    }
}

/// The methods whose images a network reads.
fn estimators(spec: &NetSpec) -> Result<Vec<Estimator>, EstimateError> {
    let named = |estimate: &AnalyticEstimate| {
        Estimator::named(estimate.effect(spec.effect), &estimate.method, &estimate.quality)
    };
    spec.estimates.iter().map(named).collect()
}

impl HalfPair {
    /// A pair with what the network's estimates and its other inputs are made of; `seed` chooses the
    /// estimates' random numbers.
    pub fn new(pair: &Pair, spec: &NetSpec, seed: u32) -> Result<Self, String> {
        if !(pair.radius.is_finite() && pair.radius > 0.0) {
            return Err(format!("its radius is {}", pair.radius));
        }
        let inputs = EstimateInputs { gbuffer: &pair.gbuffer, radius: pair.radius, seed, scene: None };
        let gbuffer = estimators(spec).and_then(|estimators| with_estimates(&inputs, &estimators));
        let gbuffer = gbuffer.map_err(|error| error.to_string())?;
        let gbuffer = spec.prepared(&gbuffer, pair.radius).map_err(|error| error.to_string())?;
        let mut attributes = spec.inputs.clone();
        if !attributes.contains(&Attribute::Valid) {
            attributes.push(Attribute::Valid);
        }
        let planes = gbuffer.select(&attributes).map_err(|error| error.to_string())?;
        let (height, width) = (planes.height(), planes.width());
        let shape = [pair.target.channels(), pair.target.height(), pair.target.width()];
        let expected = [spec.effect.channels(), height, width];
        if shape != expected {
            return Err(format!("its target is {shape:?}, expected {expected:?}"));
        }
        if pair.variance.as_ref().is_some_and(|variance| !variance.same_shape(&pair.target)) {
            return Err(format!("its variance is not of the target's shape, {shape:?}"));
        }
        let divisors: Vec<f32> =
            (0..planes.channels()).map(|channel| divisor(planes.plane(channel))).collect();
        let divided = (0..planes.channels())
            .flat_map(|channel| planes.plane(channel).iter().map(move |value| (channel, *value)));
        let divided = divided.map(|(channel, value)| value / divisors[channel]).collect();
        Ok(Self {
            attributes,
            height,
            width,
            gbuffer: halves(&Planes::from_data(planes.channels(), height, width, divided)),
            divisors,
            target: halves(&pair.target),
            deviation: pair.variance.as_ref().map(|variance| halves(&variance.map(deviation))),
            radius: pair.radius,
            scale: Scale::new(pair, spec).map_err(|error| error.to_string())?,
        })
    }

    /// What its numbers are multiplied by.
    pub const fn scale(&self) -> Scale {
        self.scale
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Columns.
    pub const fn width(&self) -> usize {
        self.width
    }

    const fn bytes(&self) -> usize {
        let deviations = match &self.deviation {
            Some(deviation) => deviation.len(),
            None => 0,
        };
        (self.gbuffer.len() + self.target.len() + deviations) * size_of::<f16>()
    }

    /// The share of pixels of a window that show a surface.
    pub fn valid_share(&self, y: usize, x: usize, height: usize, width: usize) -> f32 {
        let first: usize =
            self.attributes.iter().take_while(|a| **a != Attribute::Valid).map(|a| a.width()).sum();
        let valid =
            window(&self.gbuffer[first * self.height * self.width..], self.width, [y, x, height, width]);
        valid.iter().filter(|valid| shows_surface(**valid)).count() as f32 / valid.len() as f32
    }

    /// A window of the pair.
    pub fn window(&self, y: usize, x: usize, height: usize, width: usize) -> Pair {
        let cut = |data: &[f16]| {
            let planes = data.chunks_exact(self.height * self.width);
            let channels = planes.len();
            let data = planes.flat_map(|plane| window(plane, self.width, [y, x, height, width])).collect();
            Planes::from_data(channels, height, width, data)
        };
        let mut planes = cut(&self.gbuffer);
        for (channel, divisor) in self.divisors.iter().enumerate().filter(|(_, divisor)| **divisor != 1.0) {
            planes.plane_mut(channel).iter_mut().for_each(|value| *value *= divisor);
        }
        Pair {
            gbuffer: GBuffer::new(self.attributes.clone(), planes),
            target: cut(&self.target),
            variance: self.deviation.as_ref().map(|deviation| cut(deviation).map(|value| value * value)),
            radius: self.radius,
        }
    }
}

/// The root of a variance, at most the largest half float.
fn deviation(variance: f32) -> f32 {
    variance.sqrt().min(f16::MAX.to_f32())
}

/// The power of two by which half floats hold a plane; 1 wherever they hold it as it is.
fn divisor(plane: &[f32]) -> f32 {
    let most = plane.iter().fold(0.0f32, |most, value| most.max(value.abs()));
    let over = most / f16::MAX.to_f32();
    if over > 1.0 && over.is_finite() { over.log2().ceil().exp2() } else { 1.0 }
}

fn halves(planes: &Planes) -> Vec<f16> {
    let mut halves = vec![f16::ZERO; planes.data().len()];
    halves.convert_from_f32_slice(planes.data());
    halves
}

fn window(plane: &[f16], stride: usize, [y, x, height, width]: [usize; 4]) -> Vec<f32> {
    let mut window = vec![0.0; height * width];
    for (row, window) in window.chunks_exact_mut(width).enumerate() {
        plane[(y + row) * stride + x..][..width].convert_to_f32_slice(window);
    }
    window
}

/// Pairs of a source, kept in memory once read while there is room.
pub struct Cache {
    source: Arc<dyn PairSource>,
    spec: NetSpec,
    pairs: Vec<OnceLock<Arc<HalfPair>>>,
    room: std::sync::atomic::AtomicUsize,
}

impl Cache {
    /// An empty cache with room for so many bytes.
    pub fn new(source: Arc<dyn PairSource>, spec: NetSpec, room: usize) -> Self {
        let pairs = (0..source.count()).map(|_| OnceLock::new()).collect();
        Self { source, spec, pairs, room: room.into() }
    }

    /// A pair.
    ///
    /// # Errors
    /// If it cannot be read or is not what the network needs.
    pub fn pair(&self, index: usize) -> Result<Arc<HalfPair>, TrainError> {
        use std::sync::atomic::Ordering::Relaxed;
        if let Some(pair) = self.pairs[index].get() {
            return Ok(Arc::clone(pair));
        }
        let read = self.source.read(index).and_then(|pair| HalfPair::new(&pair, &self.spec, index as u32));
        let pair = Arc::new(read.map_err(|problem| TrainError::Pair { index, problem })?);
        let bytes = pair.bytes();
        if self.room.fetch_update(Relaxed, Relaxed, |room| room.checked_sub(bytes)).is_ok() {
            // Two threads may have read it at once. The pairs are equal; the later one takes no room.
            if self.pairs[index].set(Arc::clone(&pair)).is_err() {
                self.room.fetch_add(bytes, Relaxed);
            }
        }
        Ok(pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach};
    use std::sync::Barrier;
    use std::sync::atomic::Ordering;

    /// A pair that two threads read at once.
    struct Meeting(Barrier);

    impl PairSource for Meeting {
        fn hash(&self) -> Result<String, String> {
            Ok("meeting".to_owned())
        }

        fn count(&self) -> usize {
            1
        }

        fn training(&self) -> Vec<usize> {
            vec![0]
        }

        fn validation(&self) -> Vec<usize> {
            Vec::new()
        }

        fn read(&self, _: usize) -> Result<Pair, String> {
            self.0.wait();
            let attributes = vec![Attribute::Normal, Attribute::Position, Attribute::Valid];
            let gbuffer = GBuffer::new(attributes, Planes::filled(7, 4, 4, 1.0));
            Ok(Pair { gbuffer, target: Planes::filled(1, 4, 4, 0.5), variance: None, radius: 1.0 })
        }
    }

    #[test]
    fn positions_beyond_half_floats_are_kept() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 4 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let pair = Meeting(Barrier::new(1)).read(0).expect("a pair");
        for (far, divisor) in [(1e3, 1.0), (65_504.0, 1.0), (65_505.0, 2.0), (3e7, 512.0)] {
            let mut planes = pair.gbuffer.planes().clone();
            planes.plane_mut(5).iter_mut().enumerate().for_each(|(at, z)| *z = -far / (1 + at) as f32);
            let gbuffer = GBuffer::new(pair.gbuffer.attributes().to_vec(), planes.clone());
            let half = HalfPair::new(&Pair { gbuffer, ..pair.clone() }, &spec, 0).expect("a pair");
            let channel = |attribute: Attribute| half.attributes.iter().position(|one| *one == attribute);
            let z = half.attributes[..channel(Attribute::Position).expect("it is read")].iter();
            let z = z.map(|attribute| attribute.width()).sum::<usize>() + 2;
            assert_eq!(half.divisors[z], divisor, "{far}");
            let kept = half.window(0, 0, 4, 4).gbuffer;
            for (kept, value) in kept.planes().plane(z).iter().zip(planes.plane(5)) {
                assert!((kept / value - 1.0).abs() < 1e-3, "{kept}, {value}");
            }
        }
    }

    #[test]
    fn the_variance_of_dark_values_is_kept() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 4 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let pair = Meeting(Barrier::new(1)).read(0).expect("a pair");
        let variance = Planes::from_fn(1, 4, 4, |_, y, x| 1e-9 * (1 + 4 * y + x) as f32);
        let pair = Pair { variance: Some(variance), ..pair.clone() };
        let kept =
            HalfPair::new(&pair, &spec, 1).expect("sound").window(2, 1, 1, 3).variance.expect("a variance");
        for (x, value) in kept.data().iter().enumerate() {
            let expected = 1e-9 * (10 + x) as f32;
            assert!((value / expected - 1.0).abs() < 2e-3, "{value} is not {expected}");
        }
        let large = Pair { variance: Some(Planes::filled(1, 4, 4, f32::MAX)), ..pair.clone() };
        let kept =
            HalfPair::new(&large, &spec, 1).expect("sound").window(0, 0, 4, 4).variance.expect("a variance");
        assert!(kept.data().iter().all(|value| value.is_finite()));
        let wrong = Pair { variance: Some(Planes::filled(1, 4, 3, 0.0)), ..pair };
        assert!(HalfPair::new(&wrong, &spec, 1).is_err_and(|problem| problem.contains("its variance")));
    }

    #[test]
    fn a_pair_that_is_read_twice_takes_its_room_once() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 4 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let cache = Cache::new(Arc::new(Meeting(Barrier::new(2))), spec, 1000);
        std::thread::scope(|scope| {
            let other = scope.spawn(|| cache.pair(0).expect("reads"));
            cache.pair(0).expect("reads");
            other.join().expect("ends");
        });
        let bytes = cache.pair(0).expect("kept").bytes();
        assert_eq!(cache.room.load(Ordering::Relaxed), 1000 - bytes);
    }
}
