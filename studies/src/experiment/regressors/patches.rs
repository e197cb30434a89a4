//! Patches: what regressors read of an image, and the examples that they learn from.

use super::Random;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::Dataset;
use deepshade_infer::NetSpec;
use deepshade_shaders::{Planes, lists};

/// Pairs as regressors read them.
pub struct Frames {
    frames: Vec<Frame>,
    channels: usize,
}

/// What a network would read of a pair, and what it should make.
struct Frame {
    /// `[input channels, height, width]`.
    input: Planes,
    /// `[1, height, width]`.
    target: Planes,
    /// Indices of the pixels that show a surface; there is one.
    seen: Vec<usize>,
}

/// Patches with the values of the pixels in their middles.
pub struct Examples {
    /// `[examples, channels * edge * edge]`, row by row.
    pub patches: Vec<f32>,
    /// `[examples]`.
    pub targets: Vec<f32>,
}

impl Frames {
    /// At most so many of the pairs that a dataset has for training, spread evenly; those that show nothing
    /// are left out.
    ///
    /// # Errors
    /// If the network makes more than one channel, a pair cannot be read or lacks what the network reads, or
    /// none shows a surface.
    pub fn read(dataset: &Dataset, spec: &NetSpec, most: usize) -> Result<Self> {
        ensure!(spec.effect.channels() == 1, "regressors of patches make single values, and no colours");
        let training = dataset.training();
        let mut frames = Vec::new();
        for index in lists::spread(training.len(), most).into_iter().map(|index| training[index]) {
            let frame = Frame::read(dataset, spec, index).with_context(|| format!("pair {index}"))?;
            frames.extend(Some(frame).filter(|frame| !frame.seen.is_empty()));
        }
        ensure!(!frames.is_empty(), "the dataset has no pair for training that shows a surface");
        Ok(Self { frames, channels: spec.input_channels() })
    }

    /// Channels of what is read.
    pub const fn channels(&self) -> usize {
        self.channels
    }

    /// Numbers of a patch.
    pub const fn patch_len(&self, edge: usize) -> usize {
        self.channels * edge * edge
    }

    /// Examples around pixels that show a surface, drawn uniformly, first the frame, then the pixel; the same
    /// for the same seed and counter.
    pub fn examples(&self, edge: usize, count: usize, seed: u64, counter: u64) -> Examples {
        let mut rng = Random::new(seed, counter);
        let mut patches = Vec::with_capacity(count * self.patch_len(edge));
        let mut targets = Vec::with_capacity(count);
        for _ in 0..count {
            let Frame { input, target, seen } = &self.frames[rng.below(self.frames.len())];
            let pixel = seen[rng.below(seen.len())];
            let (y, x) = (pixel / input.width(), pixel % input.width());
            push_patch(input, edge, y, x, &mut patches);
            targets.push(target.at(0, y, x));
        }
        Examples { patches, targets }
    }
}

impl Frame {
    fn read(dataset: &Dataset, spec: &NetSpec, index: usize) -> Result<Self> {
        let pair = dataset.pair(index)?;
        let scaling = spec.scaling(&pair.gbuffer, pair.radius)?;
        let input = spec.input(&pair.gbuffer, scaling, 0)?;
        let seen = pair.gbuffer.seen()?;
        let seen = (0..seen.len()).filter(|pixel| seen[*pixel]).collect();
        Ok(Self { input, target: pair.target, seen })
    }
}

/// The patches of all pixels of some rows of an image, row by row: `[rows * width, channels * edge * edge]`.
pub fn patches_of_rows(input: &Planes, edge: usize, rows: std::ops::Range<usize>) -> Vec<f32> {
    let mut patches = Vec::with_capacity(rows.len() * input.width() * input.channels() * edge * edge);
    for y in rows {
        (0..input.width()).for_each(|x| push_patch(input, edge, y, x, &mut patches));
    }
    patches
}

