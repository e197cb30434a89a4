//! Truth for diffuse indirect light, the effect `gi`: `1 / pi` times the irradiance, at the point that is
//! seen, of light that left another surface within a radius after one diffuse reflection of direct light
//! (thesis 7.4).
//!
//! Direct light comes from every light of the scene, with shadows at any distance; the surface on the way
//! reflects it by its diffuse colour, as Lambert does and the attribute `Ldiff` has it. Light that surfaces
//! emit by themselves is direct light and not counted. Times the receiver's diffuse colour it is radiance.
//! Blended surfaces send, and let through, by their opacity, as in
//! [`Transport`](super::transport::Transport).
//!
//! The effect `glossy` is the radiance that the receiver's specular lobe reflects to the eye of that same
//! light.

use super::Shot;
use super::at_surface::{SurfaceEffect, Visible};
use super::bsdf::Bsdf;
use super::lights::{Lights, LightsAt};
use super::transport::power_heuristic;
use crate::bvh::{Hit, TracedScene};
use crate::intersection::SurfacePoint;
use crate::sampler::{Stream, cosine_hemisphere, frame};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// What becomes of indirect light where it arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Receiver {
    /// Irradiance over pi: without the receiver's colour.
    Diffuse,
    /// Radiance reflected to the eye by the specular lobe.
    Glossy,
}

/// Path-traced light of one diffuse bounce.
#[derive(Debug)]
pub struct Gi<'a> {
    scene: &'a TracedScene,
    lights: Lights<'a>,
    radius: f32,
    receiver: Receiver,
}

impl<'a> Gi<'a> {
    /// Indirect light from within the shot's radius.
    pub fn new(shot: &Shot<'a>, receiver: Receiver) -> Self {
        Self { scene: shot.scene, lights: Lights::new(shot.scene), radius: shot.radius, receiver }
    }

    /// Radiance that comes to a point against a direction after a diffuse reflection of direct light.
    fn bounced(&self, point: &SurfacePoint, direction: Vec3, stream: &mut Stream) -> Vec3 {
        // What leaves below the triangle meets the triangle itself, whose other side it does not see.
        if direction.dot(point.geometric_normal) <= 0.0 {
            return Vec3::ZERO;
        }
        let Some(hit) = self.hit(point, direction, self.radius, stream) else { return Vec3::ZERO };
        let sender = SurfacePoint::new(self.scene, &hit, direction);
        self.irradiance(&sender, stream) * sender.surface.diffuse * FRAC_1_PI
    }

    /// The surface that a ray from a point meets.
    fn hit(&self, point: &SurfacePoint, direction: Vec3, reach: f32, stream: &mut Stream) -> Option<Hit> {
        self.scene.hit_by_chance(point.ray_origin(), direction, reach, || stream.next_1d())
    }

    /// One sample of the irradiance of direct light: of a light and of a direction, which may meet one,
    /// weighed by the power heuristic.
    fn irradiance(&self, point: &SurfacePoint, stream: &mut Stream) -> Vec3 {
        let lights = self.lights.at_surface(point);
        let sampled = self.of_a_light(point, &lights, stream);
        if !self.lights.have_extent() {
            return sampled;
        }
        sampled + self.of_a_direction(point, &lights, stream)
    }

    /// Irradiance by one light.
    fn of_a_light(&self, point: &SurfacePoint, lights: &LightsAt<'_>, stream: &mut Stream) -> Vec3 {
        let Some(light) = lights.sample(stream) else { return Vec3::ZERO };
        let cosine = point.normal.dot(light.direction);
        if cosine <= 0.0 || point.geometric_normal.dot(light.direction) <= 0.0 {
            return Vec3::ZERO;
        }
        let weight = light.density.map_or(1.0, |density| power_heuristic(density, cosine * FRAC_1_PI));
        let let_through = self.scene.let_through(point.ray_origin(), light.direction, light.distance);
        light.radiance * cosine * weight * let_through
    }

