//! The passes against their plain versions and closed forms; what moves and what bends; extremes.

mod kept_light;
mod limits;
mod sky;
mod textures;

use super::glassner::GlassnerParameters as Moments;
use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Repeats};
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::prove_twin;
use crate::scene::glow::tests::glow;
use crate::scene::glow::{Glow, Start};
use crate::scene::medium::Weather;
use crate::scene::{Bounds, Camera, Density, Light, Look, Material, MaterialId, Medium, Mesh, Scene};
use crate::screen::{self, GpuGBuffer, Inputs, MethodPasses, ScreenMethod};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{GBuffer, Planes};
use glam::{Vec2, Vec3};
use std::sync::Arc;

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

fn quad(corners: [Vec3; 4], material: u32) -> Mesh {
    Mesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: MaterialId(material),
        ..Mesh::default()
    }
}

/// A floor of 4 m at y = 0.
fn floor() -> Mesh {
    quad([(-2., 2.), (2., 2.), (2., -2.), (-2., -2.)].map(|(x, z)| Vec3::new(x, 0.0, z)), 0)
}

/// A wall of 2 m behind it, a little above and of another material.
fn wall() -> Mesh {
    quad([(-1., 0.1), (1., 0.1), (1., 2.1), (-1., 2.1)].map(|(x, y)| Vec3::new(x, y, -1.5)), 1)
}

fn lamp(position: Vec3, power: f32) -> Light {
    Light::Point { position, intensity: Vec3::splat(power), range: f32::INFINITY }
}

fn scene(meshes: Vec<Mesh>, lights: Vec<Light>, glow: Glow) -> TracedScene {
    TracedScene::new(Scene {
        meshes: meshes.into(),
        materials: vec![Material::matte("floor", Vec3::splat(0.5)), Material::matte("wall", Vec3::ONE)],
        lights,
        glow: Some(Arc::new(glow)),
        ..Scene::default()
    })
    .expect("a scene")
}

fn seen(scene: TracedScene, camera: Camera, [height, width]: [usize; 2]) -> (TracedScene, View, GBuffer) {
    let gbuffer = gbuffer::render(&scene, &camera, height, width, ATTRIBUTES);
    (scene, View { height, width, camera, radius: 1.0, seed: 3 }, gbuffer)
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.6, 1.7, 3.1), Vec3::new(0.0, 0.6, 0.0))
}

/// Floor and wall of two states under two lamps that shine at different times.
fn room() -> (TracedScene, View, GBuffer) {
    let mut glow = glow(&[0.7, 0.1], &[[0.5, 2.0]], 3.0);
    glow.start = Start::Share(0.1);
    glow.schedules
        .insert(0, crate::scene::glow::Schedule { lights: vec![1], sky: false, on: vec![[0.0, 2.5]] });
    let lights = vec![lamp(Vec3::new(1.5, 1.5, 1.5), 6.0), lamp(Vec3::new(-1.7, 2.2, 0.4), 9.0)];
    seen(scene(vec![floor(), wall()], lights, glow), camera(), [37, 53])
}

fn shaded(method: &ScreenMethod, (scene, view, gbuffer): &(TracedScene, View, GBuffer)) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    method.shade_in_passes(&frame, Repeats::ONCE).expect("an image").image
}

/// The shares that the last pass but one has written.
fn states(gpu: &Gpu, passes: &MethodPasses) -> Vec<f32> {
    let step = passes.steps().iter().rev().nth(1).expect("passes");
    let mut states: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, &step.writes[0]).expect("states");
    // What rounding left is behind them.
    states.truncate(states.len() / 2);
    states
}

/// The shares of all texels after what a room's scene says, by the passes and by the plain version.
fn both_states((scene, view, gbuffer): &(TracedScene, View, GBuffer), texels: u32) -> [Vec<f32>; 2] {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(texels));
    let uploaded = GpuGBuffer::upload(&gpu.device, gbuffer, ATTRIBUTES).expect("attributes");
    let world = screen::world(&gpu, scene.scene(), view).expect("room");
    let inputs = Inputs { gbuffer: &uploaded, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(&method, &inputs, view).expect("passes");
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
    let plain = reference::shade(scene, view, RateEquationParameters::exact(texels)).swap_remove(0);
    [states(&gpu, &passes), plain]
}

