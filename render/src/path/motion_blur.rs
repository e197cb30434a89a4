//! Truth for motion blur: the picture by direct light, averaged over the time for which the shutter is open,
//! all of which counts alike (thesis 7.4). Objects move in straight lines and take their shadows with them;
//! camera and lights stand still. The picture is a pinhole's.

use super::appearance::appearance;
use super::{Integrator, Shot};
use crate::sampler::Stream;
use glam::{Vec2, Vec3};

/// Direct light while objects move: radiance.
#[derive(Clone, Copy, Debug)]
pub struct MotionBlur<'a> {
    shot: Shot<'a>,
}

impl<'a> MotionBlur<'a> {
    /// Motion blur of the shot's scene.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }
}

impl Integrator for MotionBlur<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let moment = scene.at(stream.next_1d() - 0.5);
        appearance(moment, camera.position, camera.direction(at, height, width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::appearance::appearance;
    use crate::path::{Sampling, proving, render};
    use crate::scene::{Camera, Light, Material, MaterialId, Mesh, Scene};
    use deepshade_shaders::Effect;

    fn quad(material: u32, corners: [Vec3; 4]) -> Mesh {
        Mesh { material: MaterialId(material), ..proving::quad(corners) }
    }

    #[test]
    fn a_moving_step_edge_is_a_linear_ramp() {
        const WIDTH: usize = 48;
        // Pixels at depth 1 are 1/48 m apart; the sheet covers the left of the image up to its middle, and
        // moves by 20 pixels during the exposure.
        let camera = Camera { vertical_fov: 2.0 * 0.5f32.atan(), ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
        let sheet = [(-9., -9.), (0., -9.), (0., 9.), (-9., 9.)].map(|(x, y)| Vec3::new(x, y, -1.0));
        let mesh = Mesh { displacements: vec![Vec3::X * 20.0 / 48.0; 4], ..quad(0, sheet) };
        let materials = vec![Material { emission: Vec3::ONE, ..Material::default() }];
        let scene = TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() })
            .expect("a sheet");
        let shot = Shot::new(&scene, &camera, [WIDTH; 2], 1.0);
        let image = render(Effect::MotionBlur, &shot, Sampling::one(64, 2)).mean;
        let mut worst: f32 = 0.0;
        for x in 0..WIDTH {
            let from_edge = x as f32 + 0.5 - 24.0;
            let ramp = (0.5 - from_edge / 20.0).clamp(0.0, 1.0);
            // One of 64 equal parts of the exposure holds one sample.
            let value = image.at(0, 20, x);
            assert!((value - ramp).abs() <= 1.0 / 64.0 + 1e-5, "at {x}: {value} is not {ramp}");
            worst = worst.max((value - (0.5 - from_edge / 19.0).clamp(0.0, 1.0)).abs());
        }
        assert!(worst > 1.0 / 64.0 + 1e-5, "an exposure shorter by a twentieth is noticed");
    }

    /// A board that falls and turns over a floor, in the light of a lamp.
    fn falling_board() -> Scene {
        let floor = [(-5., 5.), (5., 5.), (5., -5.), (-5., -5.)].map(|(x, z)| Vec3::new(x, 0.0, z));
        let board = [(-1., 0.5), (1., 0.5), (1., -0.5), (-1., -0.5)].map(|(x, z)| Vec3::new(x, 1.0, z));
        let displacements = board.iter().map(|p| Vec3::new(0.4, -0.5 * p.x - 0.2, 0.0)).collect();
        let lamp = Light::Point {
            position: Vec3::new(1.0, 4.0, 1.0),
            intensity: Vec3::splat(30.0),
            range: f32::INFINITY,
        };
        Scene {
            meshes: vec![quad(0, floor), Mesh { displacements, ..quad(1, board) }].into(),
            materials: vec![
                Material::matte("grey", Vec3::splat(0.6)),
                Material { roughness: 0.4, ..Material::matte("red", Vec3::X) },
            ],
            lights: vec![lamp],
            ..Scene::default()
        }
    }

    /// The scene as it is at a moment, with nothing that moves.
    fn frame(scene: &Scene, time: f32) -> TracedScene {
        let mut scene = scene.clone();
        for mesh in &mut scene.meshes {
            for (position, displacement) in mesh.positions.iter_mut().zip(&mesh.displacements) {
                *position += *displacement * time;
            }
            mesh.displacements.clear();
        }
        TracedScene::new(scene).expect("triangles")
    }

    #[test]
    fn motion_blur_is_the_mean_of_still_frames() {
        const FRAMES: usize = 128;
        let scene = falling_board();
        let camera = Camera::look_at(Vec3::new(0.5, 3.0, 4.0), Vec3::new(0.0, 0.4, 0.0));
        let (height, width) = (24, 32);
        let frames: Vec<TracedScene> =
            (0..FRAMES).map(|i| frame(&scene, (i as f32 + 0.5) / FRAMES as f32 - 0.5)).collect();
        let moving = TracedScene::new(scene).expect("triangles");
        let shot = Shot::new(&moving, &camera, [height, width], 1.0);
        let blurred = render(Effect::MotionBlur, &shot, Sampling::one(256, 4)).mean;
        let sharp = render(Effect::Dof, &shot, Sampling::one(1, 4)).mean;
        let (mut error, mut blur) = (0.0f32, 0.0f32);
        for y in 0..height {
            for x in 0..width {
                let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
                let at = |frame: &TracedScene| appearance(frame, camera.position, direction);
                let mean = frames.iter().map(at).sum::<Vec3>() / FRAMES as f32;
                let found = Vec3::from_array(std::array::from_fn(|c| blurred.at(c, y, x)));
                let off = (found - mean).abs().max_element();
                // A pixel sees at most the board, its edge and its shadow's come and go.
                assert!(
                    off < 4.0 / FRAMES as f32 * mean.max_element().max(1.0),
                    "({x}, {y}): {found} is not {mean}"
                );
                error += off;
                blur += (sharp.at(0, y, x) - mean.x).abs();
            }
        }
        assert!(error < 0.05 * blur, "{error} against a blur of {blur}");
    }

    #[test]
    fn a_still_scene_stays_sharp() {
        let still = frame(&falling_board(), 0.0);
        let camera = Camera::look_at(Vec3::new(0.5, 3.0, 4.0), Vec3::new(0.0, 0.4, 0.0));
        let shot = Shot::new(&still, &camera, [24, 32], 1.0);
        let of = |effect| render(effect, &shot, Sampling::one(1, 4)).mean;
        assert_eq!(of(Effect::MotionBlur), of(Effect::Dof));
    }
}
