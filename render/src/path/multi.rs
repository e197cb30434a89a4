//! Truth for several effects at once: direct light times ambient occlusion, averaged over the points of a
//! thin lens, as the thesis' combined network learns it (7.4). Emission, and the environment where nothing is
//! seen, are not occluded.

use super::ao::is_open;
use super::appearance::{reflected, seen, sky};
use super::{Integrator, Shot};
use crate::sampler::Stream;
use glam::{Vec2, Vec3};

/// Direct light, occluded within the shot's radius, through a lens: radiance.
#[derive(Clone, Copy, Debug)]
pub struct Multi<'a> {
    shot: Shot<'a>,
}

impl<'a> Multi<'a> {
    /// Depth of field and ambient occlusion of a shot.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }
}

impl Integrator for Multi<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { scene, camera, height, width, radius, .. } = self.shot;
        let (origin, direction) = camera.ray(at, height, width, stream.next_2d());
        let Some(point) = seen(scene, origin, direction) else { return sky(scene.scene(), direction) };
        let open = f32::from(is_open(scene, &point, radius, stream));
        reflected(scene, &point, direction) * open + point.surface.emission
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::proving::{floor, quad};
    use crate::path::{Sampling, render};
    use crate::scene::{Camera, Lens, Light, Material, Scene};
    use deepshade_shaders::Effect;

    /// A floor and a wall in the light of a lamp.
    fn corner() -> TracedScene {
        let wall = [(-9., 0.), (-9., 2.), (9., 2.), (9., 0.)].map(|(z, y)| Vec3::new(0.0, y, z));
        let lamp = Light::Point {
            position: Vec3::new(3.0, 2.0, 1.0),
            intensity: Vec3::new(30.0, 20.0, 10.0),
            range: f32::INFINITY,
        };
        TracedScene::new(Scene {
            meshes: vec![floor(), quad(wall)].into(),
            materials: vec![Material::matte("grey", Vec3::splat(0.5))],
            lights: vec![lamp],
            ..Scene::default()
        })
        .expect("two squares")
    }

    #[test]
    fn without_a_lens_it_is_direct_light_times_ambient_occlusion() {
        let scene = corner();
        let camera = Camera::look_at(Vec3::new(2.5, 1.5, 1.0), Vec3::new(0.5, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [12, 16], 1.0);
        let of = |effect, samples| render(effect, &shot, Sampling::scrambled(samples, 7));
        let (multi, ao, light) = (of(Effect::Multi, 512), of(Effect::Ao, 4096).mean, of(Effect::Dof, 8).mean);
        let variance = multi.variance.expect("scramblings");
        let (mut outside, mut occluded) = (0, 0);
        for i in 0..12 * 16 {
            let (y, x) = (i / 16, i % 16);
            for c in 0..3 {
                let expected = light.at(c, y, x) * ao.at(0, y, x);
                let off = (multi.mean.at(c, y, x) - expected).abs();
                outside += usize::from(off > 4.0 * variance.at(c, y, x).sqrt() + 2e-3 * expected);
                occluded += usize::from(ao.at(0, y, x) < 0.9);
            }
        }
        // Beyond four standard errors of seven degrees of freedom are 0.5 % of all.
        assert!(outside < 12 && occluded > 100, "{outside} of {} outside, {occluded} occluded", 3 * 12 * 16);
    }

    #[test]
    fn without_occlusion_it_is_depth_of_field() {
        let scene = corner();
        let lens = Lens::new(0.1, 1.0).expect("a lens");
        let camera = Camera {
            lens: Some(lens),
            ..Camera::look_at(Vec3::new(2.5, 1.5, 1.0), Vec3::new(0.5, 0.3, 0.0))
        };
        let of = |effect, radius| {
            render(effect, &Shot::new(&scene, &camera, [12, 16], radius), Sampling::one(32, 7)).mean
        };
        assert_eq!(of(Effect::Multi, 1e-9), of(Effect::Dof, 1.0));
        assert_ne!(of(Effect::Multi, 1.0), of(Effect::Dof, 1.0));
    }
}