/// Whether all values are as near to others; what is no number is not.
fn near(a: &[f32], b: &[f32], tolerance: f32) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn states_and_images_are_those_of_the_plain_version() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(100));
    // Shadow maps end within a texel of where shadows do.
    prove_twin(&method, &room(), Tolerance { usual: 2e-3, worst: 0.06 });
}

#[test]
fn moments_of_the_past_are_those_of_the_plain_version() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, Moments { samples: 9 });
    prove_twin(&method, &room(), Tolerance { usual: 2e-3, worst: 0.06 });
}

#[test]
fn so_are_moments_of_light_through_fog() {
    let (scene, view, gbuffer) = room();
    let fog =
        Medium::new(Vec3::splat(0.05), Vec3::new(0.3, 0.2, 0.1), 0.0, Density::Everywhere).expect("a medium");
    let look = Look { medium: Some(Arc::new(fog)), ..scene.scene().look() };
    let foggy = scene.with_look(look).expect("a look");
    let method = ScreenMethod::new(&gpu(), Moments { samples: 9 });
    prove_twin(&method, &(foggy, view, gbuffer), Tolerance { usual: 2e-3, worst: 0.06 });
}

/// A floor under a lamp, with a board between them that was elsewhere in each of three stretches of the past.
fn moving() -> (TracedScene, View, GBuffer) {
    let corners = [(-0.4, 0.4), (0.4, 0.4), (0.4, -0.4), (-0.4, -0.4)];
    let board = |x: f32| quad(corners.map(|(across, z)| Vec3::new(x + across, 1.2, z)), 1);
    let at = |x: f32| {
        let glow = glow(&[0.7, 0.1], &[[0.5, 2.0]], 2.0);
        scene(vec![floor(), board(x)], vec![lamp(Vec3::new(0.1, 2.5, 0.2), 30.0)], glow)
    };
    let past = vec![(0.0, at(-1.1)), (0.9, at(-0.5)), (1.4, at(0.2))];
    seen(at(1.3).with_past(past).expect("the same triangles"), camera(), [37, 53])
}

/// Where a pixel of the floor is next to an edge of the board's shadow in any of some poses of it, within
/// `width` metres.
fn is_near_an_edge(point: Vec3, width: f32) -> bool {
    let lamp = Vec3::new(0.1, 2.5, 0.2);
    // On the board's plane, seen from the lamp.
    let share = (lamp.y - 1.2) / (lamp.y - point.y);
    let there = lamp + (point - lamp) * share;
    [-1.1f32, -0.5, 0.2].iter().any(|x| {
        let off = Vec2::new((there.x - x).abs() - 0.4, there.z.abs() - 0.4);
        // Inside how deep, outside how far.
        let distance =
            if off.max_element() < 0.0 { -off.max_element() } else { off.max(Vec2::ZERO).length() };
        distance < width * share
    })
}

