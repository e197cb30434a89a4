//! Truth for ambient occlusion: the cosine-weighted share of directions of the hemisphere around the shading normal
//! that nothing blocks within a radius (thesis 7.4).

use super::sampler::{MAX_SAMPLES, PixelSampler, cosine_hemisphere, frame};
use crate::bvh::{
    TracedScene,
    bundle::{BUNDLE, Start},
};
use crate::intersection::SurfacePoint;
use crate::scene::Camera;
use deepshade_shaders::{Effect, Planes};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Edge of the squares of pixels that threads take, so that a thread's rays stay near each other.
const TILE: usize = 16;

/// Path-traced ambient occlusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ao {
    /// How far a blocker may be, metres.
    pub radius: f32,
    /// Rays a pixel; above 65,536 the sequence is cut.
    pub samples: u32,
    /// Renderings with different seeds are independent.
    pub seed: u32,
}

impl Ao {
    /// The image of a camera, `[1, height, width]`, unitless; 1 where nothing is seen.
    pub fn render(&self, scene: &TracedScene, camera: &Camera, height: usize, width: usize) -> Planes {
        self.render_where(scene, camera, height, width, |_, _| true)
    }

    /// [`Ao::render`], but only for the pixels (x, y) that are wanted; the others are 1.
    pub fn render_where(
        &self,
        scene: &TracedScene,
        camera: &Camera,
        height: usize,
        width: usize,
        wanted: impl Fn(usize, usize) -> bool + Sync,
    ) -> Planes {
        let columns = width.div_ceil(TILE);
        let tiles: Vec<[f32; TILE * TILE]> = (0..columns * height.div_ceil(TILE))
            .into_par_iter()
            .map(|tile| {
                let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
                std::array::from_fn(|i| {
                    let (x, y) = (x0 + i % TILE, y0 + i / TILE);
                    let inside = x < width && y < height && wanted(x, y);
                    if inside { self.pixel(scene, camera, height, width, x, y) } else { 1.0 }
                })
            })
            .collect();
        Planes::from_fn(1, height, width, |_, y, x| {
            tiles[y / TILE * columns + x / TILE][y % TILE * TILE + x % TILE]
        })
    }

    /// The value of pixel (`x`, `y`): of the surface seen through its middle.
    pub fn pixel(
        &self,
        scene: &TracedScene,
        camera: &Camera,
        height: usize,
        width: usize,
        x: usize,
        y: usize,
    ) -> f32 {
        let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
        match scene.hit(camera.position, direction, f32::INFINITY) {
            Some(hit) => {
                let point = SurfacePoint::new(scene, &hit, direction);
                self.open_share(scene, &point, PixelSampler::new(x, y, self.seed))
            }
            None => Effect::Ao.background(),
        }
    }

    /// The open share of the hemisphere over a point.
    fn open_share(&self, scene: &TracedScene, point: &SurfacePoint, sampler: PixelSampler) -> f32 {
        let start = Start { origin: point.ray_origin(), above: point.geometric_normal, reach: self.radius };
        let samples = self.samples.clamp(1, MAX_SAMPLES);
        // A direction below the triangle is blocked by the triangle itself.
        let mut directions = hemisphere(&sampler, samples, point.normal);
        directions.retain(|direction| direction.dot(point.geometric_normal) > 0.0);
        let open: u32 = directions
            .chunks(BUNDLE)
            .map(|bundle| bundle.len() as u32 - scene.blocked_bundle(start, bundle).count_ones())
            .sum();
        open as f32 / samples as f32
    }
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
fn morton(number: f32) -> u32 {
    let spread = |bits: u32, shift: u32, mask: u32| (bits | bits << shift) & mask;
    spread(spread(spread((number * 256.0) as u32, 4, 0x0f0f), 2, 0x3333), 1, 0x5555)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Scene};

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
        Ao { radius, samples: SAMPLES, seed: 1 }.pixel(scene, &camera, 1, 1, 0, 0)
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
            pool.install(|| Ao { radius: 1.0, samples: 8, seed: 3 }.render(&scene, &camera, 37, 51))
        };
        assert_eq!(image(1), image(3));
    }
}
