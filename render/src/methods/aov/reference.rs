//! Both methods in plain Rust: every pixel and every ray against every facet, without a tree.

use super::bounced::AovBouncedZParameters;
use super::facets::patches_of_scene;
use super::polygon::form_factor;
use crate::methods::Surface;
use crate::methods::bounced_z::reference::{Sample, place_on_disk, reconstruction};
use crate::methods::bounced_z::{Matte, Reflector};
use crate::scene::{Camera, Scene};
use crate::screen::View;
use crate::surfels::reference::vertices;
use deepshade_shaders::random::{hash, random};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, Vec3};

/// What an endless sum hides.
///
/// Of pixels of room, still life, colonnade and shelves whose sums are about 0.3, 0.54, 0.77, 1.02 and 2.1
/// truth hides 0.21, 0.34, 0.43, 0.54 and 0.64 in the mean; this makes 0.24, 0.38, 0.47, 0.54 and 0.67 of
/// them.
pub const MOST_HIDDEN: f32 = 0.7;

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Camera space, metres.
    pub corners: [Vec3; 3],
    /// Share of it that is there: alpha.
    pub coverage: f32,
    /// Whether its back counts too, since its surface is no closed one.
    pub open: bool,
}

impl Facet {
    /// Whether its box is within reach of a point, so that it may be.
    fn is_near(&self, at: Vec3, reach: f32) -> bool {
        let [a, b, c] = self.corners;
        let gap = (at - a.max(b).max(c)).max(a.min(b).min(c) - at).max(Vec3::ZERO);
        gap.length_squared() < reach * reach
    }
}

/// The facets of a scene, as a camera sees them.
pub fn facets(scene: &Scene, camera: &Camera) -> Vec<Facet> {
    let vertices = vertices(scene.meshes.iter(), camera);
    let facet = |patch: crate::raster::patches::Patch| {
        let [a, b, c] = patch.corners.map(|corner| vertices[corner as usize]);
        let corners = patch.weights().map(|weights| a * weights.x + b * weights.y + c * weights.z);
        Facet { corners, coverage: patch.coverage(), open: patch.is_open() }
    };
    patches_of_scene(scene).into_iter().map(facet).collect()
}

/// A point lifted off its own surface, by more than what rounding may have sunk it.
pub fn lifted(at: Vec3, normal: Vec3, reach: f32) -> Vec3 {
    at + (1e-4 * reach + 4e-6 * at.length()) * normal
}

/// What facets occlude of the hemisphere over a surface, added up.
pub fn occluded(facets: &[Facet], at: Vec3, normal: Vec3, reach: f32) -> f32 {
    let of_facet = |Facet { corners, coverage, open }: &Facet| {
        let [a, b, c] = corners.map(|corner| corner - at);
        let is_behind = a.dot((b - a).cross(c - a)) > 0.0;
        coverage * form_factor(if *open && is_behind { [a, c, b] } else { [a, b, c] }, normal, reach)
    };
    facets.iter().filter(|facet| facet.is_near(at, reach)).map(of_facet).sum()
}

/// What is open, from a sum in which what hides behind something counts as well.
pub fn compensated(sum: f32) -> f32 {
    1.0 - MOST_HIDDEN * (1.0 - (-sum / MOST_HIDDEN).exp())
}

/// Ambient occlusion by volumes, `[1, height, width]`.
pub fn openness(surface: &Surface, facets: &[Facet], reach: f32) -> Planes {
    surface.image(1.0, |pixel| {
        let normal = surface.normal_at(pixel);
        let at = lifted(surface.position_at(pixel), normal, reach);
        [compensated(occluded(facets, at, normal, reach))]
    })
}

/// How far along a ray it meets a triangle, from either side (Moeller and Trumbore 1997, "Fast, Minimum
/// Storage Ray/Triangle Intersection").
pub fn distance(corners: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
    let [a, b, c] = corners;
    let (first, second, way) = (b - a, c - a, origin - a);
    let across = direction.cross(second);
    let size = first.dot(across);
    let upwards = way.cross(first);
    let (u, v) = (way.dot(across) / size, direction.dot(upwards) / size);
    let distance = second.dot(upwards) / size;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

/// The samples of a pixel: 1 where no facet is met.
fn samples(
    surface: &Surface,
    facets: &[Facet],
    rays: &uniforms::FacetRays,
    at: IVec2,
    matte: Matte,
) -> Vec<Sample> {
    let Matte(normal) = matte;
    let origin = lifted(surface.position_at(at), normal, rays.reach);
    let pixel = at.as_uvec2();
    let near: Vec<(usize, &Facet)> =
        facets.iter().enumerate().filter(|(_, facet)| facet.is_near(origin, rays.reach)).collect();
    let sample = |number| {
        let direction = matte.direction(place_on_disk(pixel, number, [rays.directions, rays.seed]));
        let is_met = |&(index, facet): &(usize, &Facet)| {
            let met = distance(facet.corners, origin, direction).is_some_and(|far| far < rays.reach);
            let seed = hash(rays.seed.wrapping_add(index as u32));
            met && random(pixel.x, pixel.y, seed, number) < facet.coverage
        };
        let hidden = near.iter().any(is_met);
        Sample { direction, arrived: if hidden { Vec3::ZERO } else { Vec3::ONE } }
    };
    (0..rays.directions).map(sample).collect()
}

/// Ambient occlusion by a bounced z-buffer, `[1, height, width]`.
pub fn visible_sky(
    surface: &Surface,
    facets: &[Facet],
    parameters: &AovBouncedZParameters,
    view: &View,
) -> Planes {
    let rays = parameters.rays(view);
    reconstruction(surface, &parameters.window(view), Effect::Ao, &Matte::all_over(surface), |at, matte| {
        samples(surface, facets, &rays, at, *matte)
    })
}
