//! Truth for directional occlusion, the effect `do`: `1 / pi` times the integral over directions that nothing
//! blocks within a radius of the environment's radiance times the cosine to the shading normal (Ritschel,
//! Grosch and Seidel 2009; thesis 7.4). With a radiance of 1 from everywhere it is ambient occlusion.

use super::Shot;
use super::ao::morton;
use super::at_surface::{SurfaceEffect, Visible};
use crate::bvh::TracedScene;
use crate::bvh::bundle::BUNDLE;
use crate::intersection::SurfacePoint;
use crate::sampler::{PixelSampler, Stream, cosine_hemisphere, frame};
use crate::scene::Environment;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Path-traced directional occlusion; 0 without an environment.
#[derive(Clone, Copy, Debug)]
pub struct Directional<'a> {
    scene: &'a TracedScene,
    environment: Option<&'a Environment>,
    radius: f32,
}

/// What a direction adds if nothing blocks it.
#[derive(Clone, Copy, Debug)]
struct Arriving {
    direction: Vec3,
    light: Vec3,
}

impl<'a> Directional<'a> {
    /// Directional occlusion within the shot's radius.
    pub fn new(shot: &Shot<'a>) -> Self {
        let environment = shot.scene.scene().environment.as_deref();
        Self { scene: shot.scene, environment, radius: shot.radius }
    }

    /// One sample of half the directions by the cosine and half by the environment, with the density of both
    /// (Veach 1997, 9.2.4). `None` where no light comes from there.
    fn arriving(&self, point: &SurfacePoint, stream: &mut Stream) -> Option<Arriving> {
        let environment = self.environment?;
        let (choice, square) = (stream.next_1d(), stream.next_2d());
        let direction = if choice < 0.5 {
            environment.sample(square)?.direction
        } else {
            frame(point.normal) * cosine_hemisphere(square.x, square.y)
        };
        let cosine = direction.dot(point.normal);
        // A direction below the triangle is blocked by the triangle itself.
        if cosine <= 0.0 || direction.dot(point.geometric_normal) <= 0.0 {
            return None;
        }
        let density = 0.5 * (cosine * FRAC_1_PI + environment.density(direction));
        let light = environment.radiance(direction) * (cosine * FRAC_1_PI / density);
        (light != Vec3::ZERO).then_some(Arriving { direction, light })
    }
}

