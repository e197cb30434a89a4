//! Truth for ambient occlusion: the cosine-weighted share of directions of the hemisphere around the shading
//! normal that nothing blocks within a radius (thesis 7.4).

use super::Shot;
use super::at_surface::{SurfaceEffect, Visible};
use crate::bvh::TracedScene;
use crate::bvh::bundle::BUNDLE;
use crate::intersection::SurfacePoint;
use crate::sampler::{PixelSampler, Stream, cosine_hemisphere, frame};
use glam::Vec3;

/// Path-traced ambient occlusion: 1 where nothing is seen.
#[derive(Clone, Copy, Debug)]
pub struct Ao<'a> {
    scene: &'a TracedScene,
    radius: f32,
}

impl<'a> Ao<'a> {
    /// Ambient occlusion within the shot's radius.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { scene: shot.scene, radius: shot.radius }
    }
}

impl SurfaceEffect for Ao<'_> {
    const BACKGROUND: Vec3 = Vec3::ONE;

    fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3 {
        Vec3::splat(f32::from(is_open(self.scene, &visible.point, self.radius, stream)))
    }

    /// As bundles: all rays start at one point.
    fn mean(&self, visible: &Visible, sampler: PixelSampler, count: u32) -> Vec3 {
        let point = &visible.point;
        // A direction below the triangle is blocked by the triangle itself.
        let mut directions = hemisphere(&sampler, count, point.normal);
        directions.retain(|direction| direction.dot(point.geometric_normal) > 0.0);
        let blocked =
            |bundle: &[Vec3]| self.scene.blocked_bundle(point.ray_origin(), bundle, self.radius).count_ones();
        let open = directions.len() as u32 - directions.chunks(BUNDLE).map(blocked).sum::<u32>();
        Vec3::splat(open as f32 / count as f32)
    }
}

/// Whether a cosine-distributed direction around a point's normal is open: one sample of ambient occlusion.
pub(super) fn is_open(scene: &TracedScene, point: &SurfacePoint, radius: f32, stream: &mut Stream) -> bool {
    let [u, v] = stream.next_2d().to_array();
    let direction = frame(point.normal) * cosine_hemisphere(u, v);
    direction.dot(point.geometric_normal) > 0.0 && !scene.blocked(point.ray_origin(), direction, radius)
}

/// Cosine-distributed directions around a normal, neighbours one after the other: in the order of a Morton
/// curve over the square that they come from.
pub fn hemisphere(sampler: &PixelSampler, samples: u32, normal: Vec3) -> Vec<Vec3> {
    let mut square: Vec<(u32, f32, f32)> = (0..samples)
        .map(|sample| {
            let [u, v, ..] = sampler.sample_4d(sample, 0);
            (morton(u) | morton(v) << 1, u, v)
        })
        .collect();
    square.sort_unstable_by_key(|(key, ..)| *key);
    let to_world = frame(normal);
    square.into_iter().map(|(_, u, v)| to_world * cosine_hemisphere(u, v)).collect()
}

