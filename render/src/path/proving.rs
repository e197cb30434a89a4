//! What tests of truth share: small scenes, and means with their standard errors to hold against closed forms.

use super::sampler::{PixelSampler, Stream};
use super::{Integrator, Shot};
use crate::bvh::TracedScene;
use crate::scene::{Environment, Material, Mesh, Scene};
use glam::Vec3;
use std::sync::Arc;

/// Independent sequences that means are of.
const SCRAMBLINGS: u32 = 16;
/// Beyond rounding: a value without variance is what f32 makes of it.
const ROUNDING: f32 = 2e-5;

/// A mean of independent scramblings.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    pub mean: Vec3,
    /// Its standard error.
    pub error: Vec3,
}

impl Measured {
    /// Mean over all pixels of a shot.
    pub fn of(integrator: &dyn Integrator, shot: &Shot<'_>, samples: u32) -> Self {
        let (height, width) = (shot.height, shot.width);
        Self::of_means(|scrambling| {
            let pixel = |i: usize| {
                let (x, y) = (i % width, i / width);
                let sampler = PixelSampler::new(x, y, 5).scrambled(scrambling);
                integrator.pixel(shot, x, y, sampler, samples)
            };
            (0..width * height).map(pixel).sum::<Vec3>() / (width * height) as f32
        })
    }

    /// Mean of samples.
    pub fn of_samples(sample: impl Fn(&mut Stream) -> Vec3, samples: u32) -> Self {
        Self::of_means(|scrambling| {
            let sampler = PixelSampler::new(0, 0, 5).scrambled(scrambling);
            (0..samples).map(|i| sample(&mut Stream::new(sampler, i))).sum::<Vec3>() / samples as f32
        })
    }

    fn of_means(mean: impl Fn(u32) -> Vec3) -> Self {
        let means: Vec<Vec3> = (0..SCRAMBLINGS).map(mean).collect();
        let mean = means.iter().sum::<Vec3>() / SCRAMBLINGS as f32;
        let squares: Vec3 = means.iter().map(|value| (value - mean) * (value - mean)).sum();
        Self { mean, error: (squares / (SCRAMBLINGS * (SCRAMBLINGS - 1)) as f32).map(f32::sqrt) }
    }

    /// Whether a value is within three standard errors, in every colour.
    pub fn is(&self, value: Vec3) -> bool {
        let rounding = Vec3::splat(ROUNDING) * value.max(Vec3::splat(1e-3));
        (self.mean - value).abs().cmple(3.0 * self.error + rounding).all()
    }
}

/// A quadrilateral.
pub fn quad(corners: [Vec3; 4]) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// A square at y = 0 around the origin, 18 m wide.
pub fn floor() -> Mesh {
    quad([(-9., 9.), (9., 9.), (9., -9.), (-9., -9.)].map(|(x, z)| Vec3::new(x, 0.0, z)))
}

/// Meshes of one material.
pub fn traced(meshes: Vec<Mesh>, material: Material) -> TracedScene {
    TracedScene::new(Scene { meshes, materials: vec![material], ..Scene::default() }).expect("triangles")
}

/// The same scene under an environment.
pub fn with_environment(scene: TracedScene, environment: Environment) -> TracedScene {
    let scene = Scene { environment: Some(Arc::new(environment)), ..scene.scene().clone() };
    TracedScene::new(scene).expect("triangles")
}

/// A dim, coloured environment with one texel three thousand times as bright, 30 degrees above the horizon.
pub fn spotted() -> Environment {
    let (width, height) = (64, 32);
    let texel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let spot = if (x, y) == (9, 10) { 300.0 } else { 0.1 };
        Vec3::new(1.0, 0.5 + 0.5 * (x as f32 / width as f32), 0.2 + y as f32 / height as f32) * spot
    };
    Environment::new("spotted".as_ref(), width, height, (0..width * height).map(texel).collect())
        .expect("radiance")
}

/// Integral over the sphere of an environment's radiance times a kernel, by the rule of midpoints.
pub fn integral(environment: &Environment, kernel: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let (rows, columns) = (512, 1024);
    let (down, around) = (std::f32::consts::PI / rows as f32, std::f32::consts::TAU / columns as f32);
    let mut sum = glam::DVec3::ZERO;
    for row in 0..rows {
        let (sin, cos) = ((row as f32 + 0.5) * down).sin_cos();
        for column in 0..columns {
            let (y, x) = ((column as f32 + 0.5) * around).sin_cos();
            let direction = Vec3::new(sin * x, cos, sin * y);
            sum += (environment.radiance(direction) * kernel(direction) * sin).as_dvec3();
        }
    }
    (sum * f64::from(down * around)).as_vec3()
}
