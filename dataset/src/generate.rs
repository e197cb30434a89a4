//! Making a dataset: `pairs/<scene>-<view>.exr` and `manifest.json`.
//!
//! The same recipe gives the same bytes, whatever the number of threads and however often the program was
//! killed on the way: every random number is a hash of what it is for, and every finished file is noted in a
//! journal. That holds between machines of one kind: rays round once where the processor has fused
//! multiply-add and twice where it has not, and sines are the system's, so that others may differ in last
//! digits, and where a ray meets an edge.

mod captured;
pub(crate) mod rendered;

use crate::journal::{Journal, checked};
use crate::manifest::{MANIFEST, Manifest, PairRecord};
use crate::origin::{Origin, Out};
use crate::plan::{PlannedScene, PlannedView, TrainingSplit};
use crate::shard::Shard;
use crate::target::{self, TargetMethod};
use crate::{DatasetError, Props, Recipe, SceneOrCapture, StagedScene, progress, truth};
use deepshade_render::exr_file::{Layer, Metadata, encode};
use deepshade_render::path::Estimate;
use deepshade_render::scene::procedural::Split;
use deepshade_shaders::{GBuffer, atomic_file};
use indicatif::ProgressBar;
use rayon::prelude::*;
use rendered::Rendered;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;

/// Where the pairs lie in a dataset's folder.
pub(crate) const PAIRS: &str = "pairs";
/// Name of the layer that holds the variance of the target's values, where it is known.
pub(crate) const VARIANCE_LAYER: &str = "variance";
/// So many scenes are in memory at a time; their views and tiles keep all threads busy.
const SCENES_AT_ONCE: usize = 2;

/// What generating a dataset came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Pairs of the dataset.
    pub pairs: usize,
    /// Pairs that were rendered now; the others were there already.
    pub rendered: usize,
    /// Size of all pairs, bytes.
    pub bytes: u64,
}

/// Makes the dataset of a recipe in a folder, or what is still missing of it. Progress goes to
/// stderr.
///
/// # Errors
/// If the recipe is for test sets or aims at a method's images, a scene cannot be had or has no fit view, or
/// the folder cannot be written, is in use or holds other data.
pub fn generate(recipe: &Recipe, folder: &Path) -> Result<Summary, DatasetError> {
    generate_by(recipe, folder, None)
}

/// [`generate`] for recipes that aim at the images of a method, which `method` is.
///
/// # Errors
/// Those of [`generate`], and if the recipe aims at something else or the method fails.
pub fn generate_by<'a>(
    recipe: &Recipe,
    out: impl Into<Out<'a>>,
    method: Option<TargetMethod<'_>>,
) -> Result<Summary, DatasetError> {
    generate_part(recipe, out.into(), method, None)
}

/// One part of what [`generate_by`] makes, in a folder of its own, for [`crate::merge`].
///
/// # Errors
/// Those of [`generate_by`], also if the folder holds another shard.
pub fn generate_shard<'a>(
    recipe: &Recipe,
    out: impl Into<Out<'a>>,
    method: Option<TargetMethod<'_>>,
    shard: Shard,
) -> Result<Summary, DatasetError> {
    generate_part(recipe, out.into(), method, Some(shard))
}

fn generate_part(
    recipe: &Recipe,
    out: Out<'_>,
    method: Option<TargetMethod<'_>>,
    shard: Option<Shard>,
) -> Result<Summary, DatasetError> {
    target::check(recipe, method)?;
    for (holds, what) in [
        (recipe.split == Split::Test, "`split` says testing, where pairs are for training"),
        (recipe.tiles.is_some(), "the table `tiles` is for test sets"),
    ] {
        if holds {
            let what = format!("{what}; `deepshade dataset testset` makes test sets");
            return Err(DatasetError::Recipe { path: recipe.path.clone(), what });
        }
    }
    let plan = recipe.plan()?;
    let folder = out.folder;
    let origin = Origin { shard, ..Origin::new(recipe, &plan, out)? };
    let plan = match shard {
        Some(shard) => shard.of(plan),
        None => plan,
    };
    let list = shard.map_or_else(|| MANIFEST.to_owned(), Shard::file_name);
    let earlier = earlier_pairs(folder, &list, &origin)?;
    let (journal, mut entries) = Journal::open(folder, &[PAIRS], &list, &origin)?;
    entries.extend(earlier);
    let known = checked(folder, entries);
    let total = plan.iter().map(|scene| scene.views.len()).sum();
    let bar = progress::bar("pairs", total, known.len());
    let props = Props::load(recipe)?;
    let context =
        PairContext { recipe, method, props: &props, folder, journal: &journal, known: &known, bar: &bar };
    let manifest = Manifest { origin, pairs: by_scene(&plan, |_, scene| context.scene(scene))? };
    bar.finish_and_clear();
    manifest.save_list(folder, &list)?;
    journal.finish()?;
    let size = |pair: &PairRecord| {
        let path = folder.join(&pair.file);
        path.metadata().map(|metadata| metadata.len()).map_err(|source| DatasetError::io(&path, source))
    };
    let bytes = manifest.pairs.iter().map(size).sum::<Result<u64, _>>()?;
    Ok(Summary { pairs: total, rendered: total - known.len(), bytes })
}

