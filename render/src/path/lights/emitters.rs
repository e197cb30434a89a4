//! Emissive triangles: chosen by their power, then sampled uniformly by area. They shine to both sides, as
//! surfaces do.

use crate::bvh::{Hit, TracedScene, corner_weights};
use crate::intersection::{Start, colour, uvs};
use crate::scene::{Cumulative, Mesh, Scene};
use glam::{Vec2, Vec3};

/// Emission of a triangle below which its share is not reduced, relative to the factor of its texture and
/// opacity: a few points of the triangle cannot prove that it is dark, and what is never chosen would be
/// missing.
const LEAST_SHARE: f32 = 0.01;

/// All triangles that shine.
#[derive(Debug)]
pub(super) struct Emitters {
    /// Mesh and triangle of each.
    triangles: Vec<(u32, u32)>,
    /// Of each mesh, the first of `triangles`; `None` of one that does not shine.
    first: Vec<Option<usize>>,
    shares: Cumulative,
    /// Sum of mean radiance times area, W/sr.
    strength: f32,
    centre: Vec3,
    /// Squared half diagonal of the box around them.
    extent_squared: f32,
}

/// A point of a triangle that shines.
pub(super) struct EmitterSample {
    /// Just off the triangle, on the side of the point that it shines on.
    pub position: Vec3,
    /// From there, times opacity.
    pub radiance: Vec3,
    /// Per steradian.
    pub density: f32,
}

impl Emitters {
    /// Those of a scene; `None` where nothing shines. Triangles without an area are never chosen.
    pub(super) fn new(scene: &TracedScene) -> Option<Self> {
        let scene = scene.scene();
        let mut triangles = Vec::new();
        let mut bounds = crate::scene::Bounds::EMPTY;
        let mut first = vec![None; scene.meshes.len()];
        for (index, mesh) in scene.meshes.iter().enumerate() {
            if scene.material(mesh.material).emission.max_element() > 0.0 {
                first[index] = Some(triangles.len());
                bounds = bounds.union(mesh.bounds());
                triangles.extend((0..mesh.triangles.len()).map(|triangle| (index as u32, triangle as u32)));
            }
        }
        let strengths: Vec<f64> = triangles
            .iter()
            .map(|(mesh, triangle)| strength(scene, *mesh as usize, *triangle as usize))
            .collect();
        Some(Self {
            shares: Cumulative::new(strengths.iter().copied())?,
            triangles,
            first,
            strength: strengths.iter().sum::<f64>() as f32,
            centre: bounds.centre(),
            extent_squared: (0.5 * bounds.diagonal()).powi(2),
        })
    }

    /// Roughly the irradiance at a point: that of all strength in one place, not nearer than its spread.
    pub(super) fn importance(&self, point: Vec3) -> f32 {
        self.strength / (point.distance_squared(self.centre) + self.extent_squared)
    }

    /// A point that shines on `point`; `None` where it is seen edge on or dark.
    pub(super) fn sample(
        &self,
        scene: &Scene,
        point: Vec3,
        choice: f32,
        square: Vec2,
    ) -> Option<EmitterSample> {
        let (index, _) = self.shares.sample(choice);
        let (mesh, triangle) = self.triangles[index];
        let mesh = &scene.meshes[mesh as usize];
        let corners = mesh.corners(triangle as usize);
        let barycentric = uniform_in_triangle(square);
        let (area, normal) = area_and_normal(corners);
        let side = normal * (point - corners[0]).dot(normal).signum();
        let position = Start::new(corners, corner_weights(barycentric), normal).above(side);
        let density = self.shares.probability(index) * per_steradian(area, normal, position - point);
        let radiance = emitted(scene, mesh, triangle as usize, barycentric);
        let usable = density.is_finite() && density > 0.0 && radiance != Vec3::ZERO;
        usable.then_some(EmitterSample { position, radiance, density })
    }

    /// Density per steradian with which [`Emitters::sample`] takes the direction of a ray from some point to
    /// a hit.
    pub(super) fn density(&self, scene: &Scene, direction: Vec3, hit: &Hit) -> f32 {
        let Some(first) = self.first[hit.mesh as usize] else { return 0.0 };
        let corners = scene.meshes[hit.mesh as usize].corners(hit.triangle as usize);
        let (area, normal) = area_and_normal(corners);
        let density = self.shares.probability(first + hit.triangle as usize)
            * per_steradian(area, normal, direction * hit.distance);
        if density.is_finite() { density } else { 0.0 }
    }
}

/// Area density 1 / `area` seen from a point `to_light` away: times squared distance over the cosine at the
/// light.
fn per_steradian(area: f32, normal: Vec3, to_light: Vec3) -> f32 {
    let squared = to_light.length_squared();
    squared * squared.sqrt() / (area * normal.dot(to_light).abs())
}

fn area_and_normal([a, b, c]: [Vec3; 3]) -> (f32, Vec3) {
    let across = (b - a).cross(c - a);
    (0.5 * across.length(), across.normalize_or_zero())
}

/// Weights of the second and third corner, uniform by area (Turk 1990).
fn uniform_in_triangle(square: Vec2) -> Vec2 {
    let root = square.x.sqrt();
    Vec2::new(root * (1.0 - square.y), root * square.y)
}

/// Radiance that leaves a point of a triangle, times the opacity there: what is not there does not shine.
fn emitted(scene: &Scene, mesh: &Mesh, triangle: usize, barycentric: Vec2) -> Vec3 {
    let (corners, weights) = (mesh.triangles[triangle], corner_weights(barycentric));
    let material = scene.material(mesh.material);
    let uvs = uvs(mesh, corners, weights);
    material.emitted(&scene.textures, uvs)
        * material.opacity(&scene.textures, uvs, colour(mesh, corners, weights))
}

/// Mean radiance of a triangle times its area, W/sr; 0 without an area.
fn strength(scene: &Scene, mesh: usize, triangle: usize) -> f64 {
    let mesh = &scene.meshes[mesh];
    let material = scene.material(mesh.material);
    let (area, _) = area_and_normal(mesh.corners(triangle));
    let opacity_varies = material.can_be_seen_through()
        && (material.base_colour_texture.is_some() || !mesh.colours.is_empty());
    let mean = if opacity_varies || material.emission_texture.is_some() {
        mean_emitted(scene, mesh, triangle)
    } else {
        emitted(scene, mesh, triangle, Vec2::splat(1.0 / 3.0))
    };
    f64::from(mean.max(material.emission * LEAST_SHARE).element_sum() / 3.0 * area)
}

/// Mean over the middles of ten of the sixteen small triangles that a triangle consists of.
fn mean_emitted(scene: &Scene, mesh: &Mesh, triangle: usize) -> Vec3 {
    let middle = |i: usize| (i as f32 + 1.0 / 3.0) / 4.0;
    let points = (0..4).flat_map(|i| (0..4 - i).map(move |j| Vec2::new(middle(i), middle(j))));
    points.map(|point| emitted(scene, mesh, triangle, point)).sum::<Vec3>() / 10.0
}
