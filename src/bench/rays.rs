//! `deepshade bench rays`: rays a second through a scene, one thread and all, traversal alone.
//!
//! Rays that the program traces in bundles are measured in bundles, too, and called so. Studies set another
//! library's ray tracer beside ours on the very same rays ([`run_beside`]).
//!
//! Materials are made opaque, since what a texture lets through is no question of traversal. Rays are made
//! beforehand; all ways to trace them take turns, so that what else the machine does falls on all of them.

mod ray_bench;
mod sets;

pub use sets::Ray;

use crate::{figures::Figures, views};
use anyhow::{Result, ensure};
use deepshade_dataset::progress;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AlphaMode, Scene, SceneSource};
use ray_bench::{RayBench, RayRates};
use serde_json::json;
use sets::RaySet;
use std::path::PathBuf;
use std::time::Instant;

/// Measures rays a second through a scene, traversal alone.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench rays --scene sponza.gltf --json rays.json\n\n\
    In the JSON file mrays_* are millions of single rays a second on one thread, mrays_*_bundles those in \
    bundles of 64 rays that start together, and *_all_threads the same on all threads.\n\n\
    The default scene is procedural, so that everybody has it. The figures in the book are of Sponza, which \
    does not come with the program; those of different scenes cannot be compared. Ambient occlusion rays are \
    as long as 15 % of the scene's diagonal.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    #[command(flatten)]
    views: views::Args,
    /// Rows and columns of each view.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    /// Times that all rays are traced; the median counts.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Another library's ray tracer.
pub trait Rival: Sync {
    /// What people call it.
    fn name(&self) -> &'static str;

    /// Seconds that its hierarchy took.
    fn build_seconds(&self) -> f64;

    /// Distance and index of the nearest triangle, all meshes' triangles counted one after the other.
    fn nearest(&self, ray: &Ray) -> Option<(f32, u32)>;

    /// Whether a ray meets anything.
    fn blocked(&self, ray: &Ray) -> bool;

    /// The sum of the indices of all nearest triangles.
    fn sum_of_nearest(&self, rays: &[Ray]) -> u32 {
        rays.iter().filter_map(|ray| self.nearest(ray)).map(|(_, index)| index).fold(0, u32::wrapping_add)
    }

    /// How many rays meet anything.
    fn count_of_blocked(&self, rays: &[Ray]) -> u32 {
        rays.iter().map(|ray| u32::from(self.blocked(ray))).sum()
    }
}

/// What makes a rival of a scene.
pub type RivalOf<'a> = &'a dyn Fn(&Scene) -> Result<Box<dyn Rival>>;

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read or nothing of it is seen.
pub fn run(args: &Args) -> Result<()> {
    measure(args, "bench rays", None)
}

/// As `deepshade bench rays`, with figures of a command of that name, beside a rival on the very same rays.
///
/// # Errors
/// If the scene cannot be read, nothing of it is seen, or there is no rival.
pub fn run_beside(args: &Args, command: &str, rival: RivalOf<'_>) -> Result<()> {
    measure(args, command, Some(rival))
}

fn measure(args: &Args, command: &str, rival: Option<RivalOf<'_>>) -> Result<()> {
    let scene = opaque(args.scene.scene(0.0)?);
    let rival = rival.map(|rival| rival(&scene)).transpose()?;
    let triangles = scene.triangle_count();
    let start = Instant::now();
    let scene = TracedScene::new(scene)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let size = usize::from(args.size);
    let views = args.views.of(&args.scene, &scene, [size, size])?;
    let sets = sets::all(&scene, views.iter().map(|view| &view.camera), size);
    ensure!(sets.iter().all(|set| !set.rays.is_empty()), "the views of {} see nothing", args.scene);
    let runs = usize::from(args.runs);
    let bar = progress::bar("rounds", sets.len() * runs, 0);
    let ray_bench = RayBench { scene: &scene, rival: rival.as_deref(), runs, finished: &|| bar.inc(1) };
    let outcomes: Vec<(&RaySet, RayRates)> = sets.iter().map(|set| (set, ray_bench.of(set))).collect();
    bar.finish_and_clear();

    let diagonal = scene.diagonal();
    let mut figures = Figures::new(command);
    for (set, outcome) in &outcomes {
        outcome.write(set.kind, &mut figures);
    }
    figures.set("build_seconds", build_seconds);
    if let Some(rival) = &rival {
        figures.set(&format!("build_seconds_{}", rival.name().to_lowercase()), rival.build_seconds());
        figures.detail("rival", rival.name().into());
    }
    figures.set("triangles", triangles as f64);
    figures.set("diagonal", f64::from(diagonal));
    figures.detail("scene", args.scene.to_string().into());
    figures.detail("size", json!({ "views": views.len(), "size": size, "runs": args.runs }));
    figures.write(args.json.as_deref())?;

    say!(
        "scene     {} ({triangles} triangles, diagonal {diagonal:.2} m, built in {build_seconds:.2} s)",
        args.scene
    )?;
    if let Some(rival) = &rival {
        say!("{:<9} built in {:.2} s", rival.name(), rival.build_seconds())?;
    }
    outcomes.iter().try_for_each(|(set, outcome)| outcome.print(set))
}

/// The scene with nothing to be seen through.
fn opaque(mut scene: Scene) -> Scene {
    for material in &mut scene.materials {
        material.alpha = AlphaMode::Opaque;
    }
    scene
}
