//! Directions that together stand for an environment, spread by the Hammersley points of the unit square
//! (Pharr, Jakob and Humphreys, "Physically Based Rendering", 8.6.1), which a turn shifts (Cranley and
//! Patterson 1976).

use super::{Environment, EnvironmentSample};
use crate::scene::Light;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

impl Environment {
    /// `count` directions of its light, each with the density with which it was taken: the mean of radiance
    /// over density is its integral. Those that happen to be dark are left out.
    pub fn directions(&self, count: u32, turn: Vec2) -> impl Iterator<Item = EnvironmentSample> {
        let samples =
            (0..count).filter_map(move |index| self.sample(shifted(hammersley(index, count), turn)));
        samples.filter(|sample| sample.radiance != Vec3::ZERO)
    }

    /// `count` lamps that together are as bright as it.
    pub fn lamps(&self, count: u32) -> Vec<Light> {
        let directions = || self.directions(count, Vec2::ZERO);
        // Few directions miss some of the light, or have too much of it.
        let found: Vec3 = directions().map(|sample| sample.radiance / sample.density).sum();
        let share = 4.0 * PI * self.mean() / found.max(Vec3::splat(f32::MIN_POSITIVE));
        let lamp = |EnvironmentSample { direction, radiance, density }| Light::Directional {
            direction: -direction,
            irradiance: share * radiance / density,
            pattern: None,
        };
        directions().map(lamp).collect()
    }
}

/// A point of so many that fill the unit square evenly.
fn hammersley(index: u32, count: u32) -> Vec2 {
    let reversed = (index.reverse_bits() >> 8) as f32 / 16_777_216.0;
    Vec2::new(index as f32 / count as f32, reversed) + 0.5 / count as f32
}

fn shifted(point: Vec2, turn: Vec2) -> Vec2 {
    (point + turn).fract().min(Vec2::splat(1.0 - f32::EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance of a surface that faces a direction.
    fn irradiance(lamps: &[Light], normal: Vec3) -> Vec3 {
        let received = |lamp: &Light| match lamp {
            Light::Directional { direction, irradiance, .. } => {
                *irradiance * normal.dot(-*direction).max(0.0)
            }
            Light::Point { .. } | Light::Spot { .. } => unreachable!("a sky is far away"),
        };
        lamps.iter().map(received).sum()
    }

    #[test]
    fn lamps_light_as_their_environment_does() {
        let radiance = Vec3::new(0.5, 1.0, 2.0);
        let uniform = Environment::uniform(radiance).lamps(32);
        let off = |normal: Vec3| (irradiance(&uniform, normal) / (PI * radiance) - 1.0).abs().max_element();
        assert!([Vec3::Y, Vec3::NEG_Y].into_iter().all(|normal| off(normal) < 1e-4));
        for normal in [Vec3::X, Vec3::NEG_Z, Vec3::new(1.0, -2.0, 0.5).normalize()] {
            assert!(off(normal) < 0.06, "{normal}: {}", off(normal));
        }
        // A small sun: nearly all light comes from one texel, in whose middle it is brightest.
        let mut texels = vec![Vec3::splat(0.01); 64 * 32];
        texels[5 * 64 + 20] = Vec3::new(2e4, 1e4, 5e3);
        let sky = Environment::new("sun".as_ref(), 64, 32, texels).expect("a sky");
        let many = sky.directions(1 << 16, Vec2::ZERO);
        let many =
            many.map(|it| it.radiance * (it.direction.y.max(0.0) / (it.density * 65_536.0))).sum::<Vec3>();
        let few = irradiance(&sky.lamps(32), Vec3::Y);
        assert!((few / many - 1.0).abs().max_element() < 0.01, "{few} {many}");
        assert!(Environment::uniform(Vec3::ZERO).lamps(32).is_empty());
    }

    #[test]
    fn any_turn_has_the_same_integral() {
        let sky = crate::scene::procedural::sky(3);
        let sum = |count: u32, turn: Vec2| -> Vec3 {
            let light = sky.directions(count, turn).map(|it| it.radiance / it.density);
            light.sum::<Vec3>() / count as f32
        };
        let whole = sky.mean() * (4.0 * PI);
        for turn in [Vec2::ZERO, Vec2::new(0.3, 0.7), Vec2::splat(0.999)] {
            let off = sum(1024, turn) / whole - 1.0;
            assert!(off.abs().max_element() < 0.04, "{turn}: {off}");
        }
    }
}
