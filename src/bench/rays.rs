//! `deepshade bench rays`: rays a second through a scene, one thread and all, beside Embree on the very same rays,
//! traversal alone.
//!
//! Embree traces single rays (`rtcIntersect1`, `rtcOccluded1`), and `ratio_primary`, `ratio_ao` and `ratio_diffuse` are of
//! our single rays. Rays that the program traces in bundles are measured so too, and called so; Embree's packets and
//! streams, their counterpart, are not.
//!
//! Materials are made opaque, since what a texture lets through is no question of traversal. Rays are made beforehand;
//! all ways to trace them take turns, so that what else the machine does falls on all of them.

mod contest;
#[cfg(feature = "embree")]
mod embree;
mod sets;

use crate::{figures::Figures, views};
use anyhow::{Result, ensure};
use contest::{Contest, Outcome};
use deepshade_dataset::progress;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AlphaMode, Scene, SceneSource};
use serde_json::json;
use sets::{Ray, RaySet};
use std::path::PathBuf;
use std::time::Instant;

/// Measures rays a second through a scene, beside Embree where the program is built with the cargo feature `embree`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench rays --scene sponza.gltf --json rays.json\n\n\
    Beside Embree 3 (Debian 12: apt-get install libembree-dev), which is loaded at run time:\n  \
    cargo run --release --features embree -- bench rays --scene sponza.gltf\n\n\
    ratio_primary, ratio_ao and ratio_diffuse in the JSON file are our rate over Embree's, single rays against single \
    rays (rtcIntersect1, rtcOccluded1), one thread. ratio_*_bundles are bundles of 64 rays that start together against \
    Embree's single rays; Embree's packets are not measured.\n\n\
    The default scene is procedural, so that everybody has it. The figures in the book are of Sponza, which does not \
    come with the program; those of different scenes cannot be compared. Ambient occlusion rays are as long as \
    15 % of the scene's diagonal.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
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

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read or nothing of it is seen.
pub fn run(args: &Args) -> Result<()> {
    let scene = opaque(args.scene.scene(0.0)?);
    let triangles = scene.triangle_count();
    let rival = rival(&scene);
    let start = Instant::now();
    let scene = TracedScene::new(scene)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let size = usize::from(args.size);
    let views = args.views.of(&args.scene, &scene, [size, size])?;
    let sets = sets::all(&scene, views.iter().map(|view| &view.camera), size);
    ensure!(sets.iter().all(|set| !set.rays.is_empty()), "the views of {} see nothing", args.scene);
    let runs = usize::from(args.runs);
    let bar = progress::bar("rounds", sets.len() * runs, 0);
    let contest = Contest { scene: &scene, rival: rival.as_deref().ok(), runs, finished: &|| bar.inc(1) };
    let outcomes: Vec<(&RaySet, Outcome)> = sets.iter().map(|set| (set, contest.of(set))).collect();
    bar.finish_and_clear();

    let diagonal = scene.diagonal();
    let mut figures = Figures::new("bench rays");
    for (set, outcome) in &outcomes {
        outcome.write(set.kind, &mut figures);
    }
    figures.set("build_seconds", build_seconds);
    if let Ok(rival) = &rival {
        figures.set("build_seconds_embree", rival.build_seconds());
    }
    figures.set("triangles", triangles as f64);
    figures.set("diagonal", f64::from(diagonal));
    figures.detail("scene", args.scene.to_string().into());
    let who = rival.as_ref().map_or_else(ToString::to_string, |_| "Embree".to_owned());
    figures.detail("rival", who.into());
    figures.detail("size", json!({ "views": views.len(), "size": size, "runs": args.runs }));
    figures.write(args.json.as_deref())?;

    say!(
        "scene     {} ({triangles} triangles, diagonal {diagonal:.2} m, built in {build_seconds:.2} s)",
        args.scene
    )?;
    match &rival {
        Ok(rival) => say!("Embree    built in {:.2} s", rival.build_seconds())?,
        Err(error) => say!("Embree    not measured: {error}")?,
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

/// Embree over the same triangles.
#[cfg(feature = "embree")]
fn rival(scene: &Scene) -> Result<Box<dyn Rival>> {
    Ok(Box::new(embree::Embree::new(scene)?))
}

/// Nobody.
#[cfg(not(feature = "embree"))]
fn rival(_: &Scene) -> Result<Box<dyn Rival>> {
    anyhow::bail!("the program is built without the cargo feature `embree`")
}
