//! Truth for depth of field: the picture by direct light, averaged over the points of a thin lens (thesis
//! 7.4; Cook, Porter and Carpenter 1984). Without a lens, and with one of radius 0, it is that picture as it
//! is.

use super::appearance::appearance;
use super::{Integrator, Shot};
use crate::sampler::Stream;
use glam::{Vec2, Vec3};

/// Direct light through a lens: radiance.
#[derive(Clone, Copy, Debug)]
pub struct DepthOfField<'a> {
    shot: Shot<'a>,
}

impl<'a> DepthOfField<'a> {
    /// Depth of field of the shot's camera.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }
}

impl Integrator for DepthOfField<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let (origin, direction) = camera.ray(at, height, width, stream.next_2d());
        appearance(scene, origin, direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::proving::{quad, traced};
    use crate::path::{Estimate, Footprint, Sampling, render};
    use crate::scene::{Camera, Lens, Material};
    use deepshade_shaders::Effect;

    const SIZE: usize = 32;

    /// A camera at the origin that looks down -z, whose pixels at depth 1 are 1/32 m apart.
    fn camera(lens: Option<Lens>) -> Camera {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
        Camera { vertical_fov: 2.0 * 0.5f32.atan(), lens, ..camera }
    }

    /// A square at a depth that shines evenly and is so many pixels wide.
    fn lamp(depth: f32, pixels: f32) -> TracedScene {
        let half = 0.5 * pixels * depth / SIZE as f32;
        let corner = |(x, y): (f32, f32)| Vec3::new(x * half, y * half, -depth);
        let mesh = quad([(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(corner));
        let material = Material { emission: Vec3::new(3.0, 2.0, 1.0), ..Material::default() };
        traced(vec![mesh], material)
    }

    /// Sum of the red pixels whose middles are within a radius of the image's, and its standard error.
    fn energy(estimate: &Estimate, radius: f32) -> [f32; 2] {
        let variance = estimate.variance.as_ref().expect("scramblings");
        let mut sums = [0.0; 2];
        for y in 0..SIZE {
            for x in 0..SIZE {
                let from_middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - 0.5 * SIZE as f32;
                if from_middle.length() < radius {
                    sums[0] += estimate.mean.at(0, y, x);
                    sums[1] += variance.at(0, y, x);
                }
            }
        }
        [sums[0], sums[1].sqrt()]
    }

    #[test]
    fn a_point_becomes_an_even_disc_with_all_of_its_energy() {
        for (depth, focus) in [(4.0, 1.0), (1.0, 4.0)] {
            // B |Dfocal| / d = 10 pixels.
            let lens = Lens::new(10.0 / 32.0 * focus * depth / 3.0, focus).expect("a lens");
            let (scene, camera) = (lamp(depth, 2.0), camera(Some(lens)));
            assert!((camera.circle_of_confusion(depth, SIZE) - 10.0).abs() < 1e-3);
            let shot = Shot { footprint: Footprint::Box, ..Shot::new(&scene, &camera, [SIZE; 2], 1.0) };
            let image = render(Effect::Dof, &shot, Sampling::scrambled(512, 5));
            // Four square pixels of radiance 3, all within the disc and the lamp's own width.
            let [all, error] = energy(&image, 99.0);
            assert!((all - 12.0).abs() < 3.0 * error && error < 0.3, "{all} +- {error} is not 12");
            let [inside, _] = energy(&image, 12.2);
            assert!((inside - all).abs() < 1e-4, "{inside} of {all}");
            // Pixels within 6 are as bright as the mean of the disc. A polar map without its square root
            // would put 60 % of the energy there, not 36 %.
            let middles = (0..SIZE * SIZE)
                .map(|i| Vec2::new((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5) - 16.0)
                .filter(|from_middle| from_middle.length() < 6.0)
                .count();
            let expected = 12.0 * middles as f32 / (std::f32::consts::PI * 100.0);
            let [core, error] = energy(&image, 6.0);
            assert!(
                (core - expected).abs() < 3.0 * error && error < 0.1 * expected,
                "{core} +- {error}, {expected}"
            );
        }
    }

    #[test]
    fn what_is_in_focus_stays_sharp_and_without_a_lens_everything_does() {
        let scene = lamp(2.0, 8.0);
        let image = |lens: Option<Lens>| {
            let camera = camera(lens);
            render(Effect::Dof, &Shot::new(&scene, &camera, [SIZE; 2], 1.0), Sampling::one(16, 1)).mean
        };
        let sharp = image(None);
        assert_eq!(sharp.data().iter().filter(|value| **value > 0.0).count(), 3 * 8 * 8);
        assert!(sharp == image(Some(Lens { radius: 0.0, focus: 1.0 })));
        assert!(sharp == image(Some(Lens { radius: 0.2, focus: 2.0 })));
        assert!(sharp != image(Some(Lens { radius: 0.2, focus: 1.5 })), "another focus is noticed");
    }
}
