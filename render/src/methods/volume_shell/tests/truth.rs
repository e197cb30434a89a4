//! Nearer to path-traced truth than no light.

use super::*;
use crate::methods::proving::mean_difference;
use crate::methods::volume_shell::direct::Direct;
use crate::path::{self, Sampling, Shot};

fn truth(effect: Effect, (scene, view, _): &ViewedScene) -> Planes {
    let shot = Shot::new(scene, &view.camera, [view.height, view.width], view.radius);
    path::render(effect, &shot, Sampling::one(256, 1)).mean
}

#[test]
fn indirect_light_is_as_bright_as_truth() {
    let gpu = gpu();
    for medium in [fog(0.3), smoke()] {
        let seen = filled(medium);
        let truth = truth(Effect::FogIndirect, &seen);
        let image = image(&gpu, VolumeShellParameters::of(Quality::High), &seen);
        let ratio = mean(&image) / mean(&truth);
        assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
        let off = mean_difference(&image, &truth) / mean(&truth);
        assert!(off < 0.15, "{off}");
    }
}

#[test]
fn direct_light_is_as_bright_as_truth() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, Direct(VolumeShellParameters::of(Quality::High)));
    for medium in [fog(0.3), smoke()] {
        let seen = filled(medium);
        let truth = truth(Effect::FogDirect, &seen);
        let image = shaded(&method, &seen);
        let ratio = mean(&image) / mean(&truth);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        let off = mean_difference(&image, &truth) / mean(&truth);
        assert!(off < 0.15, "{off}");
    }
}
