//! The passes against the plain version.

use super::*;
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::prove_twin;
use crate::methods::volume_shell::direct::Direct;

/// Radiance of surfels has nine bits, and shadow maps end within a texel of where shadows do.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 2e-3 };

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, coarse());
    for medium in [fog(0.3), smoke()] {
        prove_twin(&method, &filled(medium), TOLERANCE);
    }
}

#[test]
fn they_do_so_without_each_improvement() {
    let gpu = gpu();
    let seen = filled_at(smoke(), 21, 30);
    let as_in_the_paper = VolumeShellParameters { improvements: Improvements::NONE, ..coarse() };
    for parameters in Improvement::ALL.map(without).into_iter().chain([as_in_the_paper]) {
        println!("{:?}", parameters.improvements);
        prove_twin(&ScreenMethod::new(&gpu, parameters), &seen, TOLERANCE);
    }
}

/// So many surfels and lookups that a software device would end the loops of a pixel early, were they not cut
/// into parts.
#[test]
fn long_walks_are_walked_to_their_end() {
    let gpu = gpu();
    let long = VolumeShellParameters {
        surfels: surfels::SurfelDensity { scale: 0.02, near: 0.25 },
        threshold: 0.01,
        levels: 2,
        ..coarse()
    };
    let seen = filled_at(smoke(), 8, 10);
    let (scene, view, gbuffer) = &seen;
    let work = reference::work(gbuffer, scene, &long, view).expect("attributes");
    println!("{work:?}");
    assert!(work.visits > 65_535 * 80, "{work:?}");
    prove_twin(&ScreenMethod::new(&gpu, long), &seen, TOLERANCE);
}

#[test]
fn direct_light_is_what_the_plain_version_has() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, Direct(coarse()));
    for medium in [fog(0.3), smoke()] {
        prove_twin(&method, &filled(medium), Tolerance { usual: 1e-4, worst: 0.05 });
    }
}
