//! Truth for phosphorescence, the effect `phosphor`: the radiance of what the surface that is seen gives back of light
//! that it kept (thesis, equation 8.3).
//!
//! What excites it is direct light of lamps without an extent, on either side of the surface: what keeps light is a layer
//! without sides. Shadows are those of rays; lamps are switched at their exact moments, and between them each state moves by
//! its closed form ([`Scheme::Exact`](crate::phosphor::rate::Scheme)), for which steps of any fineness are the same. The
//! scene stays as it is at the moment that is shown: where something moves, a sequence of frames has what this has not.
//! Light that reached a lamp-lit place by a detour, phosphorescent light included, excites nothing and is not shown.
//!
//! Light falls on the mesh as its vertices' normals have it; normal maps change nothing.

use super::lights::Arrival;
use super::sampler::{PixelSampler, Stream};
use super::{Footprint, Integrator, Shot};
use crate::bvh::{Hit, TracedScene, corner_weights};
use crate::intersection::clearance;
use crate::phosphor::paint::{Lit, MOST_STATES};
use crate::scene::glow::Piece;
use crate::scene::{Glow, Mesh};
use glam::{Vec2, Vec3};

/// What a scene's surfaces give back at a moment.
#[derive(Debug)]
pub struct Afterglow<'a> {
    scene: &'a TracedScene,
    glow: &'a Glow,
    /// Of each material.
    paints: Vec<Option<usize>>,
    past: Vec<Piece>,
}

/// A point of a mesh as light falls on it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// World space, metres.
    pub position: Vec3,
    /// Of the triangle.
    pub geometric_normal: Vec3,
    /// As the vertices have it, on the side of the geometric one.
    pub normal: Vec3,
    clearance: f32,
}

impl Place {
    /// The point of a triangle with these weights of its corners.
    pub fn new(mesh: &Mesh, triangle: usize, weights: [f32; 3]) -> Self {
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners;
        let geometric_normal = (b - a).cross(c - a).normalize_or_zero();
        let of_vertex = |vertex: u32| mesh.normals.get(vertex as usize).copied().unwrap_or(Vec3::ZERO);
        let normals = mesh.triangles[triangle].map(of_vertex);
        let smooth: Vec3 = normals.into_iter().zip(weights).map(|(normal, weight)| normal * weight).sum();
        let smooth = smooth.normalize_or(geometric_normal);
        Self {
            position: a + (b - a) * weights[1] + (c - a) * weights[2],
            geometric_normal,
            normal: if smooth.dot(geometric_normal) < 0.0 { -smooth } else { smooth },
            clearance: clearance(corners),
        }
    }
}

impl<'a> Afterglow<'a> {
    /// Of a scene at the moment of its [`Glow`].
    pub fn new(scene: &'a TracedScene) -> Self {
        let glow = Glow::of(scene.scene());
        Self { scene, glow, paints: glow.paints_of(scene.scene()), past: glow.past(glow.moment) }
    }

    /// Irradiance of the lamps of each schedule when they shine, on both sides of a surface together, W/m², RGB.
    pub fn irradiance(&self, place: &Place) -> Vec<Vec3> {
        let mut received = vec![Vec3::ZERO; self.glow.schedules.len()];
        let scene = self.scene.scene();
        for (index, light) in scene.lights.iter().enumerate() {
            let Arrival { direction, distance, irradiance } = Arrival::new(scene, light, place.position);
            let side = place.geometric_normal.dot(direction).signum();
            let cosine = side * place.normal.dot(direction);
            if cosine <= 0.0 || irradiance == Vec3::ZERO {
                continue;
            }
            let origin = place.position + side * place.geometric_normal * place.clearance;
            let shown = self.scene.let_through(origin, direction, distance);
            received[self.glow.schedule_of(index)] += irradiance * cosine * shown;
        }
        received
    }

