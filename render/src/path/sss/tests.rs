//! The gather against integrals of its profile, and against all pairs of pixels.

use super::*;
use crate::bvh::TracedScene;
use crate::path::{Sampling, render};
use crate::scene::{Camera, Light, Material, MaterialId, Mesh, Scene};
use deepshade_shaders::Effect;

#[test]
fn the_profile_integrates_to_what_a_disc_holds() {
    let d = 0.3f64;
    let ring = |r: f64| {
        let scattered = ((-r / d).exp() + (-r / (3.0 * d)).exp()) / (8.0 * std::f64::consts::PI * d * r);
        assert!((f64::from(profile(r as f32, d as f32)) - scattered).abs() < 1e-5 * scattered);
        std::f64::consts::TAU * r * scattered
    };
    let steps = 20_000;
    for end in [0.05, 0.3, 1.0, 9.0] {
        let step = end / f64::from(steps);
        let sum: f64 = (0..steps).map(|i| ring((f64::from(i) + 0.5) * step) * step).sum();
        assert!((sum - f64::from(within(end as f32, d as f32))).abs() < 1e-5, "{sum} up to {end}");
    }
    assert!((within(1e3, 0.3) - 1.0).abs() < 1e-6, "all of it is 1");
    let left = 1.0 - within(SUPPORT * 0.3, 0.3);
    assert!(left > 0.9e-4 && left < 1.1e-4, "{left} is left out");
}

const SIZE: usize = 64;

/// Two half planes at z = 0 that meet at x = 0, black to the left and `albedo` to the right, in even light,
/// 0.1 m of them in the image: a pixel is 0.1 / 64 m.
fn step(mean_free_path: Vec3) -> TracedScene {
    let half = |side: f32, material: u32| {
        let corners = [(0., -9.), (side, -9.), (side, 9.), (0., 9.)];
        Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: MaterialId(material),
            ..Mesh::default()
        }
    };
    let material = |grey: f32| Material { mean_free_path, ..Material::matte("matte", Vec3::splat(grey)) };
    TracedScene::new(Scene {
        meshes: vec![half(-9.0, 0), half(9.0, 1)].into(),
        materials: vec![material(0.0), material(1.0)],
        lights: vec![Light::Directional {
            direction: Vec3::NEG_Z,
            irradiance: Vec3::splat(PI),
            pattern: None,
        }],
        ..Scene::default()
    })
    .expect("two half planes")
}

/// From straight above, so far away that all pixels show the same area.
fn from_above() -> Camera {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO);
    Camera { vertical_fov: 2.0 * (0.05f32 / 10.0).atan(), ..camera }
}

/// The share of the profile beyond a line at distance `a`: over that line, `exp(-r / d) / r` gives
/// `2 K0(a / d)`.
fn beyond(a: f64, d: f64) -> f64 {
    // K0(x) = integral over t of exp(-x cosh t), integrated over the distance first: exp(-a cosh t / d) d /
    // cosh t.
    let steps = 4_000;
    let step = 12.0 / f64::from(steps);
    let share = |scale: f64| {
        let at = |i: i32| {
            let cosh = ((f64::from(i) + 0.5) * step).cosh();
            (-a * cosh / scale).exp() * scale / cosh
        };
        (0..steps).map(at).sum::<f64>() * step * 2.0 / (8.0 * std::f64::consts::PI * d)
    };
    share(d) + share(3.0 * d)
}

#[test]
fn a_step_of_light_becomes_the_integral_of_the_profile() {
    let pixel = 0.1 / SIZE as f32;
    let lengths = Vec3::new(2.0, 1.0, 0.0) * pixel;
    let (scene, camera) = (step(lengths), from_above());
    let shot = Shot::new(&scene, &camera, [SIZE; 2], 1.0);
    let image = render(Effect::Sss, &shot, Sampling::scrambled(8, 1));
    let (black, white) = (image.mean.at(2, 32, 0), image.mean.at(2, 32, 63));
    assert!(image.variance.expect("scramblings").data().iter().all(|variance| *variance == 0.0));
    assert!((beyond(0.0, 1.0) - 0.5).abs() < 1e-4, "half of it is beyond a line through the middle");
    let mut noticed: f64 = 0.0;
    for (channel, length) in [(0, 2.0), (1, 1.0)] {
        for x in 16..48 {
            let from_edge = x as f64 + 0.5 - 32.0;
            let share = (image.mean.at(channel, 32, x) - black) / (white - black);
            let lit = |length: f64| {
                let beyond = beyond(from_edge.abs(), length);
                if from_edge > 0.0 { 1.0 - beyond } else { beyond }
            };
            let off = (f64::from(share) - lit(length)).abs();
            assert!(off < 0.012, "{channel} at {x}: {share} is not {}", lit(length));
            noticed = noticed.max((f64::from(share) - lit(1.2 * length)).abs());
        }
    }
    assert!(noticed > 0.018, "a profile wider by a fifth is noticed: {noticed}");
    // Blue is not scattered.
    assert!((0..SIZE).all(|x| image.mean.at(2, 32, x) == if x < 32 { black } else { white }));
}

