//! What tests of truth share: small scenes, and means with their standard errors to hold against closed
//! forms. What is proved goes through [`Comparison::record_and_assert`], by the name of its proof.

mod comparison;
mod slope;

pub use comparison::Comparison;
pub use slope::{least_squares, prove_slope};

use super::{Integrator, Shot};
use crate::bvh::TracedScene;
use crate::sampler::{PixelSampler, Stream};
use crate::scene::{Environment, Material, Mesh, Scene};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Independent sequences that means are of.
const SCRAMBLINGS: u32 = 16;
/// Beyond rounding: a value without variance is what f32 makes of it.
const ROUNDING: f32 = 2e-5;

/// A mean of independent scramblings.
#[derive(Clone, Copy, Debug)]
pub struct MeanWithError {
    pub mean: Vec3,
    /// Its standard error.
    pub error: Vec3,
}

impl MeanWithError {
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

    /// Mean of samples of sequences of their own.
    pub fn of_independent(sample: impl Fn(&mut Stream) -> Vec3, samples: u32) -> Self {
        let value = |i: u32| sample(&mut Stream::new(PixelSampler::new(i as usize, 0, 1), 0)).as_dvec3();
        let values: Vec<DVec3> = (0..samples).map(value).collect();
        let count = f64::from(samples);
        let mean = values.iter().sum::<DVec3>() / count;
        let squares: DVec3 = values.iter().map(|value| (*value - mean) * (*value - mean)).sum();
        let error = (squares / (count * (count - 1.0))).map(f64::sqrt);
        Self { mean: mean.as_vec3(), error: error.as_vec3() }
    }

    fn of_means(mean: impl Fn(u32) -> Vec3) -> Self {
        let means: Vec<Vec3> = (0..SCRAMBLINGS).map(mean).collect();
        let mean = means.iter().sum::<Vec3>() / SCRAMBLINGS as f32;
        let squares: Vec3 = means.iter().map(|value| (value - mean) * (value - mean)).sum();
        Self { mean, error: (squares / (SCRAMBLINGS * (SCRAMBLINGS - 1)) as f32).map(f32::sqrt) }
    }

    /// Whether a value is within three standard errors, in every colour.
    pub fn is(&self, value: Vec3) -> bool {
        (self.mean - value).abs().cmple(3.0 * self.error_beside(value)).all()
    }

    /// Asserts that it is a closed form's value.
    pub fn proves(&self, name: &str, expected: Vec3) {
        self.compared(name, expected, false).record_and_assert();
    }

    /// Asserts that it is not the value that a mistake would give: the control of a proof.
    pub fn refutes(&self, name: &str, mistaken: Vec3) {
        self.compared(name, mistaken, true).record_and_assert();
    }

    /// The standard error, with a third of what rounding may add.
    fn error_beside(&self, value: Vec3) -> Vec3 {
        self.error + Vec3::splat(ROUNDING / 3.0) * value.max(Vec3::splat(1e-3))
    }

    /// The colour that is farthest off stands for all.
    fn compared<'a>(&self, name: &'a str, expected: Vec3, control: bool) -> Comparison<'a> {
        let error = self.error_beside(expected);
        let worst = ((self.mean - expected).abs() / error).max_position();
        Comparison {
            name,
            value: self.mean[worst].into(),
            expected: expected[worst].into(),
            standard_error: Some(error[worst].into()),
            within: self.is(expected),
            control,
        }
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

/// Height of [`wall`], metres.
pub const WALL_HEIGHT: f32 = 2.0;

/// A wall at x = 0, as good as infinitely long.
pub fn wall() -> Mesh {
    let corners = [(-900., 0.), (900., 0.), (900., WALL_HEIGHT), (-900., WALL_HEIGHT)];
    quad(corners.map(|(z, y)| Vec3::new(0.0, y, z)))
}

/// A sphere of triangles whose mean silhouette is a sphere's of that radius.
pub fn sphere(centre: Vec3, radius: f32) -> Mesh {
    let (rings, segments) = (96u32, 192u32);
    let point = |i: u32| {
        let (sin, cos) = (PI * (i / segments) as f32 / rings as f32).sin_cos();
        let around = Vec2::from_angle(TAU * (i % segments) as f32 / segments as f32);
        Vec3::new(around.x * sin, cos, around.y * sin)
    };
    let strip = |i: u32| {
        let next = |i: u32| i / segments * segments + (i + 1) % segments;
        [[i, next(i), i + segments], [next(i), next(i) + segments, i + segments]]
    };
    let mut mesh = Mesh {
        positions: (0..(rings + 1) * segments).map(point).collect(),
        triangles: (0..rings * segments).flat_map(strip).collect(),
        ..Mesh::default()
    };
    mesh.drop_degenerate_triangles();
    // A convex body's mean silhouette is a quarter of its surface.
    let area = |triangle| {
        let [a, b, c] = mesh.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    };
    let scale = radius * (4.0 * PI / (0..mesh.triangles.len()).map(area).sum::<f32>()).sqrt();
    for position in &mut mesh.positions {
        *position = centre + *position * scale;
    }
    mesh
}

/// Meshes of one material.
pub fn traced(meshes: Vec<Mesh>, material: Material) -> TracedScene {
    TracedScene::new(Scene { meshes: meshes.into(), materials: vec![material], ..Scene::default() })
        .expect("triangles")
}

/// A floor under a roof with an edge, white.
pub fn porch() -> TracedScene {
    let roof = quad([(-9., -9.), (-9., 9.), (0., 9.), (0., -9.)].map(|(x, z)| Vec3::new(x, 1.0, z)));
    traced(vec![floor(), roof], Material::default())
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

/// Coloured light from everywhere, all texels different.
pub fn coloured() -> Environment {
    let texel = |i: usize| Vec3::from_array([5, 7, 11].map(|k| 1.0 + ((i * k) as f32).sin()));
    Environment::new("coloured".as_ref(), 16, 8, (0..16 * 8).map(texel).collect()).expect("radiance")
}

/// Integral over the sphere of an environment's radiance times a kernel, by the rule of midpoints.
pub fn integral(environment: &Environment, kernel: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let (rows, columns) = (512, 1024);
    let (down, around) = (PI / rows as f32, TAU / columns as f32);
    let mut sum = DVec3::ZERO;
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
