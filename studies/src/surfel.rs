//! `deepshade-studies surfel`: what shading by surfels costs, stage by stage, and what its hierarchy saves:
//! the tables and sweeps of "Deep Screen Space" and "The Bounced Z-Buffer" (thesis Tables 4.1, 4.2, 6.1, 6.2,
//! Figures 4.11, 4.12), on a scene of one's own.

mod subject;
mod sweeps;
#[cfg(test)]
mod tests;

use crate::stages::{self, Cost, Stage};
use anyhow::{Context, Result, ensure};
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade::shared::{methods, table};
use deepshade_render::methods::{Quality, surfel};
use deepshade_render::raster::patches::Patch;
use deepshade_render::scene::SceneSource;
use deepshade_render::screen::{MethodPasses, ScreenMethod};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use subject::SurfelFrame;
use sweeps::Row;

/// The methods that shade by surfels, and those that shade by triangles in the same way.
const METHODS: [&str; 4] = ["surfel", "bounced-z", "aov", "aov-bounced-z"];
/// Of which size the figures are that depend on one: that of the thesis' Table 6.2.
const PAPER: Size = Size { width: 768, height: 512 };
/// How long a GPU is kept busy before it is measured.
const WARM_UP_TIME: Duration = Duration::from_millis(500);

/// Milliseconds and memory of shading by surfels, stage by stage; what thresholds, levels and the interleaved
/// framebuffer do to it.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade-studies surfel --json surfel.json\n  \
    deepshade-studies surfel --scene sponza.gltf --sizes 768x512,1920x1080 --effects ao,gi --methods \
    surfel,bounced-z --radius 0.7\n\n\
    In the JSON file ms_STAGE_EFFECT is of `surfel` and ms_METHOD_STAGE_EFFECT of the others, such as \
    ms_bounced_z_splat_ao, of the first size; ratio_fullres is the time of ambient occlusion with every \
    surfel on every pixel over that with levels, and memory_mb what the passes of ambient occlusion write at \
    768x512, surfels and their tree included, and the patches that they lie on. area_error is by how much \
    the areas of the surfels miss that of the scene's surface.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    /// Sizes of the image.
    #[arg(long, value_delimiter = ',', default_value = "768x512")]
    sizes: Vec<Size>,
    /// Effects; by default all that surfels shade.
    #[arg(long, value_delimiter = ',')]
    effects: Vec<Effect>,
    /// Methods; by default all.
    #[arg(long, value_delimiter = ',', value_parser = METHODS, default_values = METHODS)]
    methods: Vec<String>,
    /// How far effects reach, metres; by default 5 % of the scene's diagonal.
    #[arg(long, value_parser = deepshade::shared::arguments::positive)]
    radius: Option<f32>,
    /// How much time methods may take for a better image: low, medium, high or ultra.
    #[arg(long, default_value = "medium")]
    quality: Quality,
    /// Timed runs of each stage; by default 20 on a graphics card and 1 on a software adapter.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: Option<u16>,
    /// Leaves out the sweeps of threshold, levels and resolution.
    #[arg(long)]
    no_sweeps: bool,
    #[command(flatten)]
    viewpoint: deepshade::shared::animated_view::Viewpoint,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// A method of an effect at a size, and what it costs.
struct MethodCost {
    effect: Effect,
    method: &'static str,
    size: Size,
    cost: Cost,
}

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, an effect is not shaded by surfels, or the device fails.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let effects = effects(args)?;
    let runs = args.runs.map_or(if gpu.is_software() { 1 } else { 20 }, usize::from);
    let methods = opened(args, &gpu, &effects)?;
    ensure!(!methods.is_empty(), "none of these methods shades any of these effects");
    let attributes: Vec<Attribute> = methods.iter().flat_map(|method| method.attributes()).copied().collect();
    let animated_view = subject::open(args, &effects)?;
    let subject = |size: Size| SurfelFrame::new(&gpu, &animated_view, args.radius, size, &attributes);
    let subjects: Vec<(Size, SurfelFrame<'_>)> =
        args.sizes.iter().map(|size| Ok((*size, subject(*size)?))).collect::<Result<_>>()?;
    let mut measured = Vec::new();
    for (size, subject) in &subjects {
        gpu::warm_up(&gpu.device, &gpu.queue, WARM_UP_TIME)?;
        for method in &methods {
            measured.push(MethodCost::new(method, subject, *size, runs)?);
        }
    }
    let (size, first) = subjects.first().context("--sizes names no size")?;
    let area = first.area_error(args.quality)?;
    let memory = match measured.iter().find(|one| one.is(Effect::Ao, METHODS[0], PAPER)) {
        Some(found) => found.cost.megabytes,
        None => {
            let (method, subject) =
                (methods::open_screen(Effect::Ao, METHODS[0], &gpu, args.quality)?, subject(PAPER)?);
            stages::megabytes(&MethodPasses::new(&method, &subject.inputs(), &subject.view)?)
        }
    };
    let memory = memory + (first.patches() * size_of::<Patch>()) as f64 * 1e-6;
    let usual = surfel::SurfelParameters::of(args.quality);
    let mut sweeps = Vec::new();
    if !args.no_sweeps {
        let half = subject(Size { width: size.width / 2, height: size.height / 2 })?;
        note!("threshold, levels and resolution of ao by surfel at {size}");
        sweeps = sweeps::run(&gpu, [first, &half], usual, runs)?;
    }

    let mut figures = Figures::new("surfel");
    figures.set("area_error", area);
    figures.set("memory_mb", memory);
    let ratio = sweeps::ratio_fullres(&sweeps, &usual);
    ratio.iter().for_each(|ratio| figures.set("ratio_fullres", *ratio));
    measured.iter().filter(|one| one.size == *size).for_each(|one| one.set(&mut figures));
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("radius", json!(first.view.radius));
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("quality", json!(args.quality.name()));
    figures.detail("triangles", json!(first.triangles()));
    figures.detail("patches", json!(first.patches()));
    figures.detail("runs", json!(runs));
    figures.detail("costs", measured.iter().map(MethodCost::to_json).collect());
    figures.detail("sweeps", sweeps.iter().map(Row::to_json).collect());
    figures.write(args.json.as_deref())?;

    say!(
        "{} of {} triangles in {} patches, radius {:.3} m, on {}",
        args.scene,
        first.triangles(),
        first.patches(),
        first.view.radius,
        gpu.info.name
    )?;
    say!("{}", table::aligned(&cost_rows(&measured)))?;
    if !sweeps.is_empty() {
        say!("\n{}", table::aligned(&sweeps::table(&sweeps)))?;
    }
    ratio
        .iter()
        .try_for_each(|ratio| say!("every surfel on every pixel takes {ratio:.1} times as long as levels"))?;
    say!("the areas of all surfels are {:+.2} % off the surface's", 100.0 * area)?;
    say!("ambient occlusion at {PAPER}: {memory:.1} MB")
}