    /// The excited share of each state at a point of a mesh; nothing where it keeps no light.
    pub fn shares(&self, mesh: &Mesh, triangle: usize, weights: [f32; 3]) -> Option<[f32; MOST_STATES]> {
        let paint = self.paints[mesh.material.0 as usize]?;
        let received = self.irradiance(&Place::new(mesh, triangle, weights));
        let lit = |piece: &Piece| Lit {
            seconds: piece.seconds,
            irradiance: piece.on.iter().zip(&received).filter(|(on, _)| **on).map(|(_, light)| *light).sum(),
        };
        Some(self.glow.surfaces[paint].1.after(self.glow.before(), self.past.iter().map(lit)))
    }

    /// The radiance that a surface gives back where a ray met it.
    pub fn emission(&self, hit: &Hit) -> Vec3 {
        let mesh = &self.scene.scene().meshes[hit.mesh as usize];
        let shares = self.shares(mesh, hit.triangle as usize, corner_weights(hit.barycentric));
        let paint = self.paints[mesh.material.0 as usize];
        paint.zip(shares).map_or(Vec3::ZERO, |(paint, shares)| self.glow.surfaces[paint].1.emission(&shares))
    }
}

/// The integrator.
#[derive(Debug)]
pub struct Phosphor<'a> {
    shot: Shot<'a>,
    afterglow: Afterglow<'a>,
}

impl<'a> Phosphor<'a> {
    /// What the shot's scene gives back.
    pub fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot, afterglow: Afterglow::new(shot.scene) }
    }

    fn seen(&self, at: Vec2) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let hit = scene.hit(camera.position, camera.direction(at, height, width), f32::INFINITY);
        hit.map_or(Vec3::ZERO, |hit| self.afterglow.emission(&hit))
    }
}

