//! Surfels of a mesh that bends and swells: they stay on its surface, frame after frame.

use crate::build::{Builder, write};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::{Quality, surfel};
use deepshade_render::raster::World;
use deepshade_render::raster::patches;
use deepshade_render::scene::{AnimatedScene, Camera, Scene, SceneSource};
use deepshade_render::screen::{Device, GpuGBuffer, Inputs, MethodPasses, MethodStep, ScreenMethod, View};
use deepshade_render::surfels::{self, Surfel, Tree, frame};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu};
use glam::Vec3;
use std::collections::BTreeMap;
use std::f32::consts::{FRAC_1_SQRT_2, PI};
use std::path::{Path, PathBuf};

const ATTRIBUTES: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];
const HEIGHT: usize = 48;
const WIDTH: usize = 64;

/// A strip, one metre wide and two high, whose upper half bends by a right angle within a second while all of
/// it swells, above a floor that stays.
fn bending() -> String {
    let (columns, rows) = (12u16, 24u16);
    let vertices: Vec<[f32; 2]> = (0..=rows)
        .flat_map(|y| (0..=columns).map(move |x| [f32::from(x) / 12.0, f32::from(y) / 12.0]))
        .collect();
    let square = |i: u16| {
        let a = i / columns * (columns + 1) + i % columns;
        [a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1]
    };
    let each =
        |of: &dyn Fn([f32; 2]) -> Vec<f32>| vertices.iter().flat_map(|at| of(*at)).collect::<Vec<f32>>();
    let upper = |y: f32| (y - 0.5).clamp(0.0, 1.0);
    let mut builder = Builder::default();
    let positions = builder.floats("VEC3", &each(&|[x, y]| vec![x, y, 0.0]));
    let weights = builder.floats("VEC4", &each(&|[_, y]| vec![1.0 - upper(y), upper(y), 0.0, 0.0]));
    let swells = builder.floats("VEC3", &each(&|[x, y]| vec![0.3 * x, 0.0, 0.2 * (PI * y).sin()]));
    let joints = builder.shorts("VEC4", &[0, 1, 0, 0].repeat(vertices.len()));
    let indices = builder.shorts("SCALAR", &(0..columns * rows).flat_map(square).collect::<Vec<u16>>());
    let [x, y, z] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let inverse = [[x, y, z, [0.0, 0.0, 0.0, 1.0]], [x, y, z, [0.0, -1.0, 0.0, 1.0]]];
    let inverse = builder.floats("MAT4", inverse.as_flattened().as_flattened());
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let turns = builder.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]);
    let shares = builder.floats("SCALAR", &[0.0, 1.0]);
    let floor = builder.floats("VEC3", &[-1.5, 0., 2., 2.5, 0., 2., 2.5, 0., -1., -1.5, 0., -1.]);
    let square = builder.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,"skin":0}},{{}},{{"translation":[0,1,0]}},{{"mesh":1}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},
            "indices":{indices},"targets":[{{"POSITION":{swells}}}]}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{floor}}},"indices":{square}}}]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{inverse}}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}},
            {{"sampler":1,"target":{{"node":0,"path":"weights"}}}}],
        "samplers":[{{"input":{times},"output":{turns}}},{{"input":{times},"output":{shares}}}]}}]"#
    ))
}

/// The file, in a folder that lives as long as it is needed.
fn file() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "bending.gltf", bending());
    let path = folder.path().join("bending.gltf");
    (folder, path)
}

fn view(radius: f32) -> View {
    let camera = Camera::look_at(Vec3::new(1.5, 1.6, 4.0), Vec3::new(0.5, 0.9, 0.0));
    View { height: HEIGHT, width: WIDTH, camera, radius, seed: 3 }
}

/// The file's scene on the GPU, loaded at one time and posed at another.
fn posed(gpu: &Gpu, path: &Path, loaded: f32, time: f32) -> World {
    let animated = AnimatedScene::load(&SceneSource::File(path.to_owned()), loaded).expect("a file");
    let mut world = World::new(gpu, &animated, None).expect("room");
    world.set(&gpu.queue, time, 0.0, &view(1.0).camera, WIDTH as f32 / HEIGHT as f32);
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
        world.encode_pose(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
    })
    .expect("a valid pass");
    world
}

/// The surfels of the file, posed at a time, each with the patch that it stands for a part of.
fn surfels_at(gpu: &Gpu, path: &Path, time: f32) -> Vec<(u32, Surfel)> {
    let Gpu { device, queue, .. } = gpu;
    let world = posed(gpu, path, 0.0, time);
    let fine = surfels::SurfelDensity { scale: 0.02, near: 0.01 };
    let uniforms: Vec<wgpu::Buffer> = frame::uniforms(&fine, &view(100.0))
        .map(|bytes| gpu::uniforms(device, "test", &bytes).expect("room"))
        .collect();
    let (cloud, steps) =
        frame::steps(&Device::new(device), &world, &uniforms, Tree::All, None).expect("room");
    gpu::submit(device, queue, "test", |encoder| {
        steps.iter().for_each(|MethodStep { step, .. }| step.encode(encoder, "test", None));
    })
    .expect("valid passes");
    let [count, _] = cloud.count(device, queue).expect("a count");
    let all: Vec<Surfel> = gpu::read(device, queue, &cloud.surfels).expect("surfels");
    let starts: Vec<u32> = gpu::read(device, queue, &cloud.starts).expect("starts");
    let patch = |index: u32| starts.partition_point(|start| *start <= index) as u32 - 1;
    all.into_iter().take(count as usize).enumerate().map(|(i, surfel)| (patch(i as u32), surfel)).collect()
}

