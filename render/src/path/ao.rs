//! Truth for ambient occlusion: the cosine-weighted share of directions of the hemisphere around the shading normal
//! that nothing blocks within a radius (thesis 7.4).

use super::sampler::{MAX_SAMPLES, PixelSampler, Stream, cosine_hemisphere, frame};
use super::{Footprint, Integrator, Shot};
use crate::bvh::TracedScene;
use crate::bvh::bundle::BUNDLE;
use crate::intersection::SurfacePoint;
use glam::{Vec2, Vec3};

/// Path-traced ambient occlusion: 1 where nothing is seen.
#[derive(Clone, Copy, Debug)]
pub struct Ao<'a> {
    shot: Shot<'a>,
}

impl<'a> Ao<'a> {
    /// Ambient occlusion within the shot's radius.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }

    /// The surface at a point of the image.
    fn surface(&self, at: Vec2) -> Option<SurfacePoint> {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let direction = camera.direction(at, height, width);
        let hit = scene.hit(camera.position, direction, f32::INFINITY)?;
        Some(SurfacePoint::new(scene, &hit, direction))
    }

    /// The open share of the hemisphere over a point.
    fn open_share(&self, point: &SurfacePoint, sampler: PixelSampler, samples: u32) -> f32 {
        let Shot { scene, radius, .. } = self.shot;
        let samples = samples.clamp(1, MAX_SAMPLES);
        // A direction below the triangle is blocked by the triangle itself.
        let mut directions = hemisphere(&sampler, samples, point.normal);
        directions.retain(|direction| direction.dot(point.geometric_normal) > 0.0);
        let blocked = |bundle: &[Vec3]| scene.blocked_bundle(point.ray_origin(), bundle, radius).count_ones();
        let open = directions.len() as u32 - directions.chunks(BUNDLE).map(blocked).sum::<u32>();
        open as f32 / samples as f32
    }
}

impl Integrator for Ao<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Some(point) = self.surface(at) else { return Vec3::ONE };
        Vec3::splat(f32::from(is_open(self.shot.scene, &point, self.shot.radius, stream)))
    }

    /// All rays of a pixel's middle start at one point, and go as bundles.
    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        if shot.footprint == Footprint::Box {
            return super::mean_of_samples(self, shot, x, y, sampler, count);
        }
        let point = self.surface(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        Vec3::splat(point.map_or(1.0, |point| self.open_share(&point, sampler, count)))
    }
}

/// Whether a cosine-distributed direction around a point's normal is open: one sample of ambient occlusion.
pub(super) fn is_open(scene: &TracedScene, point: &SurfacePoint, radius: f32, stream: &mut Stream) -> bool {
    let [u, v] = stream.next_2d().to_array();
    let direction = frame(point.normal) * cosine_hemisphere(u, v);
    direction.dot(point.geometric_normal) > 0.0 && !scene.blocked(point.ray_origin(), direction, radius)
}