/// What `records` gives of every scene, in the plan's order. A few scenes at a time are in memory, however
/// many there are and however large: one is built while another is rendered.
pub(crate) fn by_scene<R: Send>(
    plan: &[PlannedScene],
    records: impl Fn(usize, &PlannedScene) -> Result<Vec<R>, DatasetError> + Sync,
) -> Result<Vec<R>, DatasetError> {
    let mut all = Vec::new();
    for (batch, scenes) in plan.chunks(SCENES_AT_ONCE).enumerate() {
        let first = batch * SCENES_AT_ONCE;
        let made: Result<Vec<Vec<R>>, DatasetError> =
            scenes.par_iter().enumerate().map(|(index, scene)| records(first + index, scene)).collect();
        all.extend(made?.into_iter().flatten());
    }
    Ok(all)
}

/// The pairs of a dataset that is whole, or was before a file was damaged.
fn earlier_pairs(folder: &Path, list: &str, ours: &Origin) -> Result<Vec<PairRecord>, DatasetError> {
    if !folder.join(list).exists() {
        return Ok(Vec::new());
    }
    let earlier = Manifest::load_list(folder, list)?;
    earlier.origin.check_same(ours, folder)?;
    Ok(earlier.pairs)
}

/// What all pairs share.
struct PairContext<'a> {
    recipe: &'a Recipe,
    method: Option<TargetMethod<'a>>,
    props: &'a Props,
    folder: &'a Path,
    journal: &'a Journal,
    known: &'a HashMap<String, PairRecord>,
    bar: &'a ProgressBar,
}

impl PairContext<'_> {
    /// All pairs of a scene, which is only loaded if one of them is missing.
    fn scene(&self, scene: &PlannedScene) -> Result<Vec<PairRecord>, DatasetError> {
        let known = |view: &PlannedView| self.known.get(&file_name(&view.name)).cloned();
        if let Some(records) = scene.views.iter().map(known).collect() {
            return Ok(records);
        }
        if let SceneOrCapture::Capture(folder) = &scene.scene.source {
            let capture = captured::Frames::open(self.recipe, scene, folder)?;
            let record =
                |view: &PlannedView| known(view).map_or_else(|| self.captured(scene, &capture, view), Ok);
            return scene.views.par_iter().map(record).collect();
        }
        let staged = StagedScene::load(&scene.scene, self.recipe, self.props)?;
        let record = |view: &PlannedView| known(view).map_or_else(|| self.pair(scene, &staged, view), Ok);
        staged.each(&scene.views, record)
    }

    /// Reads a pair from a capture and writes it.
    fn captured(
        &self,
        planned: &PlannedScene,
        capture: &captured::Frames,
        view: &PlannedView,
    ) -> Result<PairRecord, DatasetError> {
        let (gbuffer, target, camera) = capture.pair(view.index)?;
        let record = PairRecord {
            file: file_name(&view.name),
            blake3: String::new(),
            part: part(view),
            scene: planned.scene.clone(),
            view: view.index,
            camera,
            // Captures know no diagonal, and their recipes state metres.
            radius: self.recipe.radius.metres(0.0).unwrap_or_default(),
            seed: view.seed,
            variation: None,
        };
        self.write(record, &gbuffer, &Estimate { mean: target, variance: None, samples: 0 })
    }

    /// Renders a pair and writes it.
    fn pair(
        &self,
        planned: &PlannedScene,
        staged: &StagedScene<'_>,
        view: &PlannedView,
    ) -> Result<PairRecord, DatasetError> {
        let drawn = staged.drawn(planned.key, view)?;
        let rendered = Rendered::new(self.recipe, self.method, staged, view.seed, drawn)?;
        let record = PairRecord {
            file: file_name(&view.name),
            blake3: String::new(),
            part: part(view),
            scene: planned.scene.clone(),
            view: view.index,
            camera: rendered.camera,
            radius: rendered.radius,
            seed: view.seed,
            variation: rendered.variation,
        };
        self.write(record, &rendered.gbuffer, &rendered.target)
    }

    /// Writes a pair, and notes its file's hash.
    fn write(
        &self,
        mut record: PairRecord,
        gbuffer: &GBuffer,
        target: &Estimate,
    ) -> Result<PairRecord, DatasetError> {
        let path = self.folder.join(&record.file);
        let mut layers =
            vec![Layer::gbuffer(gbuffer), Layer::image(&target_layer(self.recipe), &target.mean)];
        layers
            .extend(target.variance.iter().map(|variance| Layer::image(VARIANCE_LAYER, variance).in_full()));
        let bytes = encode(&path, &layers, &metadata(self.recipe, &record, target.samples))?;
        atomic_file::write(&path, &bytes).map_err(|source| DatasetError::io(&path, source))?;
        record.blake3 = blake3::hash(&bytes).to_hex().to_string();
        self.journal.add(&record)?;
        self.bar.inc(1);
        Ok(record)
    }
}

