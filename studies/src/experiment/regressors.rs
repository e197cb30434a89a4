//! Shallow regressors on patches beside the deep network (thesis 7.5.5, Figure 7.17): perceptrons on 11x11
//! and 21x21 pixels, random forests on 21x21. Each predicts a pixel from the patch around it, and is swept
//! across the image. They read what a network reads and learn the mean squared difference.

mod forest;
mod mlp;
mod patches;

use super::kernels::{TIMED, milliseconds};
use super::table::{Row, Table};
use super::test_frames::{SIMILARITY, Scores, TestFrames};
use super::workspace::{Workspace, scores};
use anyhow::Result;
use deepshade::shared::plot::{Line, Plot};
use deepshade_infer::NetSpec;
use deepshade_shaders::lists::median;
use deepshade_shaders::split_mix::{STEP, finalised};
use deepshade_shaders::{GBuffer, Planes};
use forest::{Forest, Growth};
use mlp::{Mlp, Schedule};
use patches::Frames;
use std::time::Instant;

/// Edges of the perceptrons' patches, pixels.
const PERCEPTRONS: [usize; 2] = [11, 21];
/// Edge of the forests' patches, pixels.
const FOREST: usize = 21;
/// Trees of the forests; each forest has the trees of those before it.
const TREES: [usize; 3] = [1, 5, 10];
/// Pairs that patches are from, at most, spread over all that there are.
const MOST_FRAMES: usize = 200;
/// Patches of a perceptron's step.
const PATCHES: usize = 256;
/// Runs of which the median time counts, after one more.
const TIMED_RUNS: usize = 5;

/// Trains the network and its rivals on the same pairs.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let data = workspace.base_data()?;
    let settings = workspace.settings(&data)?;
    let network = workspace.network("base", &settings)?;
    let test_frames = workspace.base_test_frames()?;
    let spec = &settings.spec;
    let seed = settings.seed;
    let mut results = Results { test_frames: &test_frames, spec, rows: Vec::new(), lines: Vec::new() };
    let scores = scores(&test_frames, &network)?;
    results.add(["ssim_unet", "deep network"], scores, milliseconds(&network)?, network.seconds);
    let frames = Frames::read(&data.dataset, spec, MOST_FRAMES)?;
    for edge in PERCEPTRONS {
        note!("perceptron on {edge} x {edge} pixels");
        let start = Instant::now();
        let steps = workspace.size.perceptron_steps;
        let mlp = Mlp::train(&frames, edge, Schedule { steps, batch: PATCHES, seed })?;
        let names = [format!("ssim_mlp{edge}"), format!("perceptron {edge}x{edge}")];
        results.measure(names, start.elapsed().as_secs_f64(), |input| mlp.image(input))?;
    }
    note!("random forest of {} trees on {FOREST} x {FOREST} pixels", TREES[TREES.len() - 1]);
    let start = Instant::now();
    let growth = Growth { trees: TREES[TREES.len() - 1], examples: workspace.size.forest_examples, seed };
    let forest = Forest::grow(&frames, FOREST, growth)?;
    let seconds = start.elapsed().as_secs_f64();
    for trees in TREES {
        let names = [format!("ssim_forest{trees}"), format!("random forest of {trees}")];
        // Trees are grown side by side, each taking as long.
        let share = seconds * trees as f64 / growth.trees as f64;
        results.measure(names, share, |input| forest.image(input, trees))?;
    }
    let trivial = test_frames.trivial()?;
    results.rows.push(Row::new(
        "ssim_trivial",
        "nothing",
        &[&trivial.similarity()[..], &[trivial.dssim()]].concat(),
    ));
    let more = [("DSSIM", 4), ("ms at 256x256", 2), ("training s", 1)];
    Ok(Table {
        title: "Deep network, perceptrons and random forests",
        rows_are: "regressor",
        columns: [&SIMILARITY[..], &more].concat(),
        rows: results.rows,
        plot: Plot {
            x: "ms at 256x256 on the processor",
            is_logarithmic: true,
            y: "DSSIM on test scenes",
            lines: results.lines,
            level: Some(("doing nothing", trivial.dssim())),
        },
    })
}

/// What was measured so far.
struct Results<'a> {
    test_frames: &'a TestFrames,
    spec: &'a NetSpec,
    rows: Vec<Row>,
    lines: Vec<Line>,
}

impl Results<'_> {
    /// Scores and times a regressor that makes images of what a network reads.
    fn measure(
        &mut self,
        names: [String; 2],
        training: f64,
        image: impl Fn(&Planes) -> Result<Planes>,
    ) -> Result<()> {
        let scores = self.test_frames.scores(|gbuffer, radius| {
            let mut made = image(&input(self.spec, gbuffer, radius)?)?;
            self.spec.set_background(gbuffer, &mut made)?;
            Ok(made)
        })?;
        let (gbuffer, radius) = self.test_frames.first();
        let timed = repeated(&input(self.spec, gbuffer, radius)?);
        image(&timed)?;
        let mut times = Vec::new();
        for _ in 0..TIMED_RUNS {
            let start = Instant::now();
            image(&timed)?;
            times.push(1e3 * start.elapsed().as_secs_f64());
        }
        self.add(names, scores, median(times), training);
        Ok(())
    }

    fn add(&mut self, names: [impl Into<String>; 2], scores: Scores, milliseconds: f64, training: f64) {
        let [figure, label] = names.map(Into::into);
        let values = [&scores.similarity()[..], &[scores.dssim(), milliseconds, training]].concat();
        self.lines.push(Line::dotted(label.clone(), vec![(milliseconds, scores.dssim())]));
        self.rows.push(Row::new(figure, label, &values));
    }
}

/// What a network would read.
fn input(spec: &NetSpec, gbuffer: &GBuffer, radius: f32) -> Result<Planes> {
    Ok(spec.input(gbuffer, spec.scaling(gbuffer, radius)?, 0)?)
}

/// An image of 256 x 256 pixels of another one, repeated or cut: the time of trees depends on what they read.
fn repeated(input: &Planes) -> Planes {
    let (height, width) = (input.height(), input.width());
    Planes::from_fn(input.channels(), TIMED, TIMED, |channel, y, x| input.at(channel, y % height, x % width))
}

/// A stream of random numbers: a function of a seed and of a counter.
struct Random(u64);

impl Random {
    const fn new(seed: u64, counter: u64) -> Self {
        Self(finalised(finalised(seed) ^ counter))
    }

    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (finalised(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number below `end`, which is far below 2^53.
    fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }

    /// A number of the standard normal distribution (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }
}
