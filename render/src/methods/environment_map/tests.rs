use super::*;
use crate::path::proving::{integral, spotted};
use std::f32::consts::FRAC_PI_4;

#[test]
fn a_small_map_has_the_environments_mean() {
    for environment in [spotted(), spotted().rotated(1.0), Environment::uniform(Vec3::new(0.5, 1.0, 2.0))] {
        let expected = integral(&environment, |_| Vec3::ONE) / (4.0 * PI);
        for height in [8, 16, 27] {
            let map = EnvironmentMap::new(&environment, height);
            let weight = |i: usize| ((i / (2 * height)) as f32 + 0.5) * PI / height as f32;
            let sum: Vec3 = map.texels.iter().enumerate().map(|(i, texel)| *texel * weight(i).sin()).sum();
            let weights: f32 = (0..map.texels.len()).map(|i| weight(i).sin()).sum();
            assert!(
                (sum / weights / expected - 1.0).abs().max_element() < 0.02,
                "{height}: {}",
                sum / weights
            );
        }
    }
}

#[test]
fn a_map_as_fine_as_the_environment_is_laid_out_alike() {
    // Smooth, and different in all directions.
    let texel = |i: usize| {
        let direction =
            direction_at(Vec2::new((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5) / Vec2::new(64.0, 32.0));
        Vec3::splat(1.0) + direction * Vec3::new(0.9, 0.8, 0.7)
    };
    let smooth =
        Environment::new("smooth".as_ref(), 64, 32, (0..64 * 32).map(texel).collect()).expect("radiance");
    let turned = smooth.clone().rotated(FRAC_PI_4);
    for (environment, other) in [(&smooth, &turned), (&turned, &smooth)] {
        let map = EnvironmentMap::new(environment, 32);
        let directions = (0..200)
            .map(|i| Vec3::from_array([1, 2, 3].map(|k| (i * k * k) as f32).map(f32::sin)).normalize());
        let worst = |environment: &Environment| {
            let distance =
                |direction| (map.radiance(direction) - environment.radiance(direction)).abs().max_element();
            directions.clone().map(distance).fold(0.0, f32::max)
        };
        assert!(worst(environment) < 0.02, "{}", worst(environment));
        assert!(worst(other) > 0.3, "turned otherwise");
    }
}
