//! Making a test set.

use super::{
    Ceiling, FrameRecord, HashedFile, LIST, List, TestSet, gather, in_tiles, tile_indices, tiles_of,
};
use crate::generate::by_scene;
use crate::journal::{Journal, checked};
use crate::manifest::write_json;
use crate::origin::{Origin, Out};
use crate::plan::{PlannedScene, PlannedView, spread};
use crate::random::mix;
use crate::recipe::{Resolution, Tiles};
use crate::target::{self, TargetMethod};
use crate::{DatasetError, Props, Recipe, StagedScene, progress, truth};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::method::Frame;
use deepshade_render::metrics::{exposed, exposure, ssim};
use deepshade_render::path::{Goal, Sampling, Shot, Truth, render};
use deepshade_shaders::Planes;
use deepshade_shaders::atomic_file;
use indicatif::ProgressBar;
use std::collections::HashMap;
use std::path::Path;

impl TestSet {
    /// Makes the test set of a recipe in a folder, or what is still missing of it; [`TestSet::estimate`] says
    /// how long that takes. The same recipe gives the same bytes, however often the program was killed on the
    /// way.
    ///
    /// # Errors
    /// If the recipe is not for testing or has no `tiles`, a scene cannot be had or has no fit view, or the
    /// folder cannot be written, is in use or holds other data.
    pub fn generate(recipe: &Recipe, folder: &Path) -> Result<Self, DatasetError> {
        Self::generate_by(recipe, folder, None)
    }

    /// [`TestSet::generate`] for recipes that aim at the images of a method, which `method` is.
    ///
    /// # Errors
    /// Those of [`TestSet::generate`], and if the recipe aims at something else or the method fails.
    pub fn generate_by<'a>(
        recipe: &Recipe,
        out: impl Into<Out<'a>>,
        method: Option<TargetMethod<'_>>,
    ) -> Result<Self, DatasetError> {
        target::check(recipe, method)?;
        let tiles = tiles_of(recipe)?;
        let plan = recipe.plan()?;
        let out = out.into();
        let folder = out.folder;
        let origin = Origin::new(recipe, &plan, out)?;
        let earlier = earlier_frames(folder, &origin)?;
        let (journal, mut entries) = Journal::open(folder, &["tiles", "whole"], LIST, &origin)?;
        entries.extend(earlier);
        let known = checked(folder, entries);
        let total = recipe.scene_count() * recipe.views_per_scene;
        let bar = progress::bar("frames", total, known.len());
        let props = Props::load(recipe)?;
        let context = FrameContext {
            recipe,
            method,
            props: &props,
            tiles,
            total,
            folder,
            journal: &journal,
            known: &known,
            bar: &bar,
        };
        let list = List { origin, frames: by_scene(&plan, |index, scene| context.scene(index, scene))? };
        bar.finish_and_clear();
        write_json(&folder.join(LIST), &list)?;
        journal.finish()?;
        Self::open(folder)
    }
}

/// The frames of a test set that is whole, or was before a file was damaged.
fn earlier_frames(folder: &Path, ours: &Origin) -> Result<Vec<FrameRecord>, DatasetError> {
    if !folder.join(LIST).exists() {
        return Ok(Vec::new());
    }
    let List { origin, frames } = List::load(folder)?;
    origin.check_same(ours, folder)?;
    Ok(frames)
}

/// What all frames share.
struct FrameContext<'a> {
    recipe: &'a Recipe,
    method: Option<TargetMethod<'a>>,
    props: &'a Props,
    tiles: Tiles,
    total: usize,
    folder: &'a Path,
    journal: &'a Journal,
    known: &'a HashMap<String, FrameRecord>,
    bar: &'a ProgressBar,
}

