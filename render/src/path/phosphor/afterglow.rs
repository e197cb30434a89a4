//! The excited shares of surfaces at any point, by the light of lamps in all of the past.

use crate::bvh::{Hit, TracedScene, corner_weights};
use crate::intersection::{Start, blended};
use crate::path::lights::Arrival;
use crate::scene::glow::{FOR_LONG, Piece};
use crate::scene::{Glow, Mesh};
use deepshade_glow::paint::{LightInterval, MOST_STATES, Paint, Steps};
use glam::Vec3;

/// What a scene's surfaces give back at a moment.
#[derive(Debug)]
pub struct Afterglow<'a> {
    pub(super) scene: &'a TracedScene,
    pub(super) glow: &'a Glow,
    /// Of each material.
    paints: Vec<Option<usize>>,
    /// Poses of the past, with the time for which each stands, cut where lamps are switched.
    past: Vec<(&'a TracedScene, Vec<Piece>)>,
    steps: Steps,
}

/// A point of a mesh as light falls on it.
#[derive(Clone, Copy, Debug)]
pub struct ReceivingPoint {
    /// World space, metres.
    pub position: Vec3,
    /// Of the triangle.
    pub geometric_normal: Vec3,
    /// As the vertices have it, on the side of the geometric one.
    pub normal: Vec3,
    start: Start,
}

impl ReceivingPoint {
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
            position: blended(corners, weights),
            geometric_normal,
            normal: if smooth.dot(geometric_normal) < 0.0 { -smooth } else { smooth },
            start: Start::new(corners, weights, geometric_normal),
        }
    }
}

impl<'a> Afterglow<'a> {
    /// Of a scene at the moment of its [`Glow`].
    pub fn new(scene: &'a TracedScene) -> Self {
        let glow = Glow::of(scene.scene());
        Self {
            scene,
            glow,
            paints: glow.paints_of(scene.scene()),
            past: poses(scene, glow),
            steps: Steps::EXACT,
        }
    }

    /// The same by other steps for each time in which no lamp is switched.
    #[must_use]
    pub fn by(self, steps: Steps) -> Self {
        Self { steps, ..self }
    }

    /// Excited shares of a paint after all that happened.
    fn after(&self, paint: &Paint, history: Vec<LightInterval>) -> [f32; MOST_STATES] {
        // Light before the beginning is an equilibrium by any scheme.
        let steps =
            |lit: LightInterval| (lit, if lit.seconds >= FOR_LONG { Steps::EXACT } else { self.steps });
        paint.after_steps(self.glow.before(), history.into_iter().map(steps))
    }

    /// Irradiance of the lamps of each schedule when they shine, on both sides of a surface together, W/m²,
    /// RGB, in the scene as it is now.
    pub fn irradiance(&self, place: &ReceivingPoint) -> Vec<Vec3> {
        self.irradiance_in(self.scene, place, None)
    }

    /// The same on the side that is seen from a direction.
    pub fn irradiance_towards(&self, place: &ReceivingPoint, eye: Vec3) -> Vec<Vec3> {
        self.irradiance_in(self.scene, place, Some(eye))
    }

    fn irradiance_in(&self, traced: &TracedScene, place: &ReceivingPoint, eye: Option<Vec3>) -> Vec<Vec3> {
        let mut received = vec![Vec3::ZERO; self.glow.schedules.len()];
        // What has no area gets no light, though its vertices may have normals.
        if place.geometric_normal == Vec3::ZERO {
            return received;
        }
        let scene = traced.scene();
        for (index, light) in scene.lights.iter().enumerate() {
            let Arrival { direction, distance, irradiance } = Arrival::new(scene, light, place.position);
            let side = place.geometric_normal.dot(direction).signum();
            let cosine = side * place.normal.dot(direction);
            let is_behind = eye.is_some_and(|eye| side * place.geometric_normal.dot(eye) <= 0.0);
            if cosine <= 0.0 || is_behind || irradiance == Vec3::ZERO {
                continue;
            }
            let origin = place.start.above(side * place.geometric_normal);
            let shown =
                traced.let_through(origin, direction, distance) * passed(traced, origin, direction, distance);
            received[self.glow.schedule_of(index)] += irradiance * cosine * shown;
        }
        received
    }