/// Both methods draw shadows by maps and states at texels: within a texel of where a shadow ends, a place may
/// have got any share of what a place gets that is never in the shadow; everywhere else they are what the
/// plain version is.
#[test]
fn what_moved_leaves_its_shadows_where_they_were() {
    let gpu = gpu();
    let (scene, view, gbuffer) = moving();
    let still = scene.clone().with_past(vec![]).expect("no past");
    // The floor alone: nothing was ever between it and the lamp.
    let open = seen(
        self::scene(vec![floor()], scene.scene().lights.clone(), Glow::of(scene.scene()).clone()),
        camera(),
        [37, 53],
    );
    let states = ScreenMethod::new(&gpu, RateEquationParameters::exact(150));
    let moments = ScreenMethod::new(&gpu, Moments { samples: 16 });
    let spacing = scene.diagonal() / 150.0;
    // Of a map of 90 degrees and 1024 texels, at the floor's distance; a lookup mixes two by two.
    let texel = 2.0 * 2.0 * 2.5 / 1024.0;
    let methods = [(states, spacing + texel), (moments, 2.0 * texel)];
    for (method, width) in methods {
        let told = (scene.clone(), view, gbuffer.clone());
        let found = shaded(&method, &told);
        let plain = |(scene, view, gbuffer): &(TracedScene, View, GBuffer)| {
            let inputs = PlainInputs { gbuffer, environment: None, scene: Some(scene) };
            let image = method.reference(&inputs, view).expect("attributes").pop().expect("an image");
            Planes::from_data(3, view.height, view.width, image)
        };
        let (right, lit) = (plain(&told), plain(&open));
        let brightest = lit.data().iter().copied().fold(0.0, f32::max);
        let (mut near, mut floor) = (0, 0);
        for (y, x) in (0..view.height).flat_map(|y| (0..view.width).map(move |x| (y, x))) {
            let direction =
                view.camera.direction(Vec2::new(x as f32, y as f32) + 0.5, view.height, view.width);
            let Some(hit) = scene.hit(view.camera.position, direction, f32::INFINITY) else { continue };
            let point = view.camera.position + direction * hit.distance;
            let is_edge = hit.mesh == 0 && is_near_an_edge(point, width);
            floor += usize::from(hit.mesh == 0);
            near += usize::from(is_edge);
            for channel in 0..3 {
                let [found, right, lit] = [&found, &right, &lit].map(|image| image.at(channel, y, x));
                if is_edge {
                    let within = 0.0..=lit + 2e-3 * brightest;
                    assert!(
                        within.contains(&found) && within.contains(&right),
                        "{x}, {y}: {found} {right} {lit}"
                    );
                } else {
                    let off = (found - right).abs() / brightest;
                    assert!(off < 2e-3, "{}: {x}, {y}: {found} {right}", method.name());
                }
            }
        }
        assert!(floor > 500 && 3 * near < floor, "{}: {near} of {floor} near edges", method.name());
        let untold = shaded(&method, &(still.clone(), view, gbuffer.clone()));
        let off = found.data().iter().zip(untold.data()).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
        assert!(off > found.data().len() / 50, "as if it had never moved: {off}");
    }
}

/// A board before a lamp in smoke that keeps light, over a floor that does, too, or not.
#[test]
fn a_medium_keeps_light_as_in_the_plain_version() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(100));
    let bounds = Bounds { min: Vec3::new(-1.0, 0.1, -1.0), max: Vec3::new(1.0, 1.3, 1.0) };
    let smoke = Weather::smoke(3, 1.5, 0.9).grid(bounds, 12, 0.0).expect("smoke");
    for density in [Density::Grid(smoke), Density::Within(bounds)] {
        let mut kept = glow(&[0.7, 0.1], &[[0.5, 2.0]], 2.0);
        kept.medium = Some(crate::scene::glow::tests::paint(&[0.4]));
        let corners = [(-0.3, 0.3), (0.3, 0.3), (0.3, -0.3), (-0.3, -0.3)];
        let board = quad(corners.map(|(x, z)| Vec3::new(x, 1.8, z)), 1);
        let lights = vec![lamp(Vec3::new(0.1, 2.5, 0.2), 30.0)];
        let scene = scene(vec![floor(), board], lights, kept);
        let medium = Medium::new(Vec3::splat(0.2), Vec3::new(0.6, 0.8, 1.0), 0.0, density).expect("a medium");
        let look = Look { medium: Some(Arc::new(medium)), ..scene.scene().look() };
        let room = seen(scene.with_look(look).expect("a look"), camera(), [37, 53]);
        prove_twin(&method, &room, Tolerance { usual: 4e-3, worst: 0.3 });
        let blank = Look { medium: None, ..room.0.scene().look() };
        let clear = (room.0.with_look(blank).expect("a look"), room.1, room.2.clone());
        let [foggy, clear] = [&room, &clear].map(|room| shaded(&method, room));
        let off = foggy.data().iter().zip(clear.data()).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
        assert!(off > foggy.data().len() / 20, "as if there were no medium: {off}");
    }
}

#[test]
fn without_shadows_states_are_exact() {
    let mut glow = glow(&[0.7, 0.1, 0.0], &[[0.5, 2.0]], 3.0);
    glow.start = Start::LitForLong;
    let room =
        seen(scene(vec![floor()], vec![lamp(Vec3::new(0.3, 2.0, 0.2), 20.0)], glow), camera(), [9, 11]);
    let [states, expected] = both_states(&room, 60);
    assert!(states.len() > 3000 && near(&states, &expected, 1e-5));
    // Where a GPU divides, what it gives may be 2.5 units of the last place off.
    let is_full = |share: &f32| (share - 1.0).abs() <= 2.5 * f32::EPSILON;
    assert!(states.iter().skip(2).step_by(3).all(is_full), "what does not decay is full");
}