    /// Irradiance by the light that a direction of the hemisphere meets, drawn by its cosine.
    fn of_a_direction(&self, point: &SurfacePoint, lights: &LightsAt<'_>, stream: &mut Stream) -> Vec3 {
        let square = stream.next_2d();
        let direction = frame(point.normal) * cosine_hemisphere(square.x, square.y);
        let density = point.normal.dot(direction) * FRAC_1_PI;
        if density <= 0.0 || direction.dot(point.geometric_normal) <= 0.0 {
            return Vec3::ZERO;
        }
        let (radiance, other) = match self.hit(point, direction, f32::INFINITY, stream) {
            Some(hit) => {
                let emission = SurfacePoint::new(self.scene, &hit, direction).surface.emission;
                (emission, lights.density_of_hit(direction, &hit))
            }
            None => (self.lights.environment(direction), lights.density_of_environment(direction)),
        };
        PI * radiance * power_heuristic(density, other)
    }
}

impl SurfaceEffect for Gi<'_> {
    fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3 {
        let Visible { mut point, to_viewer } = *visible;
        match self.receiver {
            Receiver::Diffuse => {
                let square = stream.next_2d();
                let direction = frame(point.normal) * cosine_hemisphere(square.x, square.y);
                self.bounced(&point, direction, stream)
            }
            Receiver::Glossy => {
                point = point.reflecting(to_viewer);
                point.surface.diffuse = Vec3::ZERO;
                let sample = Bsdf::new(&point).sample(to_viewer, stream);
                sample.map_or(Vec3::ZERO, |sample| {
                    sample.weight * self.bounced(&point, sample.direction, stream)
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::at_surface::AtSurface;
    use crate::path::proving::{MeanWithError, integral, quad};
    use crate::scene::{AlphaMode, Camera, Environment, Gloss, Light, Material, MaterialId, Mesh, Scene};

    /// Diffuse colour of what sends light.
    const COLOUR: Vec3 = Vec3::new(0.8, 0.5, 0.2);

    /// A square around the y axis that lies at a height.
    fn lying(half: f32, height: f32, material: u32) -> Mesh {
        let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
        let mesh = quad(corners.map(|(x, z)| Vec3::new(x, height, z)));
        Mesh { material: MaterialId(material), ..mesh }
    }

    /// Receivers of material 0, senders of material 1, under light of unit irradiance on faces against
    /// `direction`.
    fn lit(meshes: Vec<Mesh>, receiver: Material, direction: Vec3, irradiance: f32) -> TracedScene {
        let sender = Material { gloss: Gloss::None, ..Material::matte("sender", COLOUR) };
        let direction = direction.normalize();
        let irradiance = Vec3::splat(irradiance);
        TracedScene::new(Scene {
            meshes: meshes.into(),
            materials: vec![receiver, sender],
            lights: vec![Light::Directional { direction, irradiance, pattern: None }],
            ..Scene::default()
        })
        .expect("squares")
    }

    /// A patch too small to cast a shadow to speak of, and a square of half an edge above, lit from below.
    fn patch_and_square(half: f32, height: f32, receiver: Material, irradiance: f32) -> TracedScene {
        lit(vec![lying(1e-3, 0.0, 0), lying(half, height, 1)], receiver, Vec3::Y, irradiance)
    }

    fn at_patch(scene: &TracedScene, radius: f32, receiver: Receiver) -> MeanWithError {
        let camera = Camera::look_at(Vec3::new(0.0, 0.01, 0.01), Vec3::ZERO);
        let shot = Shot::new(scene, &camera, [1, 1], radius);
        MeanWithError::of(&AtSurface::new(&shot, Gi::new(&shot, receiver)), &shot, 4096)
    }

    /// From a patch to a square of edge 2 a over its middle, at a distance h: four corners of
    /// `(2 pi)^-1 2 A atan A` with A = (a / h) / sqrt(1 + (a / h)^2) each (Howell's catalogue, B-3).
    fn form_factor(half: f32, height: f32) -> f32 {
        let ratio = half / height;
        let root = (1.0 + ratio * ratio).sqrt();
        4.0 / PI * (ratio / root) * (ratio / root).atan()
    }

    #[test]
    fn a_square_sends_its_form_factor() {
        let scene = |irradiance| patch_and_square(1.0, 0.7, Material::default(), irradiance);
        let expected = COLOUR * FRAC_1_PI * form_factor(1.0, 0.7);
        let value = at_patch(&scene(1.0), f32::INFINITY, Receiver::Diffuse);
        value.proves("gi/square", expected);
        at_patch(&scene(1.02), f32::INFINITY, Receiver::Diffuse).refutes("gi/square", expected);
        // Without the receiver's cosine: the share of the hemisphere's solid angle, 4 asin(a^2 / (a^2 +
        // h^2)).
        let without = COLOUR * FRAC_1_PI * (1.0f32 / 1.49).asin() * 4.0 / (2.0 * PI);
        value.refutes("gi/square", without);
    }

    #[test]
    fn light_comes_from_within_the_radius() {
        let scene = patch_and_square(900.0, 1.0, Material::default(), 1.0);
        assert_eq!(at_patch(&scene, 0.99, Receiver::Diffuse).mean, Vec3::ZERO);
        // Of a plane at height h the cone of half angle acos(h / R): sin^2 = 1 - h^2 / R^2.
        let value = at_patch(&scene, 2.0, Receiver::Diffuse);
        assert!(value.is(0.75 * COLOUR * FRAC_1_PI), "{value:?}");
        assert!(at_patch(&scene, f32::INFINITY, Receiver::Diffuse).is(COLOUR * FRAC_1_PI));
    }

    #[test]
    fn parallel_squares_exchange_their_factor() {
        // The light comes aslant past the lower square's edge to all of the upper one.
        let direction = Vec3::new(1.5, 1.0, 0.0);
        let square = |irradiance| {
            lit(vec![lying(0.5, 0.0, 0), lying(0.5, 1.0, 1)], Material::default(), direction, irradiance)
        };
        // Two equal, directly opposed squares whose distance is their edge (Howell's catalogue, C-11).
        let (root, pi) = (2f32.sqrt(), PI);
        let factor =
            2.0 / pi * (0.5 * (4.0f32 / 3.0).ln() + 2.0 * root * (1.0 / root).atan() - 2.0 * 1f32.atan());
        assert!((factor - 0.199_825).abs() < 1e-5);
        let expected = COLOUR * FRAC_1_PI * factor * direction.normalize().y;
        let mean_over_lower = |scene: &TracedScene| {
            let camera = Camera::look_at(Vec3::Y, Vec3::ZERO);
            let shot = Shot::new(scene, &camera, [1, 1], f32::INFINITY);
            let gi = Gi::new(&shot, Receiver::Diffuse);
            let sample = |stream: &mut Stream| {
                let [x, z] = (stream.next_2d() - 0.5).to_array();
                let hit =
                    scene.hit(Vec3::new(x, 0.5, z), Vec3::NEG_Y, f32::INFINITY).expect("the lower square");
                let point = SurfacePoint::new(scene, &hit, Vec3::NEG_Y);
                gi.sample(&Visible { point, to_viewer: Vec3::Y }, stream)
            };
            MeanWithError::of_samples(sample, 4096)
        };
        let value = mean_over_lower(&square(1.0));
        value.proves("gi/parallel_plates", expected);
        mean_over_lower(&square(1.02)).refutes("gi/parallel_plates", expected);
        // Without the sender's cosine.
        value.refutes("gi/parallel_plates", expected / direction.normalize().y);
    }

    #[test]
    fn what_emits_is_direct_light_and_not_counted() {
        let mut scene = patch_and_square(1.0, 0.7, Material::default(), 1.0).scene().clone();
        scene.lights.clear();
        scene.materials[1].emission = Vec3::splat(5.0);
        let scene = TracedScene::new(scene).expect("squares");
        assert_eq!(at_patch(&scene, f32::INFINITY, Receiver::Diffuse).mean, Vec3::ZERO);
    }

    #[test]
    fn a_sender_that_touches_a_lamp_is_lit_with_bounded_noise() {
        // A wall below a ceiling that shines, met a millimetre below the edge that they share.
        let wall = quad([(0., 0.), (0., -1.), (1., -1.), (1., 0.)].map(|(x, y)| Vec3::new(x, y, 0.0)));
        let corners = [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, z)| Vec3::new(x, 0.0, z));
        let lamp = Material { emission: Vec3::splat(3.0), ..Material::matte("lamp", Vec3::ZERO) };
        let scene = TracedScene::new(Scene {
            meshes: vec![wall, Mesh { material: MaterialId(1), ..quad(corners) }].into(),
            materials: vec![Material::default(), lamp],
            ..Scene::default()
        })
        .expect("a wall and a lamp");
        let camera = Camera::look_at(Vec3::new(0.5, -0.001, 1.0), Vec3::new(0.5, -0.001, 0.0));
        let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
        let point = Visible::at(&shot, glam::Vec2::splat(0.5)).expect("the wall").point;
        let gi = Gi::new(&shot, Receiver::Diffuse);
        let irradiance = |stream: &mut Stream| gi.irradiance(&point, stream);
        let count = 100_000;
        let measured = MeanWithError::of_independent(irradiance, count);
        // Lambert's polygon formula: half the sum of the edges' angles times their planes' normals.
        let edges = (0..4).map(|i| (corners[i] - point.position, corners[(i + 1) % 4] - point.position));
        let sum: Vec3 = edges.map(|(a, b)| a.cross(b).normalize() * a.angle_between(b)).sum();
        let expected = 3.0 * 0.5 * sum.dot(point.normal).abs();
        measured.proves("gi/corner_of_a_lamp", Vec3::splat(expected));
        measured.refutes("gi/corner_of_a_lamp", Vec3::splat(1.02 * expected));
        let variance = count as f32 * (measured.error / measured.mean).x.powi(2);
        assert!(variance < 2.0, "a sample's variance is {variance} squared means");
    }

    #[test]
    fn a_blended_sender_sends_its_share() {
        let mut scene = patch_and_square(1.0, 0.7, Material::default(), 1.0).scene().clone();
        scene.materials[1].alpha = AlphaMode::Blend;
        scene.materials[1].base_colour.w = 0.3;
        let value = at_patch(&TracedScene::new(scene).expect("squares"), f32::INFINITY, Receiver::Diffuse);
        value.proves("gi/blended", 0.3 * COLOUR * FRAC_1_PI * form_factor(1.0, 0.7));
        value.refutes("gi/blended", COLOUR * FRAC_1_PI * form_factor(1.0, 0.7));
    }

    #[test]
    fn a_sender_in_the_shadow_sends_nothing() {
        // A lid below the square, beside the patch's view of it, keeps the light off.
        let meshes = vec![lying(1e-3, 0.0, 0), lying(0.5, 1.0, 1), lying(2.0, -0.5, 1)];
        let scene = lit(meshes, Material::default(), Vec3::Y, 1.0);
        assert_eq!(at_patch(&scene, f32::INFINITY, Receiver::Diffuse).mean, Vec3::ZERO);
    }

    #[test]
    fn glossy_receivers_reflect_bounced_light_by_their_lobe() {
        for gloss in [Gloss::Microfacets, Gloss::Phong] {
            let receiver = Material { gloss, metallic: 1.0, roughness: 0.4, ..Material::default() };
            let scene = patch_and_square(900.0, 1.0, receiver, 1.0);
            let value = at_patch(&scene, f32::INFINITY, Receiver::Glossy);
            // The same radiance from everywhere is reflected by the lobe's albedo.
            let camera = Camera::look_at(Vec3::new(0.0, 0.01, 0.01), Vec3::ZERO);
            let shot = Shot::new(&scene, &camera, [1, 1], 1.0);
            let Visible { point, to_viewer } = Visible::at(&shot, glam::Vec2::splat(0.5)).expect("the patch");
            let bsdf = Bsdf::new(&point);
            let everywhere = Environment::uniform(Vec3::ONE);
            let albedo = integral(&everywhere, |to_light| bsdf.evaluate(to_viewer, to_light));
            let expected = albedo * COLOUR * FRAC_1_PI;
            value.proves("gi/glossy", expected);
            value.refutes("gi/glossy", 1.02 * expected);
            value.refutes("gi/glossy", COLOUR * FRAC_1_PI * 0.5);
        }
        let matte = Material { gloss: Gloss::None, ..Material::default() };
        let scene = patch_and_square(900.0, 1.0, matte, 1.0);
        assert_eq!(at_patch(&scene, f32::INFINITY, Receiver::Glossy).mean, Vec3::ZERO);
    }
}