/// Appends the patch around a pixel, `[channels, edge, edge]`; beyond the image its last rows and columns are
/// repeated.
fn push_patch(input: &Planes, edge: usize, y: usize, x: usize, patches: &mut Vec<f32>) {
    let inside = |at: usize, offset: usize, size: usize| (at + offset).saturating_sub(edge / 2).min(size - 1);
    let width = input.width();
    let first = (x >= edge / 2 && x - edge / 2 + edge <= width).then(|| x - edge / 2);
    for channel in 0..input.channels() {
        let plane = input.plane(channel);
        for row in 0..edge {
            let line = &plane[inside(y, row, input.height()) * width..][..width];
            match first {
                Some(first) => patches.extend_from_slice(&line[first..first + edge]),
                None => patches.extend((0..edge).map(|column| line[inside(x, column, width)])),
            }
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Frames of one image of noise, it, and what is to be learned of it: half of a pixel and a quarter of
    /// its left neighbour's size. Its variance is 0.27.
    pub fn noise() -> (Frames, Planes, Planes) {
        let input = deepshade_infer::parity::noise(1, 24, 30, 5);
        let value =
            |y: usize, x: usize| 0.5 * input.at(0, y, x) + 0.25 * input.at(0, y, x.saturating_sub(1)).abs();
        let target = Planes::from_fn(1, 24, 30, |_, y, x| value(y, x));
        let frame = Frame { input: input.clone(), target: target.clone(), seen: (0..24 * 30).collect() };
        (Frames { frames: vec![frame], channels: 1 }, input, target)
    }

    /// Mean squared difference.
    pub fn error(a: &Planes, b: &Planes) -> f32 {
        let differences = a.data().iter().zip(b.data()).map(|(a, b)| a - b);
        differences.map(|difference| difference * difference).sum::<f32>() / a.data().len() as f32
    }

    fn input() -> Planes {
        Planes::from_fn(2, 4, 5, |c, y, x| (100 * c + 10 * y + x) as f32)
    }

    #[test]
    fn a_patch_lies_around_its_pixel() {
        let mut patch = Vec::new();
        push_patch(&input(), 3, 1, 2, &mut patch);
        let lines = [1, 11, 21, 101, 111, 121];
        let expected: Vec<f32> =
            lines.iter().flat_map(|first| (0..3).map(move |x| (first + x) as f32)).collect();
        assert_eq!(patch, expected);
    }

    #[test]
    fn edges_are_repeated() {
        let mut patch = Vec::new();
        push_patch(&input(), 3, 3, 0, &mut patch);
        assert_eq!(patch[..9], [20.0, 20.0, 21.0, 30.0, 30.0, 31.0, 30.0, 30.0, 31.0]);
        patch.clear();
        push_patch(&input(), 3, 0, 4, &mut patch);
        assert_eq!(patch[..9], [3.0, 4.0, 4.0, 3.0, 4.0, 4.0, 13.0, 14.0, 14.0]);
    }

    #[test]
    fn rows_hold_the_patches_of_their_pixels() {
        let rows = patches_of_rows(&input(), 3, 1..3);
        let mut last = Vec::new();
        push_patch(&input(), 3, 2, 4, &mut last);
        assert_eq!((rows.len(), &rows[9 * 18..]), (10 * 18, &last[..]));
    }

    #[test]
    fn examples_are_of_seen_pixels_and_the_same_for_a_seed() {
        let (input, target) = (input(), Planes::from_fn(1, 4, 5, |_, y, x| (10 * y + x) as f32));
        let frames = Frames { frames: vec![Frame { input, target, seen: vec![7, 12] }], channels: 2 };
        let examples = |seed| frames.examples(3, 40, seed, 0);
        let drawn = examples(1);
        // What is in the middle of a patch is what the target is, so that patch and target belong together.
        let middles: Vec<f32> = drawn.patches.chunks_exact(18).map(|patch| patch[4]).collect();
        assert_eq!(middles, drawn.targets);
        assert!(drawn.targets.contains(&12.0) && drawn.targets.iter().all(|t| [12.0, 22.0].contains(t)));
        assert_eq!(drawn.targets, examples(1).targets);
        assert_ne!(drawn.targets, examples(2).targets);
    }
}
