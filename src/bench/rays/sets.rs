//! The rays: those of a camera, those that ask for ambient occlusion, and those that leave a surface after
//! one diffuse bounce.

use deepshade_render::bvh::TracedScene;
use deepshade_render::bvh::bundle::BUNDLE;
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::path::ao::hemisphere;
use deepshade_render::sampler::PixelSampler;
use deepshade_render::scene::Camera;
use glam::{Vec2, Vec3};

/// Every which surface ambient occlusion rays start from: neighbours tell nothing new.
const STRIDE: usize = 16;

/// How far rays for ambient occlusion go, as a share of the scene's diagonal.
const AO_SHARE: f32 = 0.15;

/// Why rays are traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// To what a camera sees, in squares of pixels, as a g-buffer traces them.
    Primary,
    /// Whether anything is within a radius, cosine-distributed, as ambient occlusion asks.
    Ao,
    /// To what a surface sees after one cosine-distributed bounce: neighbours go different ways.
    Diffuse,
}

impl Kind {
    /// What its figures are called by.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Ao => "ao",
            Self::Diffuse => "diffuse",
        }
    }
}

/// A ray.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// A unit vector.
    pub direction: Vec3,
    /// How far it goes.
    pub reach: f32,
}

/// Rays that start at one point.
pub struct Bundle {
    pub origin: Vec3,
    /// Unit vectors, neighbours one after the other.
    pub directions: Vec<Vec3>,
    pub reach: f32,
}

/// Rays of a kind.
pub struct RaySet {
    pub kind: Kind,
    pub rays: Vec<Ray>,
    /// The same rays in the same order, where the program traces such rays together; else empty.
    pub bundles: Vec<Bundle>,
}

/// All kinds of rays of some views of a scene.
pub fn all<'a>(scene: &TracedScene, cameras: impl Iterator<Item = &'a Camera>, size: usize) -> [RaySet; 3] {
    let primary = RaySet::of_bundles(Kind::Primary, cameras.flat_map(|c| squares(c, size)).collect());
    let seen = |ray: &Ray| {
        let hit = scene.hit(ray.origin, ray.direction, ray.reach)?;
        Some(SurfacePoint::new(scene, &hit, ray.direction))
    };
    let points: Vec<SurfacePoint> = primary.rays.iter().filter_map(seen).collect();
    let reach = AO_SHARE * scene.diagonal();
    let occlusion = |(i, point): (usize, &SurfacePoint)| {
        let directions = hemisphere(&PixelSampler::new(i, 0, 0), BUNDLE as u32, point.geometric_normal);
        Bundle { origin: point.ray_origin(), directions, reach }
    };
    let bounce = |(i, point): (usize, &SurfacePoint)| {
        let directions = hemisphere(&PixelSampler::new(i, 1, 0), 1, point.geometric_normal);
        Ray { origin: point.ray_origin(), direction: directions[0], reach: f32::INFINITY }
    };
    let ao = points.iter().enumerate().step_by(STRIDE).map(occlusion).collect();
    let diffuse = points.iter().enumerate().map(bounce).collect();
    [
        primary,
        RaySet::of_bundles(Kind::Ao, ao),
        RaySet { kind: Kind::Diffuse, rays: diffuse, bundles: vec![] },
    ]
}

impl RaySet {
    fn of_bundles(kind: Kind, bundles: Vec<Bundle>) -> Self {
        let rays = bundles.iter().flat_map(|Bundle { origin, directions, reach }| {
            directions.iter().map(|direction| Ray { origin: *origin, direction: *direction, reach: *reach })
        });
        Self { kind, rays: rays.collect(), bundles }
    }
}

/// The rays of a camera, one through the middle of each pixel.
fn squares(camera: &Camera, size: usize) -> impl Iterator<Item = Bundle> {
    let camera = *camera;
    let edge = BUNDLE.isqrt();
    let corners = move || (0..size).step_by(edge);
    corners().flat_map(move |top| corners().map(move |left| (left, top))).map(move |(left, top)| {
        let columns = left..size.min(left + edge);
        let pixels = (top..size.min(top + edge)).flat_map(|y| columns.clone().map(move |x| (x, y)));
        let direction =
            |(x, y): (usize, usize)| camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), size, size);
        let directions = pixels.map(direction).collect();
        Bundle { origin: camera.position, directions, reach: f32::INFINITY }
    })
}