/// What a view's pair is used for.
const fn part(view: &PlannedView) -> TrainingSplit {
    if view.held_apart { TrainingSplit::Validation } else { TrainingSplit::Training }
}

/// The file of a view's pair, in the dataset's folder.
pub(crate) fn file_name(view: &str) -> String {
    format!("{PAIRS}/{view}.exr")
}

/// Name of the layer that holds the target.
pub(crate) fn target_layer(recipe: &Recipe) -> String {
    format!("target.{}", recipe.effect)
}

/// What a pair's file says of itself.
fn metadata(recipe: &Recipe, record: &PairRecord, samples: u32) -> Metadata {
    let camera = &record.camera;
    let axes = camera.rotation;
    [
        ("scene", record.scene.to_string()),
        ("view_index", record.view.to_string()),
        ("camera_position", camera.position.to_string()),
        ("camera_axes", format!("right {}, up {}, back {}", axes.x_axis, axes.y_axis, axes.z_axis)),
        ("camera_vertical_fov_degrees", camera.vertical_fov.to_degrees().to_string()),
        ("radius_metres", record.radius.to_string()),
        ("samples", samples.to_string()),
        ("seed", record.seed.to_string()),
        ("units", truth::units(recipe.effect)),
    ]
    .into_iter()
    .chain(recipe.target.clone().map(|method| {
        ("target_method", format!("{method}, quality {} where it has one", target::QUALITY.name()))
    }))
    .chain(recipe.vary.iter().filter_map(|vary| vary.timeline.as_ref()).flat_map(|timeline| {
        [("frame_seconds", timeline.seconds.to_string()), ("lamps_on_seconds", format!("{:?}", timeline.on))]
    }))
    .chain(varied(record))
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// What a pair's file says of what its image was given beside what its scene brings.
fn varied(record: &PairRecord) -> Vec<(&'static str, String)> {
    let lens = record.camera.lens.map(|lens| format!("radius {} m, focus {} m", lens.radius, lens.focus));
    let lamp = record.variation.and_then(|variation| variation.lamp);
    let lamp = lamp.map(|lamp| format!("at {} m, {} W/sr", lamp.position, lamp.intensity));
    let fog = record.variation.and_then(|variation| variation.fog);
    let fog = fog.map(|fog| {
        let kind = fog.smoke.map_or_else(|| "homogeneous".to_owned(), |seed| format!("smoke {seed}"));
        let (absorption, scattering, g) = (fog.absorption, fog.scattering, fog.anisotropy);
        format!("{kind}, absorption {absorption} /m, scattering {scattering} /m, anisotropy {g}")
    });
    let time = record.variation.and_then(|variation| variation.moment).map(|moment| moment.time.to_string());
    [("lens", lens), ("lamp", lamp), ("fog", fog), ("time_seconds", time)]
        .into_iter()
        .filter_map(|(name, value)| value.map(|value| (name, value)))
        .collect()
}

#[cfg(test)]
pub(crate) mod tests;