/// The upper eight bits of a number in [0, 1), a zero bit before each.
pub(super) fn morton(number: f32) -> u32 {
    let spread = |bits: u32, shift: u32, mask: u32| (bits | bits << shift) & mask;
    spread(spread(spread((number * 256.0) as u32, 4, 0x0f0f), 2, 0x3333), 1, 0x5555)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::proving::{MeanWithError, WALL_HEIGHT, floor, prove_slope, quad, sphere, traced, wall};
    use crate::path::{AtSurface, Integrator, Sampling, render};
    use crate::scene::{Camera, Material, Mesh};
    use deepshade_shaders::Effect;
    use std::f32::consts::{PI, TAU};

    const SAMPLES: u32 = 4096;

    /// The floor, and things on it.
    fn on_floor(mut meshes: Vec<Mesh>) -> TracedScene {
        meshes.push(floor());
        traced(meshes, Material::default())
    }

    /// Openness of the floor at (x, 0, 0), seen from nearby.
    fn at_floor(scene: &TracedScene, x: f32, radius: f32) -> MeanWithError {
        let camera = Camera::look_at(Vec3::new(x, 0.01, 0.0), Vec3::new(x, 0.0, 0.0));
        let shot = Shot::new(scene, &camera, [1, 1], radius);
        MeanWithError::of(&AtSurface::new(&shot, Ao::new(&shot)), &shot, SAMPLES)
    }

    /// As wide as the floor, at a height.
    fn ceiling(height: f32) -> Mesh {
        quad([(-9., 9.), (9., 9.), (9., -9.), (-9., -9.)].map(|(x, z)| Vec3::new(x, height, z)))
    }

    /// Derived exactly for an infinitely long wall at distance d: it blocks (1 - d / sqrt(d^2 + H^2)) / 2.
    fn beside_wall(d: f32) -> f32 {
        1.0 - 0.5 * (1.0 - d / d.hypot(WALL_HEIGHT))
    }

    #[test]
    fn nothing_blocks_a_plane() {
        at_floor(&on_floor(vec![]), 0.5, 100.0).proves("ao/plane", Vec3::ONE);
        at_floor(&on_floor(vec![ceiling(8.0)]), 0.5, 100.0).refutes("ao/plane", Vec3::ONE);
    }

    #[test]
    fn a_long_wall_blocks_its_closed_form() {
        let scene = on_floor(vec![wall()]);
        for d in [0.3f32, 1.0, 4.0] {
            let value = at_floor(&scene, d, 1e4);
            value.proves("ao/wall", Vec3::splat(beside_wall(d)));
            // Without the cosine: the share of the hemisphere's solid angle.
            value.refutes("ao/wall", Vec3::splat(1.0 - (WALL_HEIGHT / d).atan() / PI));
            value.refutes("ao/wall", Vec3::splat(1.02 * beside_wall(d)));
        }
    }

    #[test]
    fn a_disk_blocks_its_form_factor_and_not_its_solid_angle() {
        let (radius, height) = (1.0f32, 0.8f32);
        let segments = 256;
        let rim = |i: u32| {
            let (sin, cos) = (TAU * i as f32 / segments as f32).sin_cos();
            Vec3::new(radius * cos, height, radius * sin)
        };
        let disk = Mesh {
            positions: std::iter::once(Vec3::Y * height).chain((0..segments).map(rim)).collect(),
            triangles: (0..segments).map(|i| [0, 1 + i, 1 + (i + 1) % segments]).collect(),
            ..Mesh::default()
        };
        let value = at_floor(&on_floor(vec![disk]), 0.0, 1e4);
        // Coaxial disk: r^2 / (r^2 + h^2) with the cosine, 1 - h / sqrt(r^2 + h^2) without.
        value.proves("ao/disk", Vec3::splat(1.0 - radius * radius / (radius * radius + height * height)));
        value.refutes("ao/disk", Vec3::splat(height / radius.hypot(height)));
    }

    #[test]
    fn a_sphere_blocks_the_projection_of_its_cone() {
        let (radius, height) = (0.8f32, 1.5f32);
        let scene = on_floor(vec![sphere(Vec3::Y * height, radius)]);
        // (r / d)^2 times the cosine to its middle while it is above the horizon: straight above, and aside.
        for x in [0.0f32, 1.1] {
            let distance = x.hypot(height);
            let (sine, cosine) = (radius / distance, height / distance);
            let value = at_floor(&scene, x, 1e4);
            value.proves("ao/sphere", Vec3::splat(1.0 - sine * sine * cosine));
            // Without the cosine: the share of the hemisphere's solid angle.
            value.refutes("ao/sphere", Vec3::splat((1.0 - sine * sine).sqrt()));
        }
    }

    #[test]
    fn a_blocker_beyond_the_radius_does_not_count() {
        let scene = on_floor(vec![ceiling(1.0)]);
        at_floor(&scene, 0.0, 0.99).proves("ao/radius", Vec3::ONE);
        // Within R, the plane at height h blocks the cone of half angle acos(h / R): sin^2 = 1 - h^2 / R^2.
        let value = at_floor(&scene, 0.0, 2.0);
        value.proves("ao/radius", Vec3::splat(0.25));
        value.refutes("ao/radius", Vec3::splat(0.5));
    }

    #[test]
    fn inside_a_closed_box_everything_is_blocked() {
        let corner =
            |i: usize| Vec3::new(f32::from(i & 1 == 1), f32::from(i & 2 == 2), f32::from(i & 4 == 4));
        // The last one is the top.
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [0, 2, 6, 4], [1, 3, 7, 5], [2, 3, 7, 6]];
        let boxed = faces.map(|face| quad(face.map(|i: usize| corner(i) * 4.0 - Vec3::new(2.0, 0.0, 2.0))));
        let open_above = |faces: usize| traced(boxed[..faces].to_vec(), Material::default());
        at_floor(&open_above(6), 0.3, 1e4).proves("ao/box", Vec3::ZERO);
        at_floor(&open_above(5), 0.3, 1e4).refutes("ao/box", Vec3::ZERO);
    }

    #[test]
    fn errors_fall_at_least_as_fast_as_the_root_of_the_samples() {
        let scene = on_floor(vec![wall()]);
        let camera = Camera::look_at(Vec3::new(1.0, 0.01, 0.0), Vec3::X);
        let shot = Shot::new(&scene, &camera, [1, 1], 1e4);
        let ao = AtSurface::new(&shot, Ao::new(&shot));
        prove_slope("slope/ao", beside_wall(1.0).into(), |replicate, samples| {
            ao.pixel(&shot, 0, 0, PixelSampler::new(0, 0, 7).scrambled(replicate), samples).x
        });
    }

    #[test]
    fn images_do_not_depend_on_the_number_of_threads() {
        let scene = on_floor(vec![wall()]);
        let camera = Camera::look_at(Vec3::new(2.0, 1.0, 0.5), Vec3::ZERO);
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let shot = Shot::new(&scene, &camera, [37, 51], 1.0);
            pool.install(|| render(Effect::Ao, &shot, Sampling::one(8, 3)))
        };
        assert_eq!(image(1), image(3));
    }
}
