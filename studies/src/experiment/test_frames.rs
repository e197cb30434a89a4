//! What networks and other regressors are scored on: the frames of a test set, in memory.

use anyhow::Result;
use deepshade::shared::statistics::{MeanInterval, estimate};
use deepshade_dataset::testset::gather;
use deepshade_dataset::{SceneRecord, StagedScene, TestFrame, TestSet};
use deepshade_render::gbuffer;
use deepshade_render::metrics::{exposed, flip, ssim};
use deepshade_shaders::{Effect, GBuffer, Planes};

/// The frames of a test set.
pub struct TestFrames {
    effect: Effect,
    frames: Vec<ScoredFrame>,
}

/// A frame of which an image is wanted.
struct ScoredFrame {
    /// Which scene it is from.
    scene: usize,
    gbuffer: GBuffer,
    /// How far the effect reaches, metres.
    radius: f32,
    /// What images are multiplied by before they are compared.
    exposure: f32,
    /// Truth of some tiles, or all, and of some frames as wholes.
    truth: TestFrame,
    /// How far the halves of truth agree.
    ceiling: f64,
}

/// How near to truth images are: means over scenes.
#[derive(Clone, Copy, Debug)]
pub struct Scores {
    /// Structural similarity.
    pub ssim: MeanInterval,
    /// Mean absolute difference.
    pub l1: f64,
    /// Mean squared difference.
    pub l2: f64,
    /// Mean FLIP of the frames that are kept whole.
    pub flip: f64,
}

impl Scores {
    /// Structural similarity with the interval that holds it with 95 % confidence.
    pub const fn similarity(&self) -> [f64; 3] {
        [self.ssim.mean, self.ssim.low, self.ssim.high]
    }

    /// Structural dissimilarity.
    pub const fn dssim(&self) -> f64 {
        0.5 * (1.0 - self.ssim.mean)
    }
}

/// Columns of [`Scores::similarity`].
pub const SIMILARITY: [(&str, usize); 3] = [("SSIM", 4), ("95 % from", 4), ("to", 4)];

impl TestFrames {
    /// Renders the g-buffers of a test set and reads its truth.
    ///
    /// # Errors
    /// If a file is missing or damaged.
    pub fn open(set: &TestSet) -> Result<Self> {
        let recipe = set.recipe();
        let props = set.props()?;
        // Frames of a scene follow each other, so that a scene is built once.
        let mut current: Option<(&SceneRecord, StagedScene<'_>)> = None;
        let (mut frames, mut scenes) = (Vec::new(), 0);
        for (index, record) in set.frames().iter().enumerate() {
            let staged = match current.take() {
                Some((source, staged)) if *source == record.scene => staged,
                _ => {
                    scenes += 1;
                    StagedScene::load(&record.scene, recipe, &props)?
                }
            };
            let scene = staged.shown(&record.camera, record.variation.as_ref())?;
            let (height, width) = (recipe.resolution.height, recipe.resolution.width);
            let attributes = recipe.effect.attributes();
            frames.push(ScoredFrame {
                scene: scenes,
                gbuffer: gbuffer::render(&scene, &record.camera, height, width, attributes),
                radius: record.radius,
                exposure: record.exposure,
                truth: set.frame(index)?,
                ceiling: record.ceiling.ssim,
            });
            current = Some((&record.scene, staged));
        }
        Ok(Self { effect: recipe.effect, frames })
    }

    /// The g-buffer of the first frame, and how far the effect reaches there, metres.
    pub fn first(&self) -> (&GBuffer, f32) {
        (&self.frames[0].gbuffer, self.frames[0].radius)
    }

    /// Scores of whoever makes these images of g-buffers and radii in metres.
    ///
    /// # Errors
    /// If an image cannot be made.
    pub fn scores(&self, image: impl Fn(&GBuffer, f32) -> Result<Planes>) -> Result<Scores> {
        let images = self.frames.iter().map(|ScoredFrame { gbuffer, radius, .. }| image(gbuffer, *radius));
        self.scores_of(images)
    }

    /// Scores of whoever makes these images of its frames.
    ///
    /// # Errors
    /// If an image could not be made.
    pub fn scores_of(&self, images: impl Iterator<Item = Result<Planes>>) -> Result<Scores> {
        let (mut ssims, mut l1s, mut l2s, mut flips) = (vec![], vec![], vec![], vec![]);
        for (ScoredFrame { scene, exposure, truth, .. }, image) in self.frames.iter().zip(images) {
            let image = exposed(&image?, *exposure);
            let (tiles, expected) = (gather(&image, &truth.tiles), exposed(&truth.truth, *exposure));
            ssims.push((*scene, ssim(&tiles, &expected)));
            l1s.push((*scene, mean_difference(&tiles, &expected, f64::abs)));
            l2s.push((*scene, mean_difference(&tiles, &expected, |difference| difference * difference)));
            flips.extend(truth.whole.iter().map(|whole| (*scene, flip(&image, &exposed(whole, *exposure)))));
        }
        let [l1, l2, flip] = [l1s, l2s, flips].map(|values| match values.is_empty() {
            true => f64::NAN,
            false => estimate(&values).mean,
        });
        Ok(Scores { ssim: estimate(&ssims), l1, l2, flip })
    }

    /// Scores of whoever computes nothing.
    ///
    /// # Errors
    /// As [`TestFrames::scores`].
    pub fn trivial(&self) -> Result<Scores> {
        self.scores(|gbuffer, _| Ok(self.effect.doing_nothing(gbuffer)))
    }

    /// What a perfect image would at least score, in words.
    pub fn ceiling(&self) -> String {
        let ceilings: Vec<(usize, f64)> =
            self.frames.iter().map(|frame| (frame.scene, frame.ceiling)).collect();
        let (frames, mean) = (self.frames.len(), estimate(&ceilings).mean);
        format!("{frames} frames, half of truth's samples against the other half: SSIM {mean:.4}")
    }
}

fn mean_difference(a: &Planes, b: &Planes, of: impl Fn(f64) -> f64) -> f64 {
    let differences = a.data().iter().zip(b.data()).map(|(a, b)| of(f64::from(*a) - f64::from(*b)));
    differences.sum::<f64>() / a.data().len() as f64
}