/// Euler's scheme, as the thesis has it: the same states as in the plain version, and an error that falls as
/// its steps do; from long light, which is no step, too.
#[test]
fn steps_of_euler_tend_to_the_exact_ones() {
    let gpu = gpu();
    let mut glow = glow(&[0.7, 0.1], &[[0.5, 2.0]], 3.0);
    glow.start = Start::LitForLong;
    let lights = vec![lamp(Vec3::new(0.3, 2.0, 0.2), 20.0)];
    let room = seen(scene(vec![floor()], lights, glow), camera(), [9, 11]);
    let image = |euler| {
        let method = ScreenMethod::new(&gpu, RateEquationParameters { texels: 60, euler });
        prove_twin(&method, &room, Tolerance { usual: 1e-4, worst: 1e-4 });
        shaded(&method, &room)
    };
    let exact = image(0);
    let error = |euler| {
        let off =
            image(euler).data().iter().zip(exact.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off > 1e-5, "{euler}: {off}");
        off
    };
    let ratio = error(128) / error(256);
    assert!((1.9..2.1).contains(&ratio), "{ratio}");
}

/// The error of images with few moments falls with their root, and they have the right mean where light is
/// weak.
#[test]
fn moments_tend_to_the_rate_equation_where_light_is_weak() {
    let gpu = gpu();
    let glow = glow(&[0.7, 0.1], &[[0.5, 2.0]], 3.0);
    let room =
        seen(scene(vec![floor()], vec![lamp(Vec3::new(0.3, 2.0, 0.2), 1e-3)], glow), camera(), [24, 32]);
    let right = shaded(&ScreenMethod::new(&gpu, RateEquationParameters::exact(200)), &room);
    let error = |samples| {
        let image = shaded(&ScreenMethod::new(&gpu, Moments { samples }), &room);
        let squares = image.data().iter().zip(right.data()).map(|(a, b)| (a - b).powi(2)).sum::<f32>();
        (squares / right.data().iter().map(|value| value * value).sum::<f32>()).sqrt()
    };
    let (few, many) = (error(16), error(1024));
    assert!((4.0..14.0).contains(&(few / many)) && many < 0.1, "{few} {many}");
}

/// A frame loop of one's own: the world as it is at a moment, then the passes.
struct Loop {
    gpu: Gpu,
    world: crate::raster::World,
    passes: MethodPasses,
    view: View,
}

impl Loop {
    fn new(
        animated: &crate::scene::AnimatedScene,
        frame: &(TracedScene, View, GBuffer),
        texels: u32,
    ) -> Self {
        let gpu = gpu();
        let (_, view, gbuffer) = frame;
        let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(texels));
        let uploaded = GpuGBuffer::upload(&gpu.device, gbuffer, ATTRIBUTES).expect("attributes");
        let world = crate::raster::World::new(&gpu, animated, Some(512)).expect("room");
        let inputs = Inputs { gbuffer: &uploaded, environment: None, world: Some(&world) };
        let passes = MethodPasses::new(&method, &inputs, view).expect("passes");
        Self { gpu, world, passes, view: *view }
    }

    /// The states after the frame of a moment.
    fn states(&mut self, moment: f32) -> Vec<f32> {
        let Self { gpu, world, passes, view } = self;
        world.set(&gpu.queue, moment, 0.0, &view.camera, view.width as f32 / view.height as f32);
        let pose = |encoder: &mut wgpu::CommandEncoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            world.encode_pose(&mut pass);
        };
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
            pose(encoder);
            world.encode_shadows(encoder, None);
            passes.encode(encoder);
        })
        .expect("valid passes");
        states(gpu, passes)
    }
}

