//! `deepshade eval --sequence`: how much methods flicker beside truth while the camera moves.
//!
//! From the camera of each chosen frame of a test set, a short sequence goes aside and up. Between two
//! frames, what is seen of a surface changes by `d`. Truth's own change is known from two halves of its
//! samples, `d_a` and `d_b`, whose noise has nothing to do with each other. So the mean of `d_a d_b` is that
//! of the square of truth's change, and the mean of `(d - d_a) (d - d_b)` that of the square of the change
//! that truth does not have, both without truth's noise.

use super::rivals::Rival;
use super::tables::tuned;
use super::{Args, EvaluationInputs, opened, spread};
use crate::figures::Figures;
use crate::methods::{LEARNED, TRUTH};
use crate::statistics::{MeanInterval, estimate, paired};
use crate::table;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::testset::FrameRecord;
use deepshade_dataset::{Recipe, SceneRecord, StagedScene, progress};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::metrics::exposed;
use deepshade_render::path::{Goal, Shot, Truth};
use deepshade_render::scene::Camera;
use deepshade_render::screen::reprojection::ReprojectionParameters;
use deepshade_render::screen::reprojection::reference::{Two, changes, since_at_rest};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes, lists};
use glam::Vec3;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Sequences of a test set where nobody says how many.
const SEQUENCES: usize = 12;
/// By how many pixels surfaces at the median depth move from a frame to the next, to the left and down. They
/// are no whole numbers, so that edges fall elsewhere between samples in each frame.
const STEP: [f32; 2] = [1.37, 0.61];

/// Flicker of all sequences, by the name of a method or truth's; each with the number of its scene.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// A sequence, and who is measured on it.
struct Sequence<'a> {
    effect: Effect,
    frames: usize,
    rivals: &'a [Rival],
    recipe: &'a Recipe,
    record: &'a FrameRecord,
    scene: &'a TracedScene,
}

/// What changes from a frame to the next, one value a surface that is seen in both and channel.
struct Changes {
    /// Of each method.
    methods: Vec<Vec<f32>>,
    /// Of two halves of truth.
    truth: [Vec<f32>; 2],
}

/// Flicker of a sequence, root mean squares, as shares of white.
struct Flicker {
    /// Of each method, what truth does not have.
    methods: Vec<f64>,
    /// Truth's own change.
    truth: f64,
}

/// A frame of a sequence.
struct Moment {
    camera: Camera,
    seen: Vec<bool>,
    positions: Planes,
    methods: Vec<Planes>,
    truth: [Planes; 2],
}

/// Evaluates methods on sequences of so many frames, prints the table.
///
/// # Errors
/// If a scene or a frame cannot be read, or a method fails.
pub(super) fn run(args: &Args, inputs: &EvaluationInputs, frames: usize, gpu: &Gpu) -> Result<()> {
    let with_target = inputs.sets.iter().find(|named| named.set.recipe().target.is_some());
    ensure!(with_target.is_none(), "--sequence is measured beside truth, and a test set's target is another");
    let rivals = opened(inputs, &args.methods, args, gpu)?;
    let (values, scenes) = measured(args, inputs, frames, &rivals)?;
    let effect = inputs.effect;
    let mut figures = Figures::new("eval");
    let mut intervals = Map::new();
    for (name, values) in &values {
        let MeanInterval { mean, low, high } = estimate(values);
        figures.set(&format!("flicker_{name}"), mean);
        intervals.insert(format!("flicker_{name}"), json!([low, high]));
    }
    figures.detail("confidence_95", Value::Object(intervals));
    figures.detail("effect", json!(effect.name()));
    figures.detail("frames_of_a_sequence", json!(frames));
    figures.detail("scenes", json!(scenes));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    say!(
        "{effect}: {} sequences of {frames} frames in {} scenes; surfaces at the median depth move by {:.1} \
         pixels a frame. Flicker: root mean square of the change of surfaces that truth does not have, in \
         thousandths of white; 0 is calm",
        values[TRUTH].len(),
        scenes.len(),
        STEP[0].hypot(STEP[1]),
    )?;
    say!("{}", printed(&rivals, &values))
}