    /// The light that a point of a mesh got, from the beginning on.
    pub fn history(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Vec<LightInterval> {
        let mut history = Vec::new();
        for (pose, pieces) in &self.past {
            let shines = pieces.iter().any(|piece| piece.on.contains(&true));
            let place = || ReceivingPoint::new(&pose.scene().meshes[mesh], triangle, weights);
            let received = if shines { self.irradiance_in(pose, &place(), None) } else { Vec::new() };
            let lit =
                |piece: &Piece| LightInterval { seconds: piece.seconds, irradiance: piece.light(&received) };
            history.extend(pieces.iter().map(lit));
        }
        history
    }

    /// The excited share of each state at a point of a mesh; nothing where it keeps no light.
    pub fn shares(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Option<[f32; MOST_STATES]> {
        let material = self.scene.scene().meshes[mesh].material;
        let paint = self.paints[material.0 as usize]?;
        let history = self.history(mesh, triangle, weights);
        Some(self.after(&self.glow.surfaces[paint].1, history))
    }

    /// The excited share of each state at a point of the medium, whose paint it has: what excites it is all
    /// direct light that goes through there.
    pub fn shares_in_medium(&self, point: Vec3, paint: &Paint) -> [f32; MOST_STATES] {
        let mut history = Vec::new();
        for (pose, pieces) in &self.past {
            let shines = pieces.iter().any(|piece| piece.on.contains(&true));
            let received = if shines { self.fluence_in(pose, point) } else { Vec::new() };
            let lit =
                |piece: &Piece| LightInterval { seconds: piece.seconds, irradiance: piece.light(&received) };
            history.extend(pieces.iter().map(lit));
        }
        self.after(paint, history)
    }

    /// What of the lamps of each schedule goes through a point, whatever its direction.
    fn fluence_in(&self, traced: &TracedScene, point: Vec3) -> Vec<Vec3> {
        let mut received = vec![Vec3::ZERO; self.glow.schedules.len()];
        let scene = traced.scene();
        for (index, light) in scene.lights.iter().enumerate() {
            let Arrival { direction, distance, irradiance } = Arrival::new(scene, light, point);
            let shown =
                traced.let_through(point, direction, distance) * passed(traced, point, direction, distance);
            received[self.glow.schedule_of(index)] += irradiance * shown;
        }
        received
    }

    /// The radiance that a surface gives back where a ray met it.
    pub fn emission(&self, hit: &Hit) -> Vec3 {
        self.emission_at(hit.mesh as usize, hit.triangle as usize, corner_weights(hit.barycentric))
    }

    /// The radiance that a point of a mesh gives back.
    pub fn emission_at(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Vec3 {
        let shares = self.shares(mesh, triangle, weights);
        let paint = self.paints[self.scene.scene().meshes[mesh].material.0 as usize];
        paint.zip(shares).map_or(Vec3::ZERO, |(paint, shares)| self.glow.surfaces[paint].1.emission(&shares))
    }
}

/// Points of a way to a lamp at which a grid is looked up.
const POINTS: u32 = 32;

/// What of light the medium lets through.
fn passed(traced: &TracedScene, origin: Vec3, direction: Vec3, distance: f32) -> Vec3 {
    let medium = traced.scene().medium.as_deref();
    medium.map_or(Vec3::ONE, |medium| medium.passed_share(origin, direction, distance, POINTS))
}

/// A scene's poses, each with the time for which it stands.
fn poses<'a>(scene: &'a TracedScene, glow: &Glow) -> Vec<(&'a TracedScene, Vec<Piece>)> {
    let poses = scene.past();
    let Some((first, _)) = poses.get(1) else {
        let only = poses.first().map_or(scene, |(_, pose)| pose);
        return vec![(only, glow.past(glow.moment))];
    };
    let mut past = vec![(&poses[0].1, glow.past(first.min(glow.moment)))];
    for (index, (from, pose)) in poses.iter().enumerate().skip(1) {
        let to = poses.get(index + 1).map_or(glow.moment, |(next, _)| next.min(glow.moment));
        past.push((pose, glow.between(*from, to)));
    }
    past
}
