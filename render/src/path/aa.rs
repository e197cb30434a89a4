//! Truth for anti-aliasing: the picture by direct light, averaged over each pixel with a box filter. 64
//! samples of one sequence are the thesis' 8 x 8 (7.3.1): one in every cell of that grid, at random in it,
//! since any 64 points of an Owen-scrambled Sobol sequence from a multiple of 64 on are a (0, 6, 2)-net (Owen
//! 1997).

use super::appearance::appearance;
use super::{Footprint, Integrator, Shot, mean_of_samples};
use crate::sampler::{PixelSampler, Stream};
use glam::{Vec2, Vec3};

/// Direct light all over a pixel, whatever the shot's footprint: radiance.
#[derive(Clone, Copy, Debug)]
pub struct AntiAliasing<'a> {
    shot: Shot<'a>,
}

impl<'a> AntiAliasing<'a> {
    /// Pixels of the shot's picture.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }
}

impl Integrator for AntiAliasing<'_> {
    fn sample(&self, at: Vec2, _stream: &mut Stream) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        appearance(scene, camera.position, camera.direction(at, height, width))
    }

    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        let everywhere = Shot { footprint: Footprint::Box, ..*shot };
        mean_of_samples(self, &everywhere, x, y, sampler, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::{Sampling, render};
    use crate::scene::{Camera, Material, Mesh, Scene};
    use deepshade_shaders::{Effect, Planes};

    const SIZE: usize = 16;

    /// Half of everything at depth 1: to the left of `x = slope * y`.
    fn half_plane(slope: f32) -> TracedScene {
        let mesh = Mesh {
            positions: [(-99., -9.), (-9. * slope, -9.), (9. * slope, 9.), (-99., 9.)]
                .map(|(x, y)| Vec3::new(x, y, -1.0))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let materials = vec![Material { emission: Vec3::ONE, ..Material::default() }];
        TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() })
            .expect("half a plane")
    }

    /// Area of the part of a pixel to the left of the line, with coordinates in pixels from the middle, y up.
    fn coverage(left: f32, bottom: f32, slope: f32) -> f32 {
        // Exact in x, and in y the trapezoids' sum between so many rows that its kinks do not matter.
        const ROWS: u32 = 4096;
        let width = |row: u32| {
            let y = bottom + (row as f32 + 0.5) / ROWS as f32;
            (slope * y - left).clamp(0.0, 1.0)
        };
        (0..ROWS).map(width).sum::<f32>() / ROWS as f32
    }

    #[test]
    fn a_slanted_edge_covers_its_share_of_every_pixel() {
        let camera = Camera { vertical_fov: 2.0 * 0.5f32.atan(), ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
        let slope = 0.37;
        let scene = half_plane(slope);
        let shot = Shot::new(&scene, &camera, [SIZE; 2], 1.0);
        let image = |samples| render(Effect::Aa, &shot, Sampling::one(samples, 3)).mean;
        let (coarse, fine) = (image(64), image(4096));
        let worst = |image: &Planes, shift: f32| {
            let error = |i: usize| {
                let (x, y) = (i % SIZE, i / SIZE);
                let expected = coverage(x as f32 - 8.0 + shift, 7.0 - y as f32, slope);
                (image.at(0, y, x) - expected).abs()
            };
            (0..SIZE * SIZE).map(error).fold(0.0, f32::max)
        };
        // A line crosses at most 15 of the 8 x 8 cells and parts each, so 64 samples are off by less than 7.5
        // / 64.
        assert!(worst(&coarse, 0.0) < 7.5 / 64.0, "{}", worst(&coarse, 0.0));
        assert!(worst(&fine, 0.0) < 0.01, "{}", worst(&fine, 0.0));
        assert!(worst(&fine, 0.05) > 0.03, "an edge off by a twentieth of a pixel is noticed");
        let jagged = render(Effect::MotionBlur, &shot, Sampling::one(64, 3)).mean;
        assert!(jagged.data().iter().all(|value| *value == 0.0 || *value == 1.0));
        assert!(coarse.data().iter().any(|value| *value > 0.0 && *value < 1.0));
    }

    #[test]
    fn each_of_8_by_8_cells_holds_one_of_64_samples() {
        for pixel in 0..50 {
            let sampler = PixelSampler::new(pixel, 7, 9).scrambled(pixel as u32 % 8);
            let mut cells = 0u64;
            for sample in 0..64 {
                let at = Stream::new(sampler, sample).next_2d() * 8.0;
                cells |= 1 << (at.y as u32 * 8 + at.x as u32);
            }
            assert_eq!(cells, u64::MAX, "pixel {pixel}");
        }
    }
}