/// Flicker of all sequences in which a surface stays in sight, and the scenes' names.
fn measured(
    args: &Args,
    inputs: &EvaluationInputs,
    frames: usize,
    rivals: &[Rival],
) -> Result<(Table, Vec<String>)> {
    let (mut values, mut scenes): (Table, Vec<String>) = Default::default();
    let wanted = args.frames.map_or(SEQUENCES, |frames| frames as usize);
    for set in inputs.sets.iter().map(|named| &named.set) {
        let chosen = spread(set.frames().len(), wanted);
        let props = set.props().context("--scenes says where files are")?;
        let bar = progress::bar("sequences", chosen.len(), 0);
        let mut current: Option<(&SceneRecord, StagedScene<'_>)> = None;
        for index in chosen {
            let record = &set.frames()[index];
            let of_frame =
                || format!("sequence from frame {}; --scenes says where scene files are", record.name);
            let (_, staged) = match current.take() {
                Some(known) if *known.0 == record.scene => current.insert(known),
                _ => {
                    let staged =
                        StagedScene::load(&record.scene, set.recipe(), &props).with_context(of_frame)?;
                    current.insert((&record.scene, staged))
                }
            };
            let scene = &staged.shown(&record.camera, record.variation.as_ref())?;
            let sequence =
                Sequence { effect: inputs.effect, frames, rivals, recipe: set.recipe(), record, scene };
            bar.inc(1);
            let Some(flicker) = sequence.flicker(staged).with_context(of_frame)? else { continue };
            let name = record.scene.source.to_string();
            let number = scenes.iter().position(|known| *known == name).unwrap_or_else(|| {
                scenes.push(name);
                scenes.len() - 1
            });
            let of_methods = rivals.iter().map(|rival| rival.name.clone()).zip(flicker.methods);
            for (name, value) in of_methods.chain([(TRUTH.to_owned(), flicker.truth)]) {
                values.entry(name).or_default().push((number, value));
            }
        }
        bar.finish_and_clear();
    }
    ensure!(!values.is_empty(), "no surface stays in sight in any sequence of the test set");
    Ok((values, scenes))
}

/// A row a method, then truth's own change.
fn printed(rivals: &[Rival], values: &Table) -> String {
    let text = |MeanInterval { mean, low, high }: MeanInterval, sign: bool| {
        let [mean, low, high] = [mean, low, high].map(|value| 1e3 * value);
        if sign {
            format!("{mean:+.2} [{low:+.2}, {high:+.2}]")
        } else {
            format!("{mean:.2} [{low:.2}, {high:.2}]")
        }
    };
    let own = values.get(LEARNED);
    let row = |method: &str, quality: String, of: &[(usize, f64)]| {
        let less = own.filter(|_| method != LEARNED && method != TRUTH).and_then(|own| paired(own, of));
        let less = less.map_or(String::new(), |difference| text(difference, true));
        let mut row = vec![method.to_owned(), quality, text(estimate(of), false)];
        row.extend(own.is_some().then_some(less));
        row
    };
    let mut head = ["method", "quality", "flicker"].map(str::to_owned).to_vec();
    head.extend(own.map(|_| format!("`{LEARNED}` less it")));
    let methods = rivals.iter().map(|rival| row(rival.method_name, tuned(rival), &values[&rival.name]));
    let truth = row(TRUTH, "its own change".to_owned(), &values[TRUTH]);
    let rows: Vec<_> = [head].into_iter().chain(methods).chain([truth]).collect();
    table::aligned(&rows)
}

impl Sequence<'_> {
    /// How much methods flicker in it; none where no surface stays in sight.
    fn flicker(&self, staged: &StagedScene<'_>) -> Result<Option<Flicker>> {
        let Some(pixel) = self.pixel() else { return Ok(None) };
        let mut before = self.moment(staged, pixel, 0)?;
        let mut since_before_that = before.since(&before.camera);
        let mut all = Vec::new();
        for step in 1..self.frames {
            let now = self.moment(staged, pixel, step)?;
            let since_before = now.since(&before.camera);
            let two = Two { since_before: &since_before, since_before_that: &since_before_that };
            all.push(Changes::of(two, &now, &before));
            (before, since_before_that) = (now, since_before);
        }
        Ok(Flicker::of(&all))
    }

    /// A frame. What is random in methods stays the same, as it does in the estimates of networks.
    fn moment(&self, staged: &StagedScene<'_>, pixel: f32, step: usize) -> Result<Moment> {
        let Self { effect, rivals, record, scene, .. } = *self;
        let aside = Vec3::new(STEP[0], STEP[1], 0.0) * (pixel * step as f32);
        let camera =
            Camera { position: record.camera.position + record.camera.rotation * aside, ..record.camera };
        let gbuffer = staged.gbuffer(scene, &camera, record.seed);
        let size = [gbuffer.height(), gbuffer.width()];
        let frame =
            Frame { scene, camera: &camera, gbuffer: &gbuffer, radius: record.radius, seed: record.seed };
        let shown = |image: &Planes| exposed(image, record.exposure);
        let shade = |rival: &Rival| Ok(shown(&rival.method.shade(&frame, Repeats::ONCE)?.image));
        let methods = rivals.iter().map(shade).collect::<Result<_>>()?;
        let shot = Shot::new(scene, &camera, size, record.radius);
        let (goal, seed) = (Goal::samples(self.recipe.samples), record.seed.wrapping_add(step as u32));
        let truth = Truth::render(effect, &shot, goal, seed, |_, _| true).halves.map(|half| shown(&half));
        let surfaces = surfaces(scene, &camera, size);
        let seen = surfaces.seen()?;
        Ok(Moment { camera, seen, positions: surfaces.select(&[Attribute::Position])?, methods, truth })
    }

    /// How large a pixel is at the median depth of what is seen first, metres; none where nothing is.
    fn pixel(&self) -> Option<f32> {
        let (camera, size) = (&self.record.camera, self.recipe.resolution);
        let seen = surfaces(self.scene, camera, [size.height, size.width]);
        let depths = seen.select(&[Attribute::Depth]).ok()?;
        let depths: Vec<f64> =
            depths.data().iter().filter(|depth| **depth > 0.0).map(|depth| f64::from(*depth)).collect();
        (!depths.is_empty()).then(|| lists::median(depths) as f32 / camera.focal_length(size.height))
    }
}

