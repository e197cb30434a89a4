//! Rays that start far from the world's origin, where coordinates are coarse: in a closed room no light gets
//! in from outside, and what the room's own lamp gives is what it gives at the origin.

use super::proving::{traced, with_environment};
use super::{Integrator, Shot, integrator};
use crate::bvh::TracedScene;
use crate::sampler::{PixelSampler, Stream};
use crate::scene::{Camera, Density, Environment, Light, Material, Medium, Mesh, Scene};
use deepshade_shaders::Effect;
use glam::{DQuat, DVec3, Vec2, Vec3};

/// Cells along each edge of a room's walls.
const CELLS: i32 = 8;
/// Half the room's width, metres.
const HALF: f64 = 1.5;
/// Distances from the origin along x and z, metres; y is a twentieth of that.
const DISTANCES: [f64; 5] = [0.0, 4e3, 3e4, 1e5, 4e5];

fn place(distance: f64) -> DVec3 {
    DVec3::new(distance, 0.05 * distance, -distance)
}

/// A cube around a point, of square cells, without its last `missing` triangles. Corners that cells share are
/// the same numbers.
fn room(centre: DVec3, turn: DQuat, missing: usize) -> Mesh {
    let at = |lattice: [i32; 3]| {
        let inside = DVec3::from(lattice.map(f64::from)) * (2.0 * HALF / f64::from(CELLS)) - HALF;
        (centre + turn * inside).as_vec3()
    };
    let mut mesh = Mesh::default();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, CELLS)]) {
        for cell in 0..CELLS * CELLS {
            let corner = |u: i32, v: i32| {
                let mut lattice = [side; 3];
                lattice[(axis + 1) % 3] = cell % CELLS + u;
                lattice[(axis + 2) % 3] = cell / CELLS + v;
                at(lattice)
            };
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh.triangles.truncate(mesh.triangles.len() - missing);
    mesh
}

/// Along the axes and aside from all of them.
fn turns() -> [DQuat; 2] {
    [DQuat::IDENTITY, DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.7)]
}

/// The room in a bright world, with a lamp outside and one that glows.
fn lit_from_outside(distance: f64, turn: DQuat, missing: usize) -> TracedScene {
    let centre = place(distance);
    let lamp = Light::Point {
        position: (centre + DVec3::new(0.3, 4.0, 0.2)).as_vec3(),
        intensity: Vec3::splat(100.0),
        range: f32::INFINITY,
    };
    let glowing = Material { emission: Vec3::ONE, ..Material::default() };
    let mut panel = room(centre + DVec3::new(0.1, -5.0, 0.3), turn, 0);
    panel.material.0 = 1;
    let scene = Scene {
        meshes: vec![room(centre, turn, missing), panel].into(),
        materials: vec![Material::matte("grey", Vec3::splat(0.5)), glowing],
        lights: vec![lamp],
        ..Scene::default()
    };
    with_environment(TracedScene::new(scene).expect("triangles"), Environment::uniform(Vec3::ONE))
}

/// Values of an effect in images of the room from its middle.
fn values(scene: &TracedScene, distance: f64, effect: Effect, samples: u32) -> Vec<Vec3> {
    let eye = place(distance).as_vec3();
    let mut values = Vec::new();
    for direction in [Vec3::X, Vec3::new(-0.3, -1.0, 0.4), Vec3::new(0.5, 0.6, -1.0)] {
        let camera = Camera { vertical_fov: 1.8, ..Camera::look_at(eye, eye + direction * 8.0) };
        let shot = Shot::new(scene, &camera, [24, 24], 1e3);
        let integrator = integrator(effect, &shot);
        values.extend((0..24 * 24).map(|i| {
            let mut stream = PixelSampler::new(i % 24, i / 24, 3);
            let at = Vec2::new((i % 24) as f32, (i / 24) as f32);
            mean(&*integrator, at, &mut stream, samples)
        }));
    }
    values
}

