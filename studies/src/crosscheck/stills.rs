//! Motion blur as the mean of still frames: what Mitsuba has no integrator for.

use super::scenes::CrosscheckScene;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::path::{Estimate, Footprint, Sampling, Shot, render};
use deepshade_render::scene::Scene;
use deepshade_shaders::{Effect, Planes};

/// Moments of a replicate: the exposure is cut into so many parts, and one moment is drawn in each.
const MOMENTS: u32 = 8;

/// The mean over still frames of direct light, in which nothing moves, and the variance of that mean from
/// independent scramblings.
///
/// # Errors
/// If a moment's scene cannot be traced.
pub fn render_stills(setting: &CrosscheckScene, size: [usize; 2], sampling: Sampling) -> Result<Estimate> {
    let Sampling { samples, scramblings: replicates, seed: first } = sampling;
    let each = samples.div_ceil(replicates * MOMENTS).max(1);
    let mut means: Vec<Planes> = Vec::new();
    for replicate in 0..replicates {
        let mut sum = Planes::filled(Effect::MotionBlur.channels(), size[0], size[1], 0.0);
        for moment in 0..MOMENTS {
            let seed = first + replicate * MOMENTS + moment;
            let time = (moment as f32 + fraction(seed)) / MOMENTS as f32 - 0.5;
            let scene = TracedScene::new(still(&setting.scene, time))?;
            let shot = Shot {
                footprint: Footprint::Box,
                ..Shot::new(&scene, &setting.camera, size, setting.radius)
            };
            let image = render(Effect::MotionBlur, &shot, Sampling::one(each, seed)).mean;
            for (sum, value) in sum.data_mut().iter_mut().zip(image.data()) {
                *sum += value / MOMENTS as f32;
            }
        }
        means.push(sum);
    }
    Ok(Estimate::of(&means, each * MOMENTS * replicates))
}

/// A number in [0, 1) for each seed.
fn fraction(seed: u32) -> f32 {
    deepshade_render::sampler::hash(seed) as f32 / 2f32.powi(32)
}

/// The scene at a moment of the exposure, from -0.5 to 0.5, with nothing in motion.
fn still(scene: &Scene, time: f32) -> Scene {
    let mut scene = scene.clone();
    for mesh in &mut scene.meshes {
        for (position, displacement) in mesh.positions.iter_mut().zip(&mesh.displacements) {
            *position += *displacement * time;
        }
        mesh.displacements.clear();
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::Mesh;
    use glam::Vec3;

    #[test]
    fn a_still_is_where_the_motion_is_at_that_moment() {
        let mesh = Mesh { positions: vec![Vec3::Y], displacements: vec![Vec3::X * 2.0], ..Mesh::default() };
        let scene = Scene { meshes: vec![mesh].into(), ..Scene::default() };
        for (time, x) in [(-0.5, -1.0), (0.0, 0.0), (0.25, 0.5)] {
            let still = still(&scene, time);
            assert_eq!(still.meshes[0].positions[0], Vec3::new(x, 1.0, 0.0));
            assert!(still.meshes[0].displacements.is_empty());
        }
    }
}
