//! `deepshade bench rays`: rays a second through a scene, one thread, traversal alone.

use crate::compare::DEFAULT_REACH;
use crate::{figures::Figures, views};
use anyhow::{Result, ensure};
use deepshade_render::bvh::TracedScene;
use deepshade_render::bvh::bundle::{BUNDLE, Start};
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::path::ao::hemisphere;
use deepshade_render::path::sampler::PixelSampler;
use deepshade_render::scene::{Camera, SceneSource};
use deepshade_shaders::lists;
use glam::{Vec2, Vec3};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Rays a second through a scene, one thread, traversal alone.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench rays --scene sponza.gltf --json rays.json\n\n\
    The default scene is procedural, so that everybody has it. The figures in the README are of Sponza, which does not \
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
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

struct Ray {
    origin: Vec3,
    direction: Vec3,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    let scene = args.scene.scene(0.0)?;
    let triangles = scene.triangle_count();
    let start = Instant::now();
    let scene = TracedScene::new(scene)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let size = usize::from(args.size);
    let (mut primary, mut squares) = (Vec::new(), Vec::new());
    for view in args.views.of(&scene, [size, size])? {
        primary.extend(primary_rays(&view.camera, size));
        squares.extend(primary_bundles(&view.camera, size));
    }
    let bundles = occlusion_bundles(&scene, &primary);
    ensure!(!bundles.is_empty(), "the views of {} see nothing", args.scene);
    let mrays_primary = megarays(primary.len(), args.runs, || {
        let hits = squares.iter().flat_map(|(origin, directions)| scene.hit_bundle(*origin, directions));
        hits.flatten().map(|hit| hit.triangle).fold(0, u32::wrapping_add)
    });
    let mrays_primary_single = megarays(primary.len(), args.runs, || {
        let hit = |ray: &Ray| scene.hit(ray.origin, ray.direction, f32::INFINITY);
        primary.iter().filter_map(hit).map(|hit| hit.triangle).fold(0, u32::wrapping_add)
    });
    let rays = bundles.len() * BUNDLE;
    let mrays_ao = megarays(rays, args.runs, || {
        bundles
            .iter()
            .map(|(start, directions)| scene.blocked_bundle(*start, directions).count_ones())
            .fold(0, u32::wrapping_add)
    });
    let mrays_ao_single = megarays(rays, args.runs, || {
        let blocked = |(start, directions): &(Start, Vec<Vec3>)| {
            let blocked = |direction: &&Vec3| scene.blocked(start.origin, **direction, start.reach);
            directions.iter().filter(blocked).count() as u32
        };
        bundles.iter().map(blocked).fold(0, u32::wrapping_add)
    });

    let diagonal = scene.diagonal();
    let mut figures = Figures::new("bench rays");
    figures.set("mrays_primary", mrays_primary);
    figures.set("mrays_primary_single", mrays_primary_single);
    figures.set("mrays_ao", mrays_ao);
    figures.set("mrays_ao_single", mrays_ao_single);
    figures.set("build_seconds", build_seconds);
    figures.set("triangles", triangles as f64);
    figures.set("diagonal", f64::from(diagonal));
    figures.detail("scene", args.scene.to_string().into());
    figures.write(args.json.as_deref())?;
    say!(
        "scene              {} ({triangles} triangles, diagonal {diagonal:.2} m, built in {build_seconds:.2} s)",
        args.scene
    )?;
    say!(
        "primary            {mrays_primary:.2} Mrays/s, one thread ({} rays, in bundles as g-buffers trace them)",
        primary.len()
    )?;
    say!("                   {mrays_primary_single:.2} Mrays/s one by one")?;
    say!(
        "ambient occlusion  {mrays_ao:.2} Mrays/s, one thread ({rays} rays, in bundles as truth traces them)"
    )?;
    say!("                   {mrays_ao_single:.2} Mrays/s one by one")
}

fn primary_rays(camera: &Camera, size: usize) -> impl Iterator<Item = Ray> {
    let camera = *camera;
    (0..size * size).map(move |i| {
        let pixel = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let direction = camera.direction(pixel, size, size);
        Ray { origin: camera.position, direction }
    })
}

/// The same rays in squares of pixels, as a g-buffer traces them.
fn primary_bundles(camera: &Camera, size: usize) -> impl Iterator<Item = (Vec3, Vec<Vec3>)> {
    let camera = *camera;
    let edge = BUNDLE.isqrt();
    let corners = move || (0..size).step_by(edge);
    corners().flat_map(move |top| corners().map(move |left| (left, top))).map(move |(left, top)| {
        let columns = left..size.min(left + edge);
        let pixels = (top..size.min(top + edge)).flat_map(|y| columns.clone().map(move |x| (x, y)));
        let direction =
            |(x, y): (usize, usize)| camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), size, size);
        (camera.position, pixels.map(direction).collect())
    })
}

/// Every which pixel ambient occlusion rays start from: neighbours tell nothing new.
const STRIDE: usize = 5;

/// A bundle of cosine-distributed rays, as long as the default radius whatever the size of the views, from each surface
/// that primary rays meet.
fn occlusion_bundles(scene: &TracedScene, primary: &[Ray]) -> Vec<(Start, Vec<Vec3>)> {
    let reach = DEFAULT_REACH.diagonal_share * scene.diagonal();
    let bundle = |(i, ray): (usize, &Ray)| {
        let hit = scene.hit(ray.origin, ray.direction, f32::INFINITY)?;
        let point = SurfacePoint::new(scene, &hit, ray.direction);
        let start = Start { origin: point.ray_origin(), above: point.geometric_normal, reach };
        let directions = hemisphere(&PixelSampler::new(i, 0, 0), BUNDLE as u32, point.geometric_normal);
        Some((start, directions))
    };
    primary.iter().enumerate().step_by(STRIDE).filter_map(bundle).collect()
}

/// Millions of rays a second on this thread, median of some runs.
fn megarays(rays: usize, runs: u32, trace: impl Fn() -> u32) -> f64 {
    let seconds = (0..runs)
        .map(|_| {
            let start = Instant::now();
            black_box(trace());
            start.elapsed().as_secs_f64()
        })
        .collect();
    rays as f64 / lists::median(seconds) / 1e6
}