/// The effects asked for, or all that are shaded by surfels.
fn effects(args: &Args) -> Result<Vec<Effect>> {
    let shaded = |effect: Effect| methods::screen_names(effect).contains(&METHODS[0]);
    let none = args.effects.iter().find(|effect| !shaded(**effect));
    ensure!(none.is_none(), "no surfels shade `{}`", none.map_or("", |effect| effect.name()));
    Ok(match args.effects.as_slice() {
        [] => Effect::ALL.into_iter().filter(|effect| shaded(*effect)).collect(),
        asked => asked.to_vec(),
    })
}

/// The methods of the effects that were asked for.
fn opened(args: &Args, gpu: &Gpu, effects: &[Effect]) -> Result<Vec<ScreenMethod>> {
    let of = |effect: Effect| {
        METHODS
            .into_iter()
            .filter(|name| args.methods.iter().any(|asked| asked == name))
            .filter(move |name| methods::screen_names(effect).contains(name))
            .map(move |name| (effect, name))
    };
    let all = effects.iter().flat_map(|effect| of(*effect));
    all.map(|(effect, name)| methods::open_screen(effect, name, gpu, args.quality)).collect()
}

impl MethodCost {
    fn new(method: &ScreenMethod, subject: &SurfelFrame<'_>, size: Size, runs: usize) -> Result<Self> {
        let (effect, method_name) = (method.effect(), method.name());
        note!("{effect} by {method_name} at {size}");
        let passes = MethodPasses::new(method, &subject.inputs(), &subject.view);
        let cost = passes.and_then(|passes| Cost::of(method.gpu(), &passes, runs));
        let cost = cost.with_context(|| format!("{effect} by `{method_name}`"))?;
        Ok(Self { effect, method: method_name, size, cost })
    }

    fn is(&self, effect: Effect, method: &str, size: Size) -> bool {
        (self.effect, self.method, self.size) == (effect, method, size)
    }

    /// Milliseconds under the names that figures have.
    fn set(&self, figures: &mut Figures) {
        let method =
            if self.method == METHODS[0] { String::new() } else { self.method.replace('-', "_") + "_" };
        let effect = self.effect.name().replace('-', "_");
        let stages = self.cost.stages.iter().map(|(stage, time)| (stage.name(), *time));
        for (stage, time) in stages.chain([("total", self.cost.total)]) {
            figures.set(&format!("ms_{method}{stage}_{effect}"), time);
        }
    }

    fn to_json(&self) -> serde_json::Value {
        let stages: serde_json::Map<_, _> =
            self.cost.stages.iter().map(|(stage, time)| (stage.name().to_owned(), json!(time))).collect();
        json!({
            "effect": self.effect.name(), "method": self.method, "size": self.size.to_string(), "ms": stages,
            "ms_total": self.cost.total, "megabytes": self.cost.megabytes, "surfels": self.cost.surfels[0],
            "surfels_wanted": self.cost.surfels[1],
        })
    }
}

fn cost_rows(measured: &[MethodCost]) -> Vec<Vec<String>> {
    let is_had =
        |stage: &Stage| measured.iter().any(|one| one.cost.stages.iter().any(|(other, _)| other == stage));
    let stages: Vec<Stage> = Stage::ALL.into_iter().filter(is_had).collect();
    let head = ["effect", "method", "size", "surfels"].into_iter();
    let head = head.chain(stages.iter().map(|stage| stage.name())).chain(["total ms", "MB"]);
    let mut rows = vec![head.map(str::to_owned).collect::<Vec<String>>()];
    for MethodCost { effect, method, size, cost } in measured {
        let mut row =
            vec![effect.to_string(), (*method).to_owned(), size.to_string(), cost.surfels_in_words()];
        row.extend(stages.iter().map(|stage| {
            cost.stages
                .iter()
                .find(|(other, _)| other == stage)
                .map_or(String::new(), |(_, time)| format!("{time:.2}"))
        }));
        row.extend([format!("{:.2}", cost.total), format!("{:.1}", cost.megabytes)]);
        rows.push(row);
    }
    rows
}
