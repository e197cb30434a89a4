//! Making a frame: its truth, and every method's image held against it, each written as soon as it is there.
//! What is there from an earlier run and was made from the same things is not made again.

use super::compared_methods::ComparedMethod;
use super::key::Digest;
use crate::radius;
use crate::report::folder::Folder;
use crate::report::images::{self, ExposedTruth};
use crate::report::record::{FrameRecord, ImageRecord, ImageRequest, TruthRecord};
use crate::views::View;
use anyhow::{Result, ensure};
use deepshade_dataset::truth;
use deepshade_render::bvh::TracedScene;
use deepshade_render::exr_file::Metadata;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::path::{Goal, Shot, Truth};
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::{Effect, GBuffer, Planes};
use std::time::Instant;

/// Name of the fact that a frame is unlike those that networks were trained on.
pub const OUTSIDE: &str = "warning";

/// How a frame is made.
#[derive(Clone, Copy, Debug)]
pub struct ComparisonSettings {
    /// What is computed.
    pub effect: Effect,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// When truth has samples enough.
    pub goal: Goal,
    /// Chooses all random numbers.
    pub seed: u32,
    /// How often a method runs.
    pub repeats: Repeats,
}

/// What a frame is called, and what of it is wanted and there.
#[derive(Clone, Debug)]
pub struct Head {
    /// What truth is made from, as a hash.
    pub key: String,
    /// What pages call the frame.
    pub name: String,
    /// What they call its scene.
    pub scene: String,
    /// What they call its view.
    pub view: String,
    /// Name of its folder.
    pub folder: String,
    /// The methods' images, in the order of the methods.
    pub wanted: Vec<ImageRequest>,
    /// What is there of them.
    pub kept: Option<FrameRecord>,
}

/// What a frame is made from.
pub struct ComparedView<'a> {
    /// The scene with all that the effect needs.
    pub scene: &'a TracedScene,
    /// From where it is seen.
    pub view: &'a View,
    /// How.
    pub settings: ComparisonSettings,
    /// Who computes the effect, in the order of what is wanted.
    pub methods: Vec<&'a ComparedMethod>,
    /// What is to be known of the frame beside what follows from these, as name and value.
    pub facts: Vec<(String, String)>,
}

impl Head {
    /// Whether nothing is to be made.
    pub fn is_whole(&self) -> bool {
        self.kept.as_ref().is_some_and(|kept| self.wanted.iter().all(|wanted| kept.has(wanted)))
    }

    /// The record of a frame of which nothing is to be made, under the names that it has now.
    pub fn renamed(&self, record: FrameRecord) -> FrameRecord {
        let Self { name, scene, view, folder, .. } = self.clone();
        FrameRecord { name, scene, view, folder, ..record }
    }
}

/// The image that a method makes of the frame whose truth has a key.
pub fn wanted(key: &str, method: &ComparedMethod) -> ImageRequest {
    let mut digest = Digest::default();
    digest.say(&key);
    digest.say(&method.fingerprint);
    ImageRequest { key: digest.finish(), file: method.file_name(), label: method.label.clone() }
}