/// The surfels of patches that have one.
fn by_patch(surfels: &[(u32, Surfel)]) -> BTreeMap<u32, &Surfel> {
    let of_patch: BTreeMap<u32, &Surfel> = surfels.iter().map(|(patch, surfel)| (*patch, surfel)).collect();
    assert_eq!(of_patch.len(), surfels.len(), "patches are smaller than surfels here");
    of_patch
}

fn place(surfel: &Surfel) -> Vec3 {
    Vec3::from_array(surfel.place)
}

#[test]
fn their_areas_sum_up_to_the_deformed_surface() {
    let gpu = Gpu::new().expect("an adapter");
    let (_folder, path) = file();
    let mut areas = Vec::new();
    for time in [0.0, 0.4, 0.77, 1.0] {
        let right = patches::area_of(&Scene::load_moving(&path, time, 0.0).expect("the file"));
        let found: f32 = surfels_at(&gpu, &path, time).iter().map(|(_, it)| PI * it.radius().powi(2)).sum();
        assert!((found / right - 1.0).abs() < 0.01, "at {time} s: {found} m² of {right} m²");
        areas.push(right);
    }
    assert!(areas[3] > 1.03 * areas[0], "it swells: {areas:?}");
}

#[test]
fn they_move_with_their_patches_and_none_pops_up() {
    let gpu = Gpu::new().expect("an adapter");
    let (_folder, path) = file();
    let [before, after, later] = [0.5, 0.5 + 1.0 / 60.0, 1.0].map(|time| surfels_at(&gpu, &path, time));
    let [before, after, later] = [&before, &after, &later].map(|surfels| by_patch(surfels));
    let largest = before.values().map(|surfel| surfel.radius()).fold(0.0, f32::max);
    // The fastest point is a metre and a half from where it bends, at a right angle a second, and swells by
    // 0.4 m a second.
    let fastest = (1.5 * 0.5 * PI + 0.4) / 60.0;
    let mut appeared = 0;
    for (patch, surfel) in &after {
        let Some(was) = before.get(patch) else {
            assert!(surfel.radius() < 0.4 * largest, "one of {} m pops up", surfel.radius());
            appeared += 1;
            continue;
        };
        let moved = place(surfel).distance(place(was));
        assert!(moved < fastest, "{moved} m in a frame, {fastest} m at most");
        let grown = (surfel.radius().powi(2) - was.radius().powi(2)).abs();
        assert!(grown < 0.2 * largest * largest, "{} m becomes {} m", was.radius(), surfel.radius());
    }
    assert!(appeared * 20 < after.len(), "{appeared} of {} are new", after.len());
    let moved = |(patch, surfel): (&u32, &&Surfel)| Some(place(surfel).distance(place(before.get(patch)?)));
    let farthest = later.iter().filter_map(moved).fold(0.0, f32::max);
    assert!(farthest > 0.5, "half a second later the farthest is {farthest} m away");
}

#[test]
fn a_frame_is_shaded_as_the_same_scene_that_stays() {
    let gpu = Gpu::new().expect("an adapter");
    let (_folder, path) = file();
    let time = 0.6;
    let stays = Scene::load_moving(&path, time, 0.0).expect("the file");
    let traced = TracedScene::new(stays.clone()).expect("a scene");
    let view = view(0.5);
    let gbuffer = gbuffer::render(&traced, &view.camera, HEIGHT, WIDTH, &ATTRIBUTES);
    let there = GpuGBuffer::upload(&gpu.device, &gbuffer, &ATTRIBUTES).expect("attributes");
    let method = ScreenMethod::new(
        &gpu,
        Disks::new(surfel::SurfelParameters::of(Quality::High), surfel::occlusion::OCCLUSION),
    );
    let image = |world: &World| -> Vec<f32> {
        let inputs = Inputs { gbuffer: &there, environment: None, world: Some(world) };
        let passes = MethodPasses::new(&method, &inputs, &view).expect("room");
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
        gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image")
    };
    let right = image(&World::new(&gpu, &stays.into(), None).expect("room"));
    let off = |loaded: f32, time: f32| {
        let image = image(&posed(&gpu, &path, loaded, time));
        let differences: Vec<f32> = image.iter().zip(&right).map(|(a, b)| (a - b).abs()).collect();
        let mean = differences.iter().sum::<f32>() / differences.len() as f32;
        (mean, differences.into_iter().fold(0.0, f32::max))
    };
    let (mean, worst) = off(time, time);
    assert!(mean < 1e-5 && worst < 1e-2, "posed as it was loaded: {mean}, {worst}");
    // Patches are cut where the scene was loaded: other surfels of the same surface.
    let ((elsewhere, _), (not_posed, _)) = (off(0.0, time), off(0.0, 0.0));
    assert!(elsewhere < 0.01 && not_posed > 2.0 * elsewhere, "{elsewhere}, not posed {not_posed}");
}
