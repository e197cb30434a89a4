//! Directional occlusion by surfels: against the ambient occlusion of the same surfels, its plain version,
//! and truth.

use super::super::directional::DIRECTIONAL;
use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::methods::proving::beyond::ATTRIBUTES;
use crate::methods::proving::{self, mean_difference};
use crate::path::proving::{spotted, with_environment};
use crate::path::{self, Sampling, Shot};
use crate::scene::Environment;
use deepshade_shaders::{Effect, GBuffer};

const COARSE: surfels::SurfelDensity = surfels::SurfelDensity { scale: 0.03, near: 0.25 };

fn parameters() -> SurfelParameters {
    SurfelParameters { surfels: COARSE, levels: 4, ..SurfelParameters::of(Quality::High) }
}

fn method() -> ScreenMethod {
    ScreenMethod::new(
        &Gpu::new().expect("an adapter; lavapipe will do"),
        Disks::new(parameters(), DIRECTIONAL),
    )
}

fn image(method: &ScreenMethod, (scene, view, gbuffer): &(TracedScene, View, GBuffer)) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    Method::shade(method, &frame, Repeats::ONCE).expect("an image").image
}

/// [`seen`] under an environment.
fn under(environment: Option<Environment>) -> (TracedScene, View, GBuffer) {
    let (scene, view, gbuffer) = seen(Family::StillLife, 40, 56);
    (environment.map_or(scene.clone(), |it| with_environment(scene, it)), view, gbuffer)
}

#[test]
fn light_from_everywhere_is_what_is_open_for_it() {
    let of_surfels =
        ScreenMethod::new(&Gpu::new().expect("an adapter"), Disks::new(parameters(), occlusion::OCCLUSION));
    let everywhere = under(Some(Environment::uniform(Vec3::new(2.0, 1.0, 0.5))));
    let open = image(&of_surfels, &everywhere);
    let light = image(&method(), &everywhere);
    let valid = everywhere.2.seen().expect("a mask");
    for (channel, radiance) in [2.0, 1.0, 0.5].into_iter().enumerate() {
        for (pixel, light) in light.plane(channel).iter().enumerate() {
            let wanted = if valid[pixel] { radiance * open.plane(0)[pixel] } else { 0.0 };
            assert!((light - wanted).abs() < 2e-3 * radiance, "{light} in place of {wanted} at {pixel}");
        }
    }
}

#[test]
fn it_is_black_without_an_environment() {
    assert!(image(&method(), &under(None)).data().iter().all(|light| *light == 0.0));
}

#[test]
fn the_passes_hide_what_the_plain_version_does() {
    let tolerance = Tolerance { usual: 1e-3, worst: 0.1 };
    prove_twin(&method(), &under(Some(spotted().rotated(0.7))), tolerance);
}

/// Bright above, red on one side.
fn dusk() -> Environment {
    let texel = |i: usize| Vec3::new(1.0 + (i % 8) as f32 / 4.0, 1.0, 1.0) * (3 - i / 8) as f32;
    Environment::new("dusk".as_ref(), 8, 4, (0..32).map(texel).collect()).expect("radiance")
}

#[test]
fn it_is_nearer_to_truth_than_light_that_nothing_blocks() {
    let (height, width) = (43, 61);
    let scene = with_environment(proving::corner(), dusk());
    let camera = Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8));
    let gbuffer = gbuffer::render(&scene, &camera, height, width, ATTRIBUTES);
    let view = View { camera, ..view(height, width, 1.0) };
    let shot = Shot::new(&scene, &camera, [height, width], view.radius);
    let truth = path::render(Effect::Do, &shot, Sampling::one(256, 1)).mean;
    let [found, nothing_near] = [view.radius, 1e-3 * view.radius].map(|radius| {
        let seen = (scene.clone(), View { radius, ..view }, gbuffer.clone());
        mean_difference(&image(&method(), &seen), &truth)
    });
    assert!(nothing_near > 0.03 && found < 0.5 * nothing_near, "open {nothing_near}, surfels {found}");
}
