//! `deepshade bench rays`: rays a second through a scene, one thread, traversal alone.

use crate::compare::DEFAULT_RADIUS_SHARE;
use crate::{figures::Figures, scene_source::SceneSource, views};
use anyhow::{Result, ensure};
use deepshade_render::bvh::TracedScene;
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::path::sampler::{PixelSampler, cosine_hemisphere, frame};
use deepshade_render::scene::Camera;
use glam::{Vec2, Vec3};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Measures rays a second through a scene, one thread, traversal alone.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench rays --scene sponza.gltf --json rays.json")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
    #[arg(long)]
    scene: SceneSource,
    #[command(flatten)]
    views: views::Args,
    /// Rows and columns of each view.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    /// Ambient occlusion rays from each surface that a view sees.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1024))]
    samples: u32,
    /// Times that all rays are traced; the median counts.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// A ray with the length that matters.
struct Ray {
    origin: Vec3,
    direction: Vec3,
    reach: f32,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    let scene = args.scene.scene(0.0)?;
    let triangles = scene.triangle_count();
    let start = Instant::now();
    let scene = TracedScene::new(scene)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let size = usize::from(args.size);
    let mut primary = Vec::new();
    for view in args.views.of(&scene, [size, size])? {
        primary.extend(primary_rays(&view.camera, size));
    }
    let ao = occlusion_rays(&scene, &primary, args.samples);
    ensure!(!ao.is_empty(), "the views of {} see nothing", args.scene);
    let mrays_primary = megarays(&primary, args.runs, |ray| {
        scene.hit(ray.origin, ray.direction, ray.reach).map_or(0, |hit| hit.triangle)
    });
    let mrays_ao =
        megarays(&ao, args.runs, |ray| u32::from(scene.blocked(ray.origin, ray.direction, ray.reach)));

    println!("scene              {} ({triangles} triangles, built in {build_seconds:.2} s)", args.scene);
    println!("primary            {mrays_primary:.2} Mrays/s, one thread ({} rays)", primary.len());
    println!("ambient occlusion  {mrays_ao:.2} Mrays/s, one thread ({} rays)", ao.len());
    let mut figures = Figures::new("bench rays");
    figures.set("mrays_primary", mrays_primary);
    figures.set("mrays_ao", mrays_ao);
    figures.set("build_seconds", build_seconds);
    figures.set("triangles", triangles as f64);
    figures.detail("scene", args.scene.to_string().into());
    figures.write(args.json.as_deref())
}

fn primary_rays(camera: &Camera, size: usize) -> impl Iterator<Item = Ray> {
    let camera = *camera;
    (0..size * size).map(move |i| {
        let pixel = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let direction = camera.direction(pixel, size, size);
        Ray { origin: camera.position, direction, reach: f32::INFINITY }
    })
}

/// Cosine-distributed rays, as long as the default radius, from what the primary rays meet.
fn occlusion_rays(scene: &TracedScene, primary: &[Ray], samples: u32) -> Vec<Ray> {
    let reach = DEFAULT_RADIUS_SHARE * scene.diagonal();
    let mut rays = Vec::new();
    for (i, ray) in primary.iter().enumerate() {
        let Some(hit) = scene.hit(ray.origin, ray.direction, ray.reach) else { continue };
        let point = SurfacePoint::new(scene, &hit, ray.direction);
        let (sampler, to_world) = (PixelSampler::new(i, 0, 0), frame(point.normal));
        rays.extend((0..samples).map(|sample| {
            let [u, v, ..] = sampler.sample_4d(sample, 0);
            Ray { origin: point.ray_origin(), direction: to_world * cosine_hemisphere(u, v), reach }
        }));
    }
    rays
}

/// Millions of rays a second on this thread, median of some runs.
fn megarays(rays: &[Ray], runs: u32, trace: impl Fn(&Ray) -> u32) -> f64 {
    let mut seconds: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            black_box(rays.iter().fold(0u32, |sum, ray| sum.wrapping_add(trace(ray))));
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    rays.len() as f64 / seconds[seconds.len() / 2] / 1e6
}