/// Cosine-distributed directions around a normal, neighbours one after the other: in the order of a Morton curve
/// over the square that they come from.
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
    use crate::path::{Sampling, render};
    use crate::scene::{Camera, Material, Mesh, Scene};
    use deepshade_shaders::Effect;

    const SAMPLES: u32 = 4096;
    /// Above the error of 4,096 stratified samples of a share, below every difference that the tests tell apart.
    const TOLERANCE: f32 = 4e-3;

    fn traced(meshes: Vec<Mesh>) -> TracedScene {
        TracedScene::new(Scene { meshes, materials: vec![Material::default()], ..Scene::default() })
            .expect("triangles")
    }

    fn quad(corners: [Vec3; 4]) -> Mesh {
        Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
    }

    fn floor() -> Mesh {
        quad([(-9., 9.), (9., 9.), (9., -9.), (-9., -9.)].map(|(x, z)| Vec3::new(x, 0.0, z)))
    }

    /// Openness of the floor at (x, 0, 0), seen from nearby.
    fn at_floor(scene: &TracedScene, x: f32, radius: f32) -> f32 {
        let camera = Camera::look_at(Vec3::new(x, 0.01, 0.0), Vec3::new(x, 0.0, 0.0));
        let shot = Shot::new(scene, &camera, [1, 1], radius);
        render(Effect::Ao, &shot, Sampling::one(SAMPLES, 1)).mean.at(0, 0, 0)
    }

    #[test]
    fn nothing_blocks_a_plane() {
        assert_eq!(at_floor(&traced(vec![floor()]), 0.5, 100.0), 1.0);
    }

    #[test]
    fn a_long_wall_blocks_its_closed_form() {
        // Derived exactly for an infinitely long wall of height H at distance d: (1 - d / sqrt(d^2 + H^2)) / 2.
        let wall =
            quad([(-900., 0.), (900., 0.), (900., 2.), (-900., 2.)].map(|(z, y)| Vec3::new(0.0, y, z)));
        let scene = traced(vec![floor(), wall]);
        for d in [0.3f32, 1.0, 4.0] {
            let expected = 1.0 - 0.5 * (1.0 - d / (d * d + 4.0).sqrt());
            let value = at_floor(&scene, d, 1e4);
            assert!((value - expected).abs() < TOLERANCE, "at {d}: {value} is not {expected}");
        }
    }

    #[test]
    fn a_disk_blocks_its_form_factor_and_not_its_solid_angle() {
        let (radius, height) = (1.0f32, 0.8f32);
        let segments = 256;
        let rim = |i: u32| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / segments as f32).sin_cos();
            Vec3::new(radius * cos, height, radius * sin)
        };
        let disk = Mesh {
            positions: std::iter::once(Vec3::Y * height).chain((0..segments).map(rim)).collect(),
            triangles: (0..segments).map(|i| [0, 1 + i, 1 + (i + 1) % segments]).collect(),
            ..Mesh::default()
        };
        let scene = traced(vec![floor(), disk]);
        let value = at_floor(&scene, 0.0, 1e4);
        // Coaxial disk: r^2 / (r^2 + h^2) with the cosine, 1 - h / sqrt(r^2 + h^2) without.
        let squared = radius * radius + height * height;
        let with_cosine = 1.0 - radius * radius / squared;
        let without = height / squared.sqrt();
        assert!((value - with_cosine).abs() < TOLERANCE, "{value} is not {with_cosine}");
        assert!((value - without).abs() > 10.0 * TOLERANCE, "a cosine left out is noticed");
    }

    #[test]
    fn a_blocker_beyond_the_radius_does_not_count() {
        let ceiling = quad([(-9., 9.), (9., 9.), (9., -9.), (-9., -9.)].map(|(x, z)| Vec3::new(x, 1.0, z)));
        let scene = traced(vec![floor(), ceiling]);
        assert_eq!(at_floor(&scene, 0.0, 0.99), 1.0);
        // Within R, the plane at height h blocks the cone of half angle acos(h / R): sin^2 = 1 - h^2 / R^2.
        let value = at_floor(&scene, 0.0, 2.0);
        assert!((value - 0.25).abs() < TOLERANCE, "{value} is not 1/4");
    }

    #[test]
    fn inside_a_closed_box_everything_is_blocked() {
        let corner =
            |i: usize| Vec3::new(f32::from(i & 1 == 1), f32::from(i & 2 == 2), f32::from(i & 4 == 4));
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let boxed = faces.map(|face| quad(face.map(|i: usize| corner(i) * 4.0 - Vec3::new(2.0, 0.0, 2.0))));
        assert_eq!(at_floor(&traced(boxed.to_vec()), 0.3, 1e4), 0.0);
    }

    #[test]
    fn images_do_not_depend_on_the_number_of_threads() {
        let wall = quad([(-9., 0.), (9., 0.), (9., 2.), (-9., 2.)].map(|(z, y)| Vec3::new(0.0, y, z)));
        let scene = traced(vec![floor(), wall]);
        let camera = Camera::look_at(Vec3::new(2.0, 1.0, 0.5), Vec3::ZERO);
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let shot = Shot::new(&scene, &camera, [37, 51], 1.0);
            pool.install(|| render(Effect::Ao, &shot, Sampling::one(8, 3)))
        };
        assert_eq!(image(1), image(3));
    }
}
