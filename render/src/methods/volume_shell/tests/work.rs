//! What splatting takes grows linearly, counted, not timed.

use super::*;
use crate::methods::volume_shell::reference::{SplatCounts, work};

fn of(parameters: VolumeShellParameters, (scene, view, gbuffer): &ViewedScene) -> SplatCounts {
    work(gbuffer, scene, &parameters, view).expect("attributes")
}

/// The power of the second numbers by which the first ones grow.
fn slope([few, many]: [u64; 2], [small, large]: [f64; 2]) -> f64 {
    (many as f64 / few as f64).ln() / (large / small).ln()
}

#[test]
fn work_is_linear_in_intervals() {
    let seen = filled_at(smoke(), 24, 32);
    for improvements in [Improvements::ALL, Improvements::NONE] {
        let visits = |samples| of(VolumeShellParameters { samples, improvements, ..coarse() }, &seen).visits;
        let power = slope([16, 64].map(visits), [15.0, 63.0]);
        assert!((power - 1.0).abs() < 0.05, "{power}");
    }
}

#[test]
fn work_is_linear_in_pixels() {
    let visits = |share: usize| of(coarse(), &filled_at(smoke(), 24 * share, 32 * share)).visits;
    let power = slope([1, 2].map(visits), [1.0, 4.0]);
    assert!((power - 1.0).abs() < 0.1, "{power}");
}

#[test]
fn work_grows_no_faster_than_surfels() {
    let seen = filled_at(smoke(), 24, 32);
    let of = |scale: f32| {
        of(VolumeShellParameters { surfels: surfels::SurfelDensity { scale, near: 0.25 }, ..coarse() }, &seen)
    };
    // Half the radius, four times the surfels.
    let power = slope([0.1, 0.05].map(|scale| of(scale).visits), [1.0, 4.0]);
    assert!((0.2..1.05).contains(&power), "{power}");
}

#[test]
fn only_what_shells_touch_is_visited() {
    let seen = filled_at(smoke(), 24, 32);
    let (few, all) = (of(coarse(), &seen), of(without(Improvement::TouchedOnly), &seen));
    assert_eq!(few.pairs, all.pairs);
    assert_eq!(all.visits, 15 * all.pairs);
    assert!(10 * few.visits < 9 * all.visits, "{few:?}, {all:?}");
}