impl Integrator for Phosphor<'_> {
    fn sample(&self, at: Vec2, _: &mut Stream) -> Vec3 {
        self.seen(at)
    }

    /// A pixel's middle shows the same to all samples.
    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        if shot.footprint == Footprint::Box {
            return super::mean_of_samples(self, shot, x, y, sampler, count);
        }
        self.seen(Vec2::new(x as f32 + 0.5, y as f32 + 0.5))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::FullPath;
    use crate::path::proving::{Measured, quad};
    use crate::scene::glow::Start;
    use crate::scene::glow::tests::glow;
    use crate::scene::{Camera, Gloss, Light, Material, MaterialId, Scene};
    use std::sync::Arc;

    /// A square of 2 m at z = 0 under a lamp of 8 W/sr at a distance of 2 m, of which only the middle is asked.
    fn square(glow: Glow, more: Vec<Mesh>) -> TracedScene {
        let corners = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let lamp =
            Light::Point { position: Vec3::Z * 2.0, intensity: Vec3::splat(8.0), range: f32::INFINITY };
        TracedScene::new(Scene {
            meshes: [vec![quad(corners)], more].concat().into(),
            materials: vec![Material::matte("wall", Vec3::splat(0.5))],
            lights: vec![lamp],
            glow: Some(Arc::new(glow)),
            ..Scene::default()
        })
        .expect("a square")
    }

    /// What its middle sends to somebody in front of it, or behind.
    fn middle(scene: &TracedScene, eye: Vec3) -> Vec3 {
        let camera = Camera::look_at(eye, Vec3::ZERO);
        let shot = Shot::new(scene, &camera, [1, 1], f32::INFINITY);
        let phosphor = Phosphor::new(&shot);
        phosphor.pixel(&shot, 0, 0, PixelSampler::new(0, 0, 0), 1)
    }

    const EYE: Vec3 = Vec3::new(0.1, 0.2, 1.0);

    #[test]
    fn light_that_was_on_for_a_while_decays_as_the_closed_form_says() {
        let (on, off) = (1.5f32, 2.25f32);
        let decays = [0.6f32, 0.05];
        let scene = square(glow(&decays, &[[0.0, on]], on + off), vec![]);
        // 8 W/sr at 2 m; only red excites, at a rate of 0.4.
        let charge = 0.4 * 2.0;
        let share = |decay: f32| {
            let total = charge + decay;
            charge / total * (1.0 - (-total * on).exp()) * (-decay * off).exp()
        };
        let sent: f32 = decays.iter().map(|decay| decay * share(*decay)).sum();
        let expected = Vec3::new(1.0, 0.5, 0.25) * sent;
        for eye in [EYE, -EYE] {
            let found = middle(&scene, eye);
            assert!((found - expected).abs().max_element() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn a_shadow_keeps_a_place_dark_and_long_light_is_the_equilibrium() {
        let mut lit = glow(&[0.2], &[], 0.0);
        lit.start = Start::LitForLong;
        let found = middle(&square(lit.clone(), vec![]), EYE).x;
        assert!((found - 0.2 * 0.8 / (0.8 + 0.2)).abs() < 1e-6, "{found}");
        let corners = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 1.5));
        assert_eq!(middle(&square(lit, vec![quad(corners)]), EYE), Vec3::ZERO);
    }

    /// A small patch without paint that looks at a square of half an edge `half` above it, which glows.
    fn reflected(start: f32, moment: f32) -> Measured {
        let corners = |half: f32, y: f32| {
            [(-1., 1.), (1., 1.), (1., -1.), (-1., -1.)].map(|(x, z)| Vec3::new(half * x, y, half * z))
        };
        let mut kept = glow(&[0.3], &[[0.0, 1.0]], moment);
        (kept.start, kept.surfaces[0].0) = (Start::Share(start), Some("sender".to_owned()));
        let sender = Mesh { material: MaterialId(1), ..quad(corners(1.0, 0.7)) };
        let matte = |name, grey| Material { gloss: Gloss::None, ..Material::matte(name, Vec3::splat(grey)) };
        let scene = TracedScene::new(Scene {
            meshes: vec![quad(corners(1e-3, 0.0)), sender].into(),
            materials: vec![matte("patch", 0.5), matte("sender", 0.0)],
            lights: vec![Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None }],
            glow: Some(Arc::new(kept)),
            ..Scene::default()
        });
        let scene = scene.expect("squares");
        let camera = Camera::look_at(Vec3::new(0.0, 0.01, 0.01), Vec3::ZERO);
        let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
        Measured::of(&FullPath::new(&shot), &shot, 4096)
    }

    #[test]
    fn kept_light_lights_other_surfaces_once_the_lamp_is_off() {
        // Four corners of `(2 pi)^-1 2 A atan A` with A = (a / h) / sqrt(1 + (a / h)^2) each (Howell's catalogue, B-3).
        let ratio = 1.0f32 / 0.7;
        let part = ratio / (1.0 + ratio * ratio).sqrt();
        let factor = 4.0 / std::f32::consts::PI * part * part.atan();
        let expected = |share: f32| Vec3::new(1.0, 0.5, 0.25) * 0.3 * share * 0.5 * factor;
        // From full, in light from behind at the sender's rate of 0.4 for a second, then in the dark.
        let lit = 0.4 / 0.7 + (1.0 - 0.4 / 0.7) * (-0.7f32).exp();
        let dark = lit * (-0.3f32 * 2.0).exp();
        reflected(1.0, 3.0).proves("phosphor/reflected", expected(dark));
        reflected(1.0, 3.0).refutes("phosphor/reflected", expected(1.02 * dark));
        assert_eq!(reflected(0.0, 0.0).mean, Vec3::ZERO, "the lamp is behind the sender");
    }

    #[test]
    fn what_has_no_paint_is_dark() {
        let mut other = glow(&[0.2], &[[0.0, 9.0]], 1.0);
        other.surfaces[0].0 = Some("floor".to_owned());
        assert_eq!(middle(&square(other, vec![]), EYE), Vec3::ZERO);
    }
}