impl FrameContext<'_> {
    /// All frames of a scene, which is only loaded if one of them is missing.
    fn scene(&self, index: usize, scene: &PlannedScene) -> Result<Vec<FrameRecord>, DatasetError> {
        let known = |view: &PlannedView| self.known.get(&view.name).cloned();
        if let Some(records) = scene.views.iter().map(known).collect() {
            return Ok(records);
        }
        let staged = StagedScene::load(&scene.scene, self.recipe, self.props)?;
        let first = index * self.recipe.views_per_scene;
        let record = |view: &PlannedView| {
            let whole = spread(first + view.index, self.total, self.tiles.whole_frames.min(self.total));
            known(view).map_or_else(|| self.frame(scene, &staged, view, whole), Ok)
        };
        staged.each(&scene.views, record)
    }

    /// Renders a frame's truth and writes it.
    fn frame(
        &self,
        planned: &PlannedScene,
        staged: &StagedScene<'_>,
        view: &PlannedView,
        whole: bool,
    ) -> Result<FrameRecord, DatasetError> {
        let Resolution { height, width } = self.recipe.resolution;
        let (camera, variation) = staged.drawn(planned.key, view)?;
        let radius = staged.radius(&camera, view.seed);
        let scene = staged.shown(&camera, variation.as_ref())?;
        let tiles = tile_indices(view.seed, height, width, self.tiles.one_in);
        let gbuffer = staged.gbuffer(&scene, &camera, view.seed);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: view.seed };
        let target = match self.method {
            Some(method) => ScoringTarget::of_method(method, &frame, &tiles)?,
            None => self.truth(&frame, &tiles, whole),
        };
        let write = |folder: &str, samples: u32, image: &Planes| self.write(folder, view, samples, image);
        let record = FrameRecord {
            name: view.name.clone(),
            scene: planned.scene.clone(),
            view: view.index,
            camera,
            radius,
            seed: view.seed,
            variation,
            exposure: target.exposure,
            ceiling: target.ceiling,
            tiles: write("tiles", target.samples, &target.tiles)?,
            whole: target
                .whole
                .filter(|_| whole)
                .map(|(image, samples)| write("whole", samples, &image))
                .transpose()?,
        };
        self.journal.add(&record)?;
        self.bar.inc(1);
        Ok(record)
    }

    /// Truth on the tiles, and of the whole frame where that is kept.
    fn truth(&self, frame: &Frame<'_>, tiles: &[usize], whole: bool) -> ScoringTarget {
        let Recipe { effect, resolution, samples, .. } = *self.recipe;
        let shot = Shot::new(frame.scene, frame.camera, [resolution.height, resolution.width], frame.radius);
        let stream = |stream: u64| mix(&[u64::from(frame.seed), stream]) as u32;
        let goal = Goal::samples(self.tiles.samples);
        let rendered = Truth::render(effect, &shot, goal, stream(0), in_tiles(tiles, resolution.width));
        let image = truth::within_half(gather(&rendered.estimate.mean, tiles));
        let exposure = exposure(effect, &image);
        ScoringTarget {
            exposure,
            ceiling: ceiling(&rendered, tiles, exposure),
            tiles: image,
            samples: rendered.estimate.samples,
            whole: whole.then(|| {
                let whole = render(effect, &shot, Sampling::one(samples, stream(1)));
                (truth::within_half(whole.mean), whole.samples)
            }),
        }
    }

    fn write(
        &self,
        folder: &str,
        view: &PlannedView,
        samples: u32,
        image: &Planes,
    ) -> Result<HashedFile, DatasetError> {
        let file = format!("{folder}/{}.exr", view.name);
        let path = self.folder.join(&file);
        let metadata = Metadata::from([
            ("samples".to_owned(), samples.to_string()),
            ("units".to_owned(), truth::units(self.recipe.effect)),
        ]);
        let layer = Layer::image(&format!("truth.{}", self.recipe.effect), image);
        let bytes = exr_file::encode(&path, &[layer], &metadata)?;
        atomic_file::write(&path, &bytes).map_err(|source| DatasetError::io(&path, source))?;
        Ok(HashedFile { file, blake3: blake3::hash(&bytes).to_hex().to_string() })
    }
}

/// What a frame's methods are scored against.
struct ScoringTarget {
    exposure: f32,
    ceiling: Ceiling,
    tiles: Planes,
    samples: u32,
    whole: Option<(Planes, u32)>,
}

impl ScoringTarget {
    /// What a method makes, which has no noise.
    fn of_method(method: TargetMethod<'_>, frame: &Frame<'_>, tiles: &[usize]) -> Result<Self, DatasetError> {
        let whole = truth::within_half(target::image(method, frame)?);
        let image = gather(&whole, tiles);
        let exposure = exposure(method.effect(), &image);
        let ceiling = Ceiling { ssim: 1.0, variance: 0.0 };
        Ok(Self { exposure, ceiling, tiles: image, samples: 0, whole: Some((whole, 0)) })
    }
}

/// What is known of the noise of tiles' truth.
fn ceiling(truth: &Truth, tiles: &[usize], exposure: f32) -> Ceiling {
    let [a, b] = [0, 1].map(|half: usize| exposed(&gather(&truth.halves[half], tiles), exposure));
    let variance = truth.estimate.variance.iter().map(|variance| gather(variance, tiles).mean()).sum();
    Ceiling { ssim: rounded(ssim(&a, &b)), variance: rounded(variance) }
}

/// A figure with nine digits: so few survive JSON text to the last bit, which a resumed run's list needs.
fn rounded(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
