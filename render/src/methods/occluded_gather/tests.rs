//! The passes against the plain version, the two parts apart, and both beside truth.

use super::*;
use crate::gbuffer;
use crate::methods::proving::{Tolerance, everything, on_gpu, prove_comparator, prove_twin};
use crate::metrics::relative_mse;
use crate::path::{self, Sampling, Shot};
use crate::scene::Camera;
use crate::screen::ScreenMethod;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::Gpu;

fn method(quality: Quality) -> ScreenMethod {
    let gpu = Gpu::new().expect("the tests need an adapter; lavapipe will do");
    ScreenMethod::new(&gpu, OccludedGatherParameters::of(quality))
}

/// What rounding puts on a neighbouring pixel, as of its parts.
const TOLERANCE: Tolerance = Tolerance { usual: 2e-3, worst: 1.0 };

#[test]
fn the_passes_write_what_the_plain_version_does() {
    for quality in [Quality::Low, Quality::High] {
        let (_, view, gbuffer) = everything(41, 59);
        prove_twin(&method(quality), &gbuffer, None, &view, TOLERANCE);
        prove_comparator(&on_gpu(&method(quality), &gbuffer, None, &view), TOLERANCE);
    }
}

#[test]
fn without_a_lens_it_is_light_times_openness() {
    let (scene, view, _) = everything(41, 59);
    let view = View { camera: Camera { lens: None, ..view.camera }, ..view };
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, &Attribute::ALL);
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: None };
    let parameters = OccludedGatherParameters::of(Quality::High);
    let openness =
        parameters.occlusion.reference(&inputs, &view).expect("attributes").pop().expect("an image");
    let light = gbuffer.select(&[Attribute::Light]).expect("it is there");
    let image = parameters.reference(&inputs, &view).expect("attributes").pop().expect("an image");
    for (at, value) in image.iter().enumerate() {
        let expected = light.data()[at] * openness[at % openness.len()];
        assert!((value - expected).abs() < 1e-6, "{value} {expected}");
    }
    assert!(openness.iter().any(|open| *open < 0.9), "what nothing hides proves nothing");
}

#[test]
fn both_are_nearer_to_truth_than_each_alone() {
    let (scene, view, gbuffer) = everything(64, 96);
    let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::Multi, &shot, Sampling::one(128, 1)).mean;
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: None };
    let parameters = OccludedGatherParameters::of(Quality::High);
    let image = |written: Written| {
        Planes::from_data(3, view.height, view.width, written.into_iter().next_back().expect("an image"))
    };
    let both = image(parameters.reference(&inputs, &view).expect("attributes"));
    let lens = image(parameters.lens.reference(&inputs, &view).expect("attributes"));
    let light = gbuffer.select(&[Attribute::Light]).expect("it is there");
    let openness =
        parameters.occlusion.reference(&inputs, &view).expect("attributes").pop().expect("an image");
    let occluded = Planes::from_fn(3, view.height, view.width, |c, y, x| {
        light.at(c, y, x) * openness[y * view.width + x]
    });
    let error = |image: &Planes| relative_mse(image, &truth);
    let (both, lens, occluded) = (error(&both), error(&lens), error(&occluded));
    assert!(both < 0.8 * lens && both < 0.8 * occluded, "{both}, lens {lens}, occlusion {occluded}");
}
