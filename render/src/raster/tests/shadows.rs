//! Shadows by maps: how well they agree with rays, that this notices when they are wrong, and that nothing
//! leaks.

use super::*;
use crate::scene::Mesh;
use deepshade_shaders::wgsl::uniforms::{FrameView, LightRecord};

/// What can be wrong with what the light pass knows: the lights, and from where their maps look.
type Fault = fn(&mut [LightRecord], &mut [FrameView]);

/// The g-buffer's light, by a pass that is told what a fault makes of the truth.
fn lit(gpu: &Gpu, scene: &Scene, camera: &Camera, shadow_size: usize, fault: Fault) -> GBuffer {
    let attributes = vec![Attribute::Light, Attribute::DiffuseLight];
    let settings =
        RasterSettings { height: HEIGHT, width: WIDTH, attributes, shadow_size: Some(shadow_size) };
    let mut frame = Frame::new(gpu, &scene.clone().into(), &settings).expect("a frame");
    frame.set(&gpu.queue, 0.0, 0.0, camera);
    let (records, views) = (&frame.world().gpu_lights.records, &frame.world().gpu_lights.map_views);
    let mut lights: Vec<LightRecord> = gpu::read(&gpu.device, &gpu.queue, records).expect("lights");
    let mut maps: Vec<FrameView> = gpu::read(&gpu.device, &gpu.queue, views).expect("views");
    fault(&mut lights, &mut maps);
    gpu.queue.write_buffer(records, 0, bytemuck::cast_slice(&lights));
    gpu.queue.write_buffer(views, 0, bytemuck::cast_slice(&maps));
    run(gpu, &frame);
    read(gpu, &frame)
}

/// The first map of the scene's light of an index.
fn first_map(lights: &[LightRecord], index: usize) -> usize {
    lights[index].power[3] as usize
}

#[test]
fn light_agrees_with_rays_and_wrong_maps_are_found_out() {
    let gpu = Gpu::new().expect("an adapter");
    let nothing: Fault = |_, _| {};
    let no_shadows: Fault = |lights, _| lights.iter_mut().for_each(|light| light.power[3] = -1.0);
    // Of the lamp, which is above: what is below it and what is above it.
    let faces: Fault = |lights, maps| maps.swap(first_map(lights, 0) + 2, first_map(lights, 0) + 3);
    // Of the sun: a fine one and the coarsest.
    let cascades: Fault = |lights, maps| maps.swap(first_map(lights, 2) + 1, first_map(lights, 2) + 3);
    let mut unlike = Vec::new();
    // Leaves throw shadows on leaves, and all shadows have edges.
    for (family, bound) in [(Family::Room, 0.021), (Family::Grove, 0.058), (Family::StillLife, 0.03)] {
        let scene = rich(family);
        let traced = TracedScene::new(scene.clone()).expect("a scene");
        let camera = camera_in(&traced);
        let wanted = [Attribute::Light, Attribute::DiffuseLight];
        let expected = gbuffer::render(&traced, &camera, HEIGHT, WIDTH, &wanted);
        let [right, wrong @ ..] = [nothing, no_shadows, faces, cascades].map(|fault| {
            let found = lit(&gpu, &scene, &camera, 1024, fault);
            wanted.map(|attribute| share_outside(&found, &expected, attribute, 0.1))
        });
        let agrees = right.iter().all(|share| *share <= bound);
        let found_out = wrong.iter().flatten().all(|share| *share > bound);
        if !(agrees && found_out) {
            unlike.push(format!("{family:?}: {right:?} of the pixels differ, {wrong:?} with wrong maps"));
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
}

/// The six walls of a box around the origin.
fn walls(half: Vec3) -> Vec<Mesh> {
    let side = |a: Vec3, b: Vec3, c: Vec3| quad([c - a - b, c + a - b, c + a + b, c - a + b]);
    let (x, y, z) = (half.x * Vec3::X, half.y * Vec3::Y, half.z * Vec3::Z);
    vec![side(x, y, z), side(x, y, -z), side(y, z, x), side(y, z, -x), side(z, x, y), side(z, x, -y)]
}

/// Mean of the red light that a camera sees.
fn mean_light(gpu: &Gpu, scene: &Scene, camera: &Camera, shadow_size: usize) -> f32 {
    let light = lit(gpu, scene, camera, shadow_size, |_, _| {}).select(&[Attribute::Light]).expect("light");
    light.plane(0).iter().sum::<f32>() / light.pixels() as f32
}

#[test]
fn no_light_leaves_a_closed_box() {
    let gpu = Gpu::new().expect("an adapter");
    let lamp =
        Light::Point { position: Vec3::new(0.1, 0.05, -0.1), intensity: Vec3::ONE, range: f32::INFINITY };
    let room = |inner: Vec<Mesh>| Scene {
        meshes: [walls(Vec3::new(3.0, 2.0, 2.5)), inner].concat().into(),
        materials: vec![Material { gloss: Gloss::None, ..Material::matte("", Vec3::ONE) }],
        lights: vec![lamp],
        ..Scene::default()
    };
    for target in [Vec3::new(-3.0, 2.0, -2.5), Vec3::new(3.0, -2.0, -2.5), Vec3::new(0.0, -2.0, 0.4)] {
        let camera = Camera::look_at(-0.7 * target, target);
        let mean = |scene: &Scene| mean_light(&gpu, scene, &camera, 1024);
        let (dark, bright) = (mean(&room(walls(Vec3::splat(0.6)))), mean(&room(Vec::new())));
        assert!(bright > 0.01 && dark < 1e-4 * bright, "{dark} with the box, {bright} without, to {target}");
    }
}

#[test]
fn a_point_that_is_lifted_across_an_edge_of_the_cube_stays_in_the_dark() {
    let gpu = Gpu::new().expect("an adapter");
    let lamp = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
    // Where two maps meet, on a plane that light grazes: across their edge points are lifted by more than
    // maps overlap.
    let edge = Vec3::new(2.0, 0.0, -2.0);
    let (to_lamp, across) = (-edge.normalize(), Vec3::new(1.0, 0.0, 1.0).normalize());
    for side in [-1.0, 1.0] {
        let normal = (0.3 * to_lamp + side * across).normalize();
        let (along, up) = (Vec3::Y.cross(normal), Vec3::Y);
        let plane = quad([edge - along - up, edge + along - up, edge + along + up, edge - along + up]);
        let scene = |around_lamp: Vec<Mesh>| Scene {
            meshes: [vec![plane.clone()], around_lamp].concat().into(),
            materials: vec![Material { gloss: Gloss::None, ..Material::matte("", Vec3::ONE) }],
            lights: vec![lamp],
            ..Scene::default()
        };
        let camera = Camera::look_at(edge + 0.4 * normal, edge);
        let mean = |around_lamp: Vec<Mesh>| mean_light(&gpu, &scene(around_lamp), &camera, 256);
        let (dark, bright) = (mean(walls(Vec3::splat(0.6))), mean(Vec::new()));
        assert!(bright > 1e-3 && dark < 1e-4 * bright, "{dark} with a box around the lamp, {bright} without");
    }
}
