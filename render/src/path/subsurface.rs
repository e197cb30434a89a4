//! Truth for subsurface scattering: light that random walks below the surface bring out again.
//!
//! A path enters where the surface is seen, in a cosine-distributed direction, flies on through a homogeneous
//! medium that scatters isotropically, and ends at the first surface that it meets from within. What falls
//! there from outside, direct light reflected diffusely by a white surface, comes out where it entered. The
//! surface refracts nothing and spreads what passes it evenly, so that a half space under even light has the
//! reflectance of the material's diffuse colour `A`: the albedo of a collision is `1 - s^2`, with the `s`
//! whose half space reflects `A = (1 - s)(1 - 0.139 s) / (1 + 1.17 s)` (van de Hulst 1980; inverted by Kulla
//! and Conty, "Revisiting Physically Based Shading at Imageworks", 2017), to 1 %, and to 3 % for what is
//! almost black. `A` and the mean free path of each colour are those where the path enters. A colour without
//! a mean free path, or with one that is lost in the rounding of positions, does not enter: it is reflected
//! diffusely, which is the limit of short paths. Specular reflection and emission are left out.
//!
//! No side of a mesh is its inside: a path enters away from the viewer, so that meshes turned inside out look
//! the same. Light is lost on paths that leave through a hole without meeting a surface, and on those still
//! below after [`MOST_COLLISIONS`], less than one in a hundred even in a white half space. Another object's
//! surface inside ends a path like the object's own, with the light that falls on it from behind.

use super::direct::direct_light;
use super::medium::FreeFlight;
use super::{Integrator, Shot};
use crate::bvh::{Hit, TracedScene};
use crate::intersection::SurfacePoint;
use crate::sampler::{Stream, cosine_hemisphere, frame};
use glam::{BVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// Where a path is given up.
const MOST_COLLISIONS: u32 = 1 << 14;

/// Collisions before Russian roulette.
const CERTAIN_COLLISIONS: u32 = 8;

/// Shortest mean free path, in parts of the largest coordinate of the point: some thirty roundings of f32.
const SHORTEST: f32 = 4e-6;

/// Light out of the body that is seen: radiance.
#[derive(Clone, Copy, Debug)]
pub struct Subsurface<'a> {
    shot: Shot<'a>,
}

impl<'a> Subsurface<'a> {
    /// Random walks in the shot's scene.
    pub const fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot }
    }
}

impl Integrator for Subsurface<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let direction = camera.direction(at, height, width);
        let Some(hit) = scene.hit(camera.position, direction, f32::INFINITY) else { return Vec3::ZERO };
        let outside = SurfacePoint::new(scene, &hit, direction);
        let body = Body::of(&outside);
        let on_top = match body.entered.all() {
            true => Vec3::ZERO,
            false => direct_light(scene, &outside, -direction).diffuse,
        };
        if !body.entered.any() {
            return on_top;
        }
        // Seen from the other side, the surface's normals and the starts of its rays are within.
        let inside = SurfacePoint::new(scene, &hit, -direction);
        let brought_out = body.walk(scene, &hit, &inside, stream);
        Vec3::select(body.entered, brought_out, on_top)
    }
}

/// What is below a surface.
#[derive(Clone, Copy, Debug)]
struct Body {
    /// The colours that light enters in.
    entered: BVec3,
    /// Share of light that a collision leaves.
    albedo: Vec3,
    /// Collisions a metre; 0 for colours that do not enter.
    extinction: Vec3,
}

impl Body {
    /// What the material of a point says.
    fn of(point: &SurfacePoint) -> Self {
        let shortest = point.position.abs().max_element().max(1e-3) * SHORTEST;
        let entered = point.surface.mean_free_path.cmpgt(Vec3::splat(shortest));
        let extinction = Vec3::select(entered, point.surface.mean_free_path.recip(), Vec3::ZERO);
        Self { entered, albedo: point.surface.diffuse.map(single_scattering_albedo), extinction }
    }

    /// Light that one path brings back to where it starts, just below the point `entry` of a surface.
    fn walk(&self, scene: &TracedScene, entry: &Hit, start: &SurfacePoint, stream: &mut Stream) -> Vec3 {
        let [u, v] = stream.next_2d().to_array();
        let mut direction = frame(start.geometric_normal) * cosine_hemisphere(u, v);
        let mut origin = start.position;
        let mut throughput = Vec3::select(self.entered, Vec3::ONE, Vec3::ZERO);
        for collisions in 0..MOST_COLLISIONS {
            let flight = FreeFlight::new(self.extinction, throughput, stream.next_2d());
            let mut met = scene.hit(origin, direction, flight.distance);
            if collisions == 0 && met.is_some_and(|hit| same_triangle(&hit, entry)) {
                // A start above the surface by a rounding. Starting well below always would miss short paths.
                met = scene.hit(start.ray_origin(), direction, flight.distance);
            }
            if let Some(hit) = met {
                return throughput * flight.passed(hit.distance) * light_outside(scene, &hit, direction);
            }
            throughput *= self.albedo * self.extinction * flight.collided();
            let left = throughput.max_element();
            let survival = if collisions < CERTAIN_COLLISIONS { 1.0 } else { left.min(1.0) };
            if left == 0.0 || (survival < 1.0 && stream.next_1d() >= survival) {
                return Vec3::ZERO;
            }
            throughput /= survival;
            origin += direction * flight.distance;
            direction = uniform_sphere(stream.next_2d());
        }
        Vec3::ZERO
    }
}

fn same_triangle(a: &Hit, b: &Hit) -> bool {
    (a.mesh, a.triangle) == (b.mesh, b.triangle)
}

/// Direct light that a path through the surface at `hit` finds outside: what a white matte surface would
/// reflect.
fn light_outside(scene: &TracedScene, hit: &Hit, direction: Vec3) -> Vec3 {
    let mut outside = SurfacePoint::new(scene, hit, -direction);
    outside.surface.diffuse = Vec3::ONE;
    direct_light(scene, &outside, direction).diffuse
}

/// Albedo of a collision below a surface whose half space reflects `reflectance` of even light.
fn single_scattering_albedo(reflectance: f32) -> f32 {
    let b = 1.139 + 1.17 * reflectance;
    let s = (b - (b * b - 4.0 * 0.139 * (1.0 - reflectance)).sqrt()) / (2.0 * 0.139);
    1.0 - s * s
}

/// A direction, all alike.
fn uniform_sphere(at: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * at.x;
    let (sin, cos) = (TAU * at.y).sin_cos();
    let aside = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(aside * cos, aside * sin, z)
}

#[cfg(test)]
mod tests;