impl SurfaceEffect for Directional<'_> {
    fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3 {
        let point = &visible.point;
        let blocked =
            |arriving: &Arriving| self.scene.blocked(point.ray_origin(), arriving.direction, self.radius);
        self.arriving(point, stream).filter(|arriving| !blocked(arriving)).map_or(Vec3::ZERO, |a| a.light)
    }

    /// As bundles, neighbours together: in the order of a Morton curve over the hemisphere seen from above.
    fn mean(&self, visible: &Visible, sampler: PixelSampler, count: u32) -> Vec3 {
        let point = &visible.point;
        let to_local = frame(point.normal).transpose();
        let mut arriving: Vec<(u32, Arriving)> = (0..count)
            .filter_map(|i| self.arriving(point, &mut Stream::new(sampler, i)))
            .map(|arriving| {
                let [x, y] = [0, 1].map(|axis| 0.5 + 0.499 * (to_local * arriving.direction)[axis]);
                (morton(x) | morton(y) << 1, arriving)
            })
            .collect();
        arriving.sort_by_key(|(key, _)| *key);
        let mut sum = Vec3::ZERO;
        for bundle in arriving.chunks(BUNDLE) {
            let directions: Vec<Vec3> = bundle.iter().map(|(_, arriving)| arriving.direction).collect();
            let blocked = self.scene.blocked_bundle(point.ray_origin(), &directions, self.radius);
            let open = |i: &usize| blocked >> i & 1 == 0;
            sum += (0..bundle.len()).filter(open).map(|i| bundle[i].1.light).sum::<Vec3>();
        }
        sum / count as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::at_surface::AtSurface;
    use crate::path::proving::{MeanWithError, floor, integral, spotted, traced, wall, with_environment};
    use crate::path::{Ao, Integrator};
    use crate::scene::{Camera, Material};
    use glam::Vec2;

    /// At (x, 0, 0) of the floor, seen from nearby.
    fn at_floor(scene: &TracedScene, x: f32, radius: f32) -> MeanWithError {
        let camera = Camera::look_at(Vec3::new(x, 0.01, 0.0), Vec3::new(x, 0.0, 0.0));
        let shot = Shot::new(scene, &camera, [1, 1], radius);
        MeanWithError::of(&AtSurface::new(&shot, Directional::new(&shot)), &shot, 4096)
    }

    #[test]
    fn light_from_everywhere_is_the_closed_form_of_ambient_occlusion() {
        let scene = |radiance: f32| {
            let meshes = traced(vec![floor(), wall()], Material::default());
            with_environment(meshes, Environment::uniform(Vec3::splat(radiance)))
        };
        for d in [0.3f32, 1.0, 4.0] {
            let expected = Vec3::splat(1.0 - 0.5 * (1.0 - d / (d * d + 4.0).sqrt()));
            let value = at_floor(&scene(1.0), d, 1e4);
            value.proves("do/wall", expected);
            at_floor(&scene(1.02), d, 1e4).refutes("do/wall", expected);
            // Without the cosine: the share of the hemisphere's solid angle.
            value.refutes("do/wall", Vec3::splat(1.0 - (2.0 / d).atan() / std::f32::consts::PI));
        }
        // Beyond the radius the wall blocks nothing.
        assert!(at_floor(&scene(1.0), 1.0, 0.9).is(Vec3::ONE));
    }

    #[test]
    fn with_light_from_everywhere_a_room_has_its_ambient_occlusion() {
        let room = crate::scene::procedural::Family::Room.scene(1);
        let scene = TracedScene::new(room).expect("a room");
        let scene = with_environment(scene, Environment::uniform(Vec3::ONE));
        let camera = Camera::look_at(scene.bounds().centre(), scene.bounds().min);
        let shot = Shot::new(&scene, &camera, [7, 9], 0.3 * scene.diagonal());
        let directional = MeanWithError::of(&AtSurface::new(&shot, Directional::new(&shot)), &shot, 256);
        let ambient = MeanWithError::of(&AtSurface::new(&shot, Ao::new(&shot)), &shot, 256);
        assert!(directional.is(ambient.mean), "{directional:?} is not {ambient:?}");
        assert!(ambient.mean.x > 0.05 && ambient.mean.x < 0.95, "something is blocked: {ambient:?}");
    }

    #[test]
    fn a_map_of_one_bright_spot_is_found() {
        let environment = spotted();
        let scene = with_environment(traced(vec![floor()], Material::default()), environment.clone());
        let expected = integral(&environment, |direction| Vec3::splat(direction.y.max(0.0) * FRAC_1_PI));
        let value = at_floor(&scene, 0.3, 1e4);
        value.proves("do/spot", expected);
        value.refutes("do/spot", 1.02 * expected);
        let without_cosine =
            integral(&environment, |direction| Vec3::splat(f32::from(direction.y > 0.0) * 0.5 * FRAC_1_PI));
        value.refutes("do/spot", without_cosine);
    }

    #[test]
    fn bundles_come_to_what_single_rays_do() {
        let scene = with_environment(traced(vec![floor(), wall()], Material::default()), spotted());
        let camera = Camera::look_at(Vec3::new(2.0, 1.0, 0.5), Vec3::new(0.4, 0.1, 0.2));
        let shot = Shot::new(&scene, &camera, [9, 9], 3.0);
        let effect = Directional::new(&shot);
        let integrator = AtSurface::new(&shot, effect);
        for (x, y) in [(1, 2), (4, 4), (7, 8)] {
            let sampler = PixelSampler::new(x, y, 3);
            let together = integrator.pixel(&shot, x, y, sampler, 100);
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let single = |i| integrator.sample(at, &mut Stream::new(sampler, i));
            let apart = (0..100).map(single).sum::<Vec3>() / 100.0;
            assert!(
                (together - apart).length() < 1e-5 * apart.length().max(1.0),
                "{together} is not {apart}"
            );
        }
    }

    #[test]
    fn without_an_environment_it_is_dark() {
        assert_eq!(at_floor(&traced(vec![floor()], Material::default()), 0.3, 1e4).mean, Vec3::ZERO);
    }
}