/// Anywhere in the pixel, so that corners and edges are met as well.
fn mean(integrator: &dyn Integrator, at: Vec2, sampler: &mut PixelSampler, samples: u32) -> Vec3 {
    let sample = |i: u32| {
        let mut stream = Stream::new(*sampler, i);
        let inside = stream.next_2d();
        integrator.sample(at + inside, &mut stream)
    };
    (0..samples).map(sample).sum::<Vec3>() / samples as f32
}

#[test]
fn a_closed_room_is_black_wherever_it_stands() {
    for distance in DISTANCES {
        for turn in turns() {
            let scene = lit_from_outside(distance, turn, 0);
            for effect in [Effect::Path, Effect::Gi, Effect::Glossy, Effect::Ao, Effect::Do, Effect::Multi] {
                let light = values(&scene, distance, effect, 32);
                let lit = light.iter().filter(|value| **value != Vec3::ZERO).count();
                assert_eq!(lit, 0, "{effect:?} at {distance} m: {lit} of {} pixels", light.len());
            }
        }
    }
}

#[test]
fn a_closed_room_full_of_fog_is_black_wherever_it_stands() {
    let fog = Medium::new(Vec3::splat(0.05), Vec3::splat(0.6), 0.2, Density::Everywhere).expect("fog");
    for distance in DISTANCES {
        for turn in turns() {
            let scene = Scene {
                medium: Some(fog.clone().into()),
                ..lit_from_outside(distance, turn, 0).scene().clone()
            };
            let scene = TracedScene::new(scene).expect("a room");
            for effect in [Effect::Path, Effect::FogDirect, Effect::FogIndirect, Effect::FogMultiple] {
                let light = values(&scene, distance, effect, 32);
                let lit = light.iter().filter(|value| **value != Vec3::ZERO).count();
                assert_eq!(lit, 0, "{effect:?} at {distance} m: {lit} of {} pixels", light.len());
            }
        }
    }
}

#[test]
fn a_room_with_a_hole_is_not_black() {
    for distance in DISTANCES {
        let scene = lit_from_outside(distance, turns()[1], 3);
        for effect in [Effect::Path, Effect::Gi, Effect::Ao] {
            let lit =
                values(&scene, distance, effect, 8).into_iter().filter(|value| *value != Vec3::ZERO).count();
            assert!(lit > 30, "{effect:?} at {distance} m: {lit} pixels");
        }
    }
}

/// A lamp in the plane of the ceiling lights all that is below it.
#[test]
fn a_lamp_in_the_ceiling_lights_the_room() {
    for distance in [0.0, 4e3, 1e5] {
        let centre = place(distance);
        let lamp = (centre + DVec3::new(0.0, HALF, 0.0)).as_vec3();
        let closed =
            traced(vec![room(centre, DQuat::IDENTITY, 0)], Material::matte("grey", Vec3::splat(0.5)));
        let lights = vec![Light::Point { position: lamp, intensity: Vec3::ONE, range: f32::INFINITY }];
        let scene = TracedScene::new(Scene { lights, ..closed.scene().clone() }).expect("a room");
        let (mut dark, mut all) = (0, 0);
        for i in 0..400 {
            let (x, z) = ((i % 20) as f64 / 19.0 - 0.5, (i / 20) as f64 / 19.0 - 0.5);
            let towards = (centre + DVec3::new(2.6 * x, -HALF, 2.6 * z)).as_vec3();
            let direction = (towards - centre.as_vec3()).normalize();
            let hit = scene.hit(centre.as_vec3(), direction, f32::INFINITY).expect("the floor");
            let point = crate::intersection::SurfacePoint::new(&scene, &hit, direction);
            let received = super::direct::direct_light(&scene, &point, -direction).diffuse;
            (dark, all) = (dark + u32::from(received == Vec3::ZERO), all + 1);
        }
        assert_eq!(dark, 0, "{dark} of {all} at {distance} m");
    }
}