#[test]
fn even_light_stays_as_it_is() {
    let mut scene = step(Vec3::new(0.02, 0.01, 0.003)).scene().clone();
    scene.materials[0] = scene.materials[1].clone();
    let (scene, camera) = (TracedScene::new(scene).expect("a plane"), from_above());
    let shot = Shot::new(&scene, &camera, [33, 21], 1.0);
    let image = render(Effect::Sss, &shot, Sampling::one(1, 1)).mean;
    let light = render(Effect::Dof, &shot, Sampling::one(1, 1)).mean;
    let pairs = image.data().iter().zip(light.data());
    assert!(pairs.clone().all(|(found, expected)| (found - expected).abs() < 1e-4 * expected));
    assert!(light.data().iter().all(|value| *value > 0.9));
}

#[test]
fn weights_of_a_plane_add_up_to_one() {
    let (scene, camera) = (step(Vec3::splat(0.003)), from_above());
    let seen: Vec<Patch> = patches(&Shot::new(&scene, &camera, [SIZE; 2], 1.0))
        .into_iter()
        .map(|patch| patch.expect("a plane"))
        .collect();
    let area = 0.1 / SIZE as f32 * 0.1 / SIZE as f32;
    assert!(seen.iter().all(|patch| (patch.area - area).abs() < 1e-3 * area));
    for d in [0.5f32, 1.0, 2.0].map(|pixels| pixels * 0.1 / SIZE as f32) {
        let receiver = &seen[SIZE * SIZE / 2 + SIZE / 2];
        let sum: f32 = seen.iter().map(|patch| tree::weight_of(patch, receiver, d)).sum();
        assert!((sum - 1.0).abs() < 0.06, "{sum} for {d}");
    }
}

/// A still life, of wax.
fn still_life() -> (TracedScene, Camera) {
    let mut scene = crate::scene::procedural::Family::StillLife.scene(3);
    for material in &mut scene.materials {
        material.mean_free_path = Vec3::new(0.05, 0.02, 0.005);
    }
    scene.lights.push(Light::Point {
        position: scene.bounds().centre() + Vec3::Y,
        intensity: Vec3::ONE,
        range: f32::INFINITY,
    });
    let scene = TracedScene::new(scene).expect("a still life");
    let camera = Camera::look_at(
        scene.bounds().centre() + Vec3::new(0.3, 0.4, 0.5) * scene.diagonal(),
        scene.bounds().centre(),
    );
    (scene, camera)
}

#[test]
fn groups_of_pixels_stand_for_all_of_them() {
    let (scene, camera) = still_life();
    let shot = Shot::new(&scene, &camera, [72, 96], 1.0);
    let seen: Vec<Patch> = patches(&shot).into_iter().flatten().collect();
    let tree = Tree::new(seen.clone());
    let (mut worst, mut squares, mut blur) = (0.0f32, 0.0, 0.0);
    for receiver in seen.iter().step_by(7) {
        let gathered = tree.gather(receiver);
        for c in 0..3 {
            let d = receiver.mean_free_path[c];
            let (mut light, mut weights) = (0.0f64, 0.0f64);
            for patch in &seen {
                let weight = f64::from(tree::weight_of(patch, receiver, d));
                light += weight * f64::from(patch.light[c]);
                weights += weight;
            }
            let all = (light / weights) as f32;
            worst = worst.max((gathered[c] - all).abs() / all.max(0.05));
            squares += (gathered[c] - all).powi(2);
            blur += (receiver.light[c] - all).powi(2);
        }
    }
    assert!(worst < 0.06 && squares < 1e-5 * blur, "{worst}, {squares} of {blur}");
}

#[test]
fn pixels_that_see_nothing_stay_black() {
    let mut scene = step(Vec3::splat(0.01)).scene().clone();
    scene.meshes.truncate(1);
    let (scene, camera) = (TracedScene::new(scene).expect("half a plane"), from_above());
    let image = render(Effect::Sss, &Shot::new(&scene, &camera, [16, 16], 1.0), Sampling::one(1, 1)).mean;
    assert_eq!(image.at(0, 8, 12), 0.0);
    let away = Camera::look_at(Vec3::Z * 10.0, Vec3::Z * 20.0);
    let nothing = render(Effect::Sss, &Shot::new(&scene, &away, [16, 16], 1.0), Sampling::one(1, 1)).mean;
    assert!(nothing.data().iter().all(|value| *value == 0.0));
}
