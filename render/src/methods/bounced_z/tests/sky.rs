//! Light of the sky: the passes against the plain version, even skies, and truth.

use super::super::directional::DIRECTIONAL;
use super::super::sky_light::SKY_LIGHT;
use super::*;
use crate::methods::disks::DiskEffect;
use crate::path::proving::with_environment;
use crate::scene::Environment;

/// Bright above, red on one side; radiance up to 1.
fn dusk() -> Environment {
    let texel = |i: usize| Vec3::new(1.0 + (i % 8) as f32 / 4.0, 1.0, 1.0) * (3 - i / 8) as f32 / 8.25;
    Environment::new("dusk".as_ref(), 8, 4, (0..32).map(texel).collect()).expect("radiance")
}

#[test]
fn the_passes_see_of_the_sky_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let surfels = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let parameters = BouncedZParameters { surfels, ..BouncedZParameters::of(Quality::High) };
    let (scene, view, gbuffer) = seen(Family::StillLife, 27, 35);
    let frame = (with_environment(scene, dusk().rotated(0.7)), view, gbuffer);
    for effect in [DIRECTIONAL, SKY_LIGHT] {
        let method = ScreenMethod::new(&gpu, Disks::new(parameters, effect));
        // A ray that just meets a disk in one may just miss it in the other.
        prove_twin(&method, &frame, Tolerance { usual: 1e-3, worst: 0.1 });
    }
}

#[test]
fn light_of_the_sky_that_a_wall_reflects_is_that_which_it_hides_times_its_colour() {
    let (scene, view, gbuffer) = corner();
    let mut scene = scene.scene().clone();
    scene.environment = Some(Environment::uniform(Vec3::ONE).into());
    let colour = f64::from(scene.materials[0].base_colour.x);
    let scene = TracedScene::new(scene).expect("two squares");
    let frame =
        Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let shaded = |effect| {
        let method = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), effect));
        method.shade(&frame, Repeats::ONCE).expect("an image").image.mean()
    };
    let valid = gbuffer.seen().expect("a mask");
    let seen = valid.iter().filter(|seen| **seen).count() as f64 / valid.len() as f64;
    let as_wide = DiskEffect { effect: SKY_LIGHT.effect, ..DIRECTIONAL };
    let (at_once, all) = (shaded(as_wide), shaded(SKY_LIGHT));
    // Of what is hidden a surface that is as hidden itself sends its colour times what it sees.
    let hidden = seen - at_once;
    let ratio = (all - at_once) / (hidden * colour);
    assert!(hidden > 0.05 && (0.6..1.0).contains(&ratio), "{hidden} hidden, {ratio}");
}

#[test]
fn of_an_even_sky_the_share_is_that_which_is_open() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let (scene, view, gbuffer) = seen(Family::StillLife, 24, 32);
    let radiance = Vec3::new(2.0, 1.0, 0.5);
    let scene = with_environment(scene, Environment::uniform(radiance));
    let frame =
        Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
    let shaded = |effect| {
        let method = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), effect));
        method.shade(&frame, Repeats::ONCE).expect("an image").image
    };
    let (open, light) = (shaded(OCCLUSION), shaded(DIRECTIONAL));
    let valid = gbuffer.seen().expect("a mask");
    for (c, radiance) in radiance.to_array().into_iter().enumerate() {
        for ((open, light), valid) in open.plane(0).iter().zip(light.plane(c)).zip(&valid) {
            let wanted = if *valid { radiance * open } else { 0.0 };
            assert!((light - wanted).abs() < 5e-3 * radiance, "{light} in place of {wanted}");
        }
    }
}

#[test]
fn in_a_room_it_is_nearer_to_truth_than_what_adds_all_surfels_up() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let (scene, view, gbuffer) = seen(Family::Room, 96, 128);
    let scene = with_environment(scene, dusk());
    let frame =
        Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
    let shot = Shot::new(&scene, &view.camera, [96, 128], view.radius);
    let truth = path::render(Effect::Do, &shot, Sampling::one(128, 1)).mean;
    let off = |method: &dyn Method| {
        mean_difference(&method.shade(&frame, Repeats::ONCE).expect("an image").image, &truth)
    };
    let bounced = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), DIRECTIONAL));
    let added = surfel::SurfelParameters::of(Quality::High);
    let surfel = ScreenMethod::new(&gpu, Disks::new(added, surfel::directional::DIRECTIONAL));
    let [near, far] = [off(&bounced), off(&surfel)];
    assert!(near < 0.5 * far, "{near} off, all surfels {far}");
}
