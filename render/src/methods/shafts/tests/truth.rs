//! The path tracer's `fog-direct`.

use super::*;
use crate::path::{Sampling, Shot, render};
use crate::scene::{DensityGrid, Encoding, Texture, TextureId, Wrap};

const SIZE: [usize; 2] = [36, 48];

fn truth(scene: &TracedScene, camera: &Camera, samples: u32) -> Planes {
    let shot = Shot::new(scene, camera, SIZE, f32::INFINITY);
    render(Effect::FogDirect, &shot, Sampling::one(samples, 5)).mean
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(-3.0, 1.5, 4.0), Vec3::new(0.0, 1.2, 0.0))
}

fn lights() -> [Light; 3] {
    let above = Vec3::new(0.5, 5.0, -3.0);
    [sun(Vec3::new(0.3, -1.0, 0.4)), lamp(above), spot(above, Vec3::new(-0.2, -1.0, 0.5))]
}

/// The tolerance for a method: more for those that interpolate.
fn sampled(method: &dyn Method, tolerance: f64) -> f64 {
    match method.name() {
        epipolar_sampling::EpipolarSamplingParameters::NAME => 4.0 * tolerance,
        "froxel" => 5.0 * tolerance,
        _ => tolerance,
    }
}

/// All methods, of which epipolar sampling marches every fourth pixel, since lines are short here.
fn all_methods() -> [Box<dyn Method>; 4] {
    let [march, tree, _, min_max] = methods(Quality::High);
    let usual = epipolar_sampling::EpipolarSamplingParameters::of(Quality::High);
    [
        march,
        tree,
        Box::new(Shafts(epipolar_sampling::EpipolarSamplingParameters { spacing: 4, ..usual })),
        min_max,
    ]
}

/// All methods, none of which is told what hides the light.
fn blind() -> [Box<dyn Method>; 4] {
    let quality = Quality::High;
    [
        Box::new(Shafts(Unshadowed(ray_march::RayMarchParameters::of(quality)))),
        Box::new(Shafts(Unshadowed(epipolar::EpipolarParameters::of(quality)))),
        Box::new(Shafts(Unshadowed(epipolar_sampling::EpipolarSamplingParameters::of(quality)))),
        Box::new(Shafts(Unshadowed(min_max::MinMaxParameters::of(quality)))),
    ]
}

#[test]
fn all_methods_see_what_the_path_tracer_sees_of_every_light() {
    for light in lights() {
        let scene = scene(pergola(), vec![light], fog(0.5, AROUND));
        let truth = truth(&scene, &camera(), 2048);
        for method in all_methods().into_iter().chain(on_gpu()) {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            let [right, brighter] = [error(&found, &truth), error(&exposed(&found, 1.2), &truth)];
            let most = sampled(method.as_ref(), 1e-3);
            assert!(right < most, "{} of {light:?}: {right:e}", method.name());
            assert!(brighter > most, "{} of {light:?}, a fifth brighter: {brighter:e}", method.name());
        }
        // Who is not told what hides the light is found out.
        for method in blind() {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            let wrong = error(&found, &truth);
            assert!(wrong > 2e-2, "{} of {light:?}: {wrong:e}", method.name());
        }
    }
}

