//! The passes against the plain version, limits that are known, and both parts beside truth.

use super::*;
use crate::methods::proving::{Tolerance, everything, on_gpu, prove_comparator, prove_twin};
use crate::metrics::relative_mse;
use crate::path::proving::{coloured, with_environment};
use crate::path::{self, Sampling, Shot};
use crate::scene::procedural::sky;
use crate::screen::ScreenMethod;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::Gpu;

/// Of its parts: neighbours at edges.
const TOLERANCE: Tolerance = Tolerance { usual: 2e-3, worst: 0.3 };

#[test]
fn the_passes_write_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("the tests need an adapter; lavapipe will do");
    let environment = coloured();
    for quality in [Quality::Low, Quality::Medium] {
        let (_, view, gbuffer) = everything(41, 59);
        let method = ScreenMethod::new(&gpu, OccludedPrefilteredParameters::of(quality));
        prove_twin(&method, &gbuffer, Some(&environment), &view, TOLERANCE);
        prove_comparator(&on_gpu(&method, &gbuffer, Some(&environment), &view), TOLERANCE);
    }
}

#[test]
fn a_lobe_is_dimmed_less_than_the_hemisphere_from_the_front_and_fully_where_all_is_closed() {
    for roughness in [0.05, 0.3, 0.6, 1.0] {
        for cosine in [0.1, 0.5, 1.0] {
            assert_eq!(specular_share(cosine, 1.0, roughness), 1.0, "nothing is hidden");
            assert_eq!(specular_share(cosine, 0.0, roughness), 0.0, "all is hidden");
        }
        assert!(specular_share(1.0, 0.5, roughness) >= 0.5, "seen from above");
    }
    // A mirror that is seen from above shows what is above, not what is hidden beside it.
    let [mirror, rough] = [0.05, 0.8].map(|roughness| specular_share(0.9, 0.5, roughness));
    assert!(mirror > rough + 0.1, "{mirror} {rough}");
    let [above, grazing] = [0.9, 0.1].map(|cosine| specular_share(cosine, 0.5, 0.1));
    assert!(above > grazing + 0.1, "{above} {grazing}");
}

#[test]
fn it_is_nearer_to_truth_than_an_environment_that_nothing_blocks() {
    let (scene, view, gbuffer) = everything(64, 96);
    let environment = sky(5);
    let scene = with_environment(scene, environment.clone());
    let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::OccludedIbl, &shot, Sampling::one(128, 1)).mean;
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: Some(&environment), scene: None };
    let image = |written: Written| {
        Planes::from_data(3, view.height, view.width, written.into_iter().next_back().expect("an image"))
    };
    let parameters = OccludedPrefilteredParameters::of(Quality::High);
    let occluded = image(parameters.reference(&inputs, &view).expect("attributes"));
    let open = image(parameters.light.reference(&inputs, &view).expect("attributes"));
    let [occluded, open] = [&occluded, &open].map(|image| relative_mse(image, &truth));
    assert!(occluded < 0.8 * open, "{occluded}, nothing blocked {open}");
}