/// What a camera sees of surfaces.
fn surfaces(scene: &TracedScene, camera: &Camera, [height, width]: [usize; 2]) -> GBuffer {
    gbuffer::render(scene, camera, height, width, &[Attribute::Position, Attribute::Depth, Attribute::Valid])
}

impl Moment {
    fn since(&self, before: &Camera) -> Planes {
        since_at_rest(&self.positions, &self.seen, &self.camera, before)
    }
}

impl Changes {
    fn of(two: Two<'_>, now: &Moment, before: &Moment) -> Self {
        let tolerance = ReprojectionParameters::default().depth_tolerance;
        let change = |(now, before): (&Planes, &Planes)| changes(two, now, before, tolerance);
        Self {
            methods: now.methods.iter().zip(&before.methods).map(change).collect(),
            truth: [0, 1].map(|half| change((&now.truth[half], &before.truth[half]))),
        }
    }
}

impl Flicker {
    /// That of all changes of a sequence; none where no surface stays in sight. Sums of products of two
    /// halves may be less than nothing, which counts as nothing.
    fn of(all: &[Changes]) -> Option<Self> {
        let count = all.iter().map(|changes| changes.truth[0].len()).sum::<usize>();
        let root = |sum: f64| (sum / count as f64).max(0.0).sqrt();
        let product = |(a, b): (f32, f32)| f64::from(a) * f64::from(b);
        let halves = |changes: &Changes| {
            let [a, b] = &changes.truth;
            a.iter().copied().zip(b.iter().copied()).map(product).sum::<f64>()
        };
        let beyond = |changes: &Changes, method: usize| {
            let [a, b] = &changes.truth;
            let own = changes.methods[method].iter();
            own.zip(a.iter().zip(b)).map(|(own, (a, b))| product((own - a, own - b))).sum::<f64>()
        };
        let methods = all.first().map_or(0, |changes| changes.methods.len());
        let method = |method: usize| root(all.iter().map(|changes| beyond(changes, method)).sum());
        let own = root(all.iter().map(halves).sum());
        (count > 0).then(|| Self { methods: (0..methods).map(method).collect(), truth: own })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::random::random;

    fn noise(count: usize, seed: u32, scale: f32) -> Vec<f32> {
        (0..count).map(|i| scale * (random(i as u32, 0, seed, 0) - 0.5)).collect()
    }

    #[test]
    fn noise_of_truth_is_no_flicker_and_that_of_a_method_is() {
        const COUNT: usize = 100_000;
        let own = noise(COUNT, 1, 0.2);
        let half = |seed| own.iter().zip(noise(COUNT, seed, 0.5)).map(|(own, noise)| own + noise).collect();
        let restless = own.iter().zip(noise(COUNT, 4, 0.1)).map(|(own, noise)| own + noise).collect();
        let still = vec![0.0; COUNT];
        let changes = Changes { methods: vec![own.clone(), restless, still], truth: [half(2), half(3)] };
        let Flicker { methods, truth } = Flicker::of(&[changes]).expect("surfaces");
        // Numbers drawn evenly from a range have a twelfth of its square as variance.
        let even = |range: f64| range / 12f64.sqrt();
        assert!((truth - even(0.2)).abs() < 2e-3, "{truth}");
        assert!(methods[0] < 0.015, "as truth changes: {}", methods[0]);
        assert!((methods[1] - even(0.1)).abs() < 6e-3, "{}", methods[1]);
        assert!((methods[2] - even(0.2)).abs() < 6e-3, "what stays lacks truth's change: {}", methods[2]);
    }

    #[test]
    fn where_nothing_stays_in_sight_there_is_no_flicker() {
        let nothing = Changes { methods: vec![Vec::new()], truth: [Vec::new(), Vec::new()] };
        assert!(Flicker::of(&[nothing]).is_none());
    }
}