#[test]
fn frames_add_up_to_the_same_past_whatever_their_steps() {
    let frame = room();
    let animated = frame.0.scene().clone().into();
    let mut frames = Loop::new(&animated, &frame, 40);
    let at_once = frames.states(3.0);
    assert!(at_once.iter().any(|share| *share > 0.2));
    let start = frames.states(0.0);
    assert!(start.iter().all(|share| (*share - 0.1).abs() < 1e-6), "time goes back: all begins anew");
    let moments = [0.3, 0.3, 0.95, 1.7, 2.2, 2.6, 3.0];
    let last = moments.map(|moment| frames.states(moment)).into_iter().next_back().expect("a frame");
    assert!(near(&last, &at_once, 1e-5));
}

/// In a frame each share changes by a fifth of what can be told from it.
#[test]
fn slow_states_lose_nothing_to_rounding() {
    let mut slow = glow(&[1e-6], &[], 0.0);
    slow.start = Start::Share(0.75);
    let frame = seen(scene(vec![floor()], vec![lamp(Vec3::Y, 5.0)], slow), camera(), [9, 11]);
    let mut frames = Loop::new(&frame.0.scene().clone().into(), &frame, 10);
    let (count, second) = (300u16, 60.0);
    let last = (0..=count).map(|i| frames.states(f32::from(i) / second)).last().expect("frames");
    let expected = 0.75 * 1e-6 * f32::from(count) / second;
    assert!(last.iter().all(|share| ((0.75 - share) / expected - 1.0).abs() < 0.03), "{}", 0.75 - last[0]);
}

#[test]
fn extremes_give_shares_and_finite_images() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(30));
    let rival = ScreenMethod::new(&gpu, Moments { samples: 4 });
    for (decays, power, moment, start) in [
        (&[0.0, 1e30][..], 1e30, 1.0, Start::Share(1.0)),
        (&[1e-30], 0.0, 1e30, Start::LitForLong),
        (&[0.3], 3e38, 2.0, Start::LitForLong),
        (&[0.3], 5.0, -7.0, Start::Share(0.5)),
        (&[0.3], 5.0, 0.0, Start::Share(0.0)),
    ] {
        let mut glow = glow(decays, &[[0.5, f32::INFINITY]], moment);
        glow.start = start;
        // The lamp is in the floor: some texel is as near as can be.
        let lights = vec![lamp(Vec3::new(0.0, 0.0, 0.1), power), lamp(Vec3::Y, power)];
        let room = seen(scene(vec![floor()], lights, glow), camera(), [9, 11]);
        for image in [shaded(&method, &room), shaded(&rival, &room)] {
            let sound = |value: &f32| value.is_finite() && *value >= 0.0;
            assert!(image.data().iter().all(sound), "{decays:?} under {power} after {moment}");
        }
    }
}

#[test]
fn nothing_glows_without_paint_or_lamps() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(30));
    let lit = || vec![lamp(Vec3::Y, 5.0)];
    let mut unpainted = glow(&[0.3], &[[0.0, 9.0]], 1.0);
    unpainted.surfaces[0].material = Some("no such material".to_owned());
    for (lights, glow) in [(lit(), unpainted), (vec![], glow(&[0.3], &[[0.0, 9.0]], 1.0))] {
        let room = seen(scene(vec![floor()], lights, glow), camera(), [9, 11]);
        assert!(shaded(&method, &room).data().iter().all(|value| *value == 0.0));
    }
}

/// Only the wall's material has paint: the floor stays dark up to where both meet.
#[test]
fn each_material_has_its_own_paint() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(60));
    let mut of_wall = glow(&[0.3], &[[0.0, 9.0]], 1.0);
    of_wall.surfaces[0].material = Some("wall".to_owned());
    let (scene, view, _) =
        seen(scene(vec![floor(), wall()], vec![lamp(Vec3::Y, 5.0)], of_wall), camera(), [37, 53]);
    let gbuffer = gbuffer::render(&scene, &view.camera, 37, 53, ATTRIBUTES);
    let object = gbuffer.select(&[Attribute::ObjectId, Attribute::Valid]).expect("objects");
    let image = shaded(&method, &(scene, view, gbuffer));
    for (y, x) in (0..37).flat_map(|y| (0..53).map(move |x| (y, x))) {
        let is_wall = object.at(0, y, x) == 1.0 && object.at(1, y, x) == 1.0;
        assert_eq!(image.at(0, y, x) > 0.0, is_wall, "{x}, {y}");
    }
}