/// Makes of a frame what is not there, says meanwhile what it is at, and writes it into its folder.
///
/// # Errors
/// If the view sees nothing, a method fails, or a file cannot be written.
pub fn make(
    folder: &Folder,
    head: &Head,
    subject: &ComparedView<'_>,
    at: &impl Fn(&str),
) -> Result<FrameRecord> {
    let ComparedView { scene, view, settings, .. } = *subject;
    let ComparisonSettings { effect, height, width, radius, seed, repeats, .. } = settings;
    let gbuffer = gbuffer::render(scene, &view.camera, height, width, effect.attributes());
    ensure!(gbuffer.seen()?.contains(&true), "view `{}` sees nothing of the scene", view.name);
    let frame = Frame { scene, camera: &view.camera, gbuffer: &gbuffer, radius, seed };
    let place = folder.frame(&head.folder)?;
    let kept = head.kept.as_ref().and_then(|record| {
        let image = images::read_truth(&place, effect).ok()?;
        Some((head.renamed(record.clone()), image))
    });
    let (mut record, image) = match kept {
        Some(kept) => kept,
        None => {
            at("truth");
            FrameRecord::delete(&place)?;
            make_truth(folder, head, subject, &gbuffer)?
        }
    };
    record.facts.retain(|(name, _)| name != OUTSIDE);
    record.facts.extend(outside(subject, &gbuffer));
    // An image's file is written anew only when no record vouches for the older one.
    record.write(&folder.path)?;
    let exposed = ExposedTruth { effect, image: &image, exposure: record.truth.exposure };
    for (method, wanted) in subject.methods.iter().zip(&head.wanted) {
        if record.has(wanted) {
            continue;
        }
        at(&wanted.label);
        let shaded = method.rival.method.shade(&frame, repeats)?;
        images::write_image(&place, &wanted.file, &shaded.image, &exposed, &metadata(&record))?;
        record.images.push(ImageRecord {
            key: wanted.key.clone(),
            file: wanted.file.clone(),
            label: wanted.label.clone(),
            method: method.rival.method_name.to_owned(),
            milliseconds: shaded.milliseconds,
            clock: shaded.clock,
            device: shaded.device,
            scores: exposed.scores(&shaded.image),
        });
        record.write(&folder.path)?;
    }
    let place = |image: &ImageRecord| head.wanted.iter().position(|wanted| wanted.key == image.key);
    record.images.sort_by_key(place);
    record.write(&folder.path)?;
    Ok(record)
}

/// The fact that a frame is unlike those that networks were trained on, if it is.
fn outside(subject: &ComparedView<'_>, gbuffer: &GBuffer) -> Option<(String, String)> {
    let said = |one: &&ComparedMethod| {
        Some(format!("{}: {}", one.label, one.outside(gbuffer, subject.settings.radius)?))
    };
    let all: Vec<String> = subject.methods.iter().filter_map(said).collect();
    (!all.is_empty()).then(|| (OUTSIDE.to_owned(), all.join("; ")))
}

/// Renders truth, no brighter than half floats can hold, and writes it.
fn make_truth(
    folder: &Folder,
    head: &Head,
    subject: &ComparedView<'_>,
    gbuffer: &GBuffer,
) -> Result<(FrameRecord, Planes)> {
    let ComparisonSettings { effect, height, width, radius, goal, seed, .. } = subject.settings;
    let shot = Shot::new(subject.scene, &subject.view.camera, [height, width], radius);
    let start = Instant::now();
    let mut truth = Truth::render(effect, &shot, goal, seed, |_, _| true);
    let milliseconds = start.elapsed().as_secs_f64() * 1e3;
    truth.estimate.mean = truth::within_half(truth.estimate.mean);
    let record = FrameRecord {
        key: head.key.clone(),
        effect,
        name: head.name.clone(),
        scene: head.scene.clone(),
        view: head.view.clone(),
        folder: head.folder.clone(),
        height,
        width,
        radius: effect.listens_to(EffectSetting::Radius).then_some(radius),
        facts: facts(subject, truth.estimate.samples),
        truth: TruthRecord::new(effect, &truth, gbuffer, milliseconds),
        images: Vec::new(),
    };
    let place = folder.path.join(&head.folder);
    images::write_truth(&place, effect, &truth, record.truth.exposure, &metadata(&record))?;
    record.write(&folder.path)?;
    Ok((record, truth.estimate.mean))
}

/// What images say of the frame that they are of.
fn metadata(record: &FrameRecord) -> Metadata {
    let facts = record.facts.iter().cloned();
    facts.chain([("frame".to_owned(), record.name.clone())]).collect()
}

fn facts(subject: &ComparedView<'_>, samples: u32) -> Vec<(String, String)> {
    let ComparedView { scene, view, settings, .. } = *subject;
    let position = view.camera.position;
    let radius = || ("radius", radius::in_words(settings.radius, scene.diagonal()));
    let reach = settings.effect.listens_to(EffectSetting::Radius).then(radius);
    [
        ("scene", scene.scene().name.clone()),
        ("triangles", scene.scene().triangle_count().to_string()),
        ("camera", format!("at ({:.2}, {:.2}, {:.2})", position.x, position.y, position.z)),
        ("truth", format!("{samples} samples a pixel")),
    ]
    .into_iter()
    .chain(reach)
    .map(|(name, value)| (name.to_owned(), value))
    .chain(subject.facts.iter().cloned())
    .collect()
}