#[test]
fn all_methods_see_rings_of_light() {
    let ring = |i: usize| {
        let [x, y] = [i % 64, i / 64].map(|at| (at as f32 - 31.5) / 32.0);
        if (0.4..0.7).contains(&x.hypot(y)) { [255, 160, 40, 255] } else { [0, 0, 0, 255] }
    };
    let texture = Texture::new(64, 64, (0..64 * 64).map(ring).collect(), Encoding::Linear, [Wrap::Repeat; 2]);
    let position = Vec3::new(0.5, 5.5, -1.0);
    let plain = spot(position, Vec3::new(-0.1, -1.0, 0.2));
    let mut slide = plain;
    if let Light::Spot { slide, .. } = &mut slide {
        *slide = Some(TextureId(0));
    }
    let Light::Directional { direction, irradiance, .. } = sun(Vec3::new(0.3, -1.0, 0.4)) else { return };
    let glass = Light::Directional { direction, irradiance, pattern: Some((TextureId(0), 3.0)) };
    for (light, plain) in [(slide, plain), (glass, sun(direction))] {
        let of = |light: Light| {
            let scene = scene(vec![floor()], vec![], fog(0.5, AROUND));
            let (lights, textures) = (vec![light], vec![texture.clone().into()]);
            let scene = Scene { lights, textures, ..scene.scene().clone() };
            TracedScene::new(scene).expect("triangles")
        };
        let [scene, plain] = [of(light), of(plain)];
        let truth = truth(&scene, &camera(), 2048);
        for method in all_methods().into_iter().chain(on_gpu()) {
            let [found, without] = [&scene, &plain]
                .map(|scene| image(method.as_ref(), scene, &camera(), SIZE).expect("an image"));
            let [right, wrong] = [error(&found, &truth), error(&without, &truth)];
            assert!(right < sampled(method.as_ref(), 5e-3), "{} of {light:?}: {right:e}", method.name());
            assert!(wrong > 0.1, "{} without {light:?}: {wrong:e}", method.name());
        }
    }
}

#[test]
fn without_a_medium_there_is_nothing() {
    let scene = Scene {
        meshes: pergola().into(),
        materials: vec![Material::default()],
        lights: lights().to_vec(),
        ..Scene::default()
    };
    let scene = TracedScene::new(scene).expect("triangles");
    for quality in [Quality::Low, Quality::Ultra] {
        for method in methods(quality).into_iter().chain(on_gpu()) {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            assert!(found.data().iter().all(|value| *value == 0.0), "{}", method.name());
        }
    }
}

#[test]
fn lights_add_up() {
    let all = lights().to_vec();
    let whole = scene(pergola(), all.clone(), fog(0.5, AROUND));
    let [_, epipolar, ..] = methods(Quality::Low);
    let shade = |scene: &TracedScene| image(epipolar.as_ref(), scene, &camera(), SIZE).expect("an image");
    let mut sum = Planes::filled(3, SIZE[0], SIZE[1], 0.0);
    for light in all {
        let one = shade(&scene(pergola(), vec![light], fog(0.5, AROUND)));
        sum.data_mut().iter_mut().zip(one.data()).for_each(|(sum, one)| *sum += one);
    }
    let found = shade(&whole);
    assert!(found.data().iter().zip(sum.data()).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs()));
}

#[test]
fn a_march_goes_through_grids() {
    let [min, max] = AROUND.map(Vec3::from);
    let cell = |i: usize| [0.2, 1.5, 0.6, 0.0, 1.0, 2.0, 0.3, 0.8][i % 8];
    let grid = DensityGrid::new(Bounds { min, max }, [4, 2, 3], (0..24).map(cell).collect()).expect("a grid");
    let medium = Medium { density: Density::Grid(grid), ..fog(0.3, AROUND) };
    for light in lights() {
        let scene = scene(pergola(), vec![light], medium.clone());
        let truth = truth(&scene, &camera(), 4096);
        let [march, _, sampling, _] = all_methods();
        for method in [march, sampling]
            .into_iter()
            .chain(on_gpu().into_iter().filter(|method| method.name() != "gpu-epipolar"))
        {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            let error = error(&found, &truth);
            assert!(error < sampled(method.as_ref(), 3e-3), "{} of {light:?}: {error:e}", method.name());
        }
        for method in [1, 3].map(|i| methods(Quality::Low).into_iter().nth(i).expect("four")) {
            let refused = image(method.as_ref(), &scene, &camera(), SIZE).expect_err("a grid").to_string();
            assert!(refused.contains("grid") && refused.contains(method.name()), "{refused}");
        }
    }
}
