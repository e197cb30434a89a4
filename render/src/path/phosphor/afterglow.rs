//! The excited shares of surfaces at any point, by the light of lamps in all of the past.

use super::sky::Sky;
use crate::bvh::{Hit, TracedScene, corner_weights};
use crate::intersection::{Start, blended};
use crate::path::lights::Arrival;
use crate::sampler::Stream;
use crate::scene::glow::{FOR_LONG, Piece};
use crate::scene::{Glow, Mesh};
use deepshade_glow::paint::{LightInterval, MOST_STATES, Paint, Steps};
use glam::Vec3;
use std::borrow::Cow;
use std::sync::Arc;

/// What a scene's surfaces give back at a moment.
#[derive(Clone, Debug)]
pub struct Afterglow<'a> {
    pub(super) scene: &'a TracedScene,
    pub(super) glow: &'a Glow,
    /// Of each material.
    paints: Arc<[Option<usize>]>,
    /// Poses of the past, with the time for which each stands, cut where lamps are switched.
    past: Arc<[(&'a TracedScene, Vec<Piece>)]>,
    /// The environment, where anything keeps its light.
    sky: Option<Sky<'a>>,
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
            paints: glow.paints_of(scene.scene()).into(),
            past: poses(scene, glow).into(),
            sky: Sky::of(scene.scene(), glow),
            steps: Steps::EXACT,
        }
    }

    /// The same by other steps for each time in which no lamp is switched.
    #[must_use]
    pub fn by(self, steps: Steps) -> Self {
        Self { steps, ..self }
    }

    /// The same by the lamps that stand for the environment in methods.
    #[must_use]
    pub fn by_lamps(self) -> Self {
        Self { sky: self.sky.map(Sky::by_lamps), ..self }
    }

    /// One sample of it, of many: with the environment from few directions, each time others.
    pub fn sampled(&self, stream: &mut Stream) -> Cow<'_, Self> {
        match &self.sky {
            Some(sky) => Cow::Owned(Self { sky: Some(sky.sampled(stream.next_2d())), ..self.clone() }),
            None => Cow::Borrowed(self),
        }
    }

    /// Whether samples differ.
    pub const fn varies(&self) -> bool {
        self.sky.is_some()
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
        for (schedule, arrival) in self.arrivals(traced, place.position) {
            let Arrival { direction, distance, irradiance } = arrival;
            let side = place.geometric_normal.dot(direction).signum();
            let cosine = side * place.normal.dot(direction);
            let is_behind = eye.is_some_and(|eye| side * place.geometric_normal.dot(eye) <= 0.0);
            if cosine <= 0.0 || is_behind || irradiance == Vec3::ZERO {
                continue;
            }
            let origin = place.start.above(side * place.geometric_normal);
            let shown =
                traced.let_through(origin, direction, distance) * passed(traced, origin, direction, distance);
            received[schedule] += irradiance * cosine * shown;
        }
        received
    }

    /// What would arrive at a point if nothing were in between, of each lamp and of the environment, with the
    /// schedule that it follows.
    fn arrivals(&self, traced: &TracedScene, point: Vec3) -> impl Iterator<Item = (usize, Arrival)> {
        let scene = traced.scene();
        let lamps = scene.lights.iter().enumerate();
        let lamps = lamps
            .map(move |(index, light)| (self.glow.schedule_of(index), Arrival::new(scene, light, point)));
        lamps.chain(
            self.sky
                .iter()
                .flat_map(|sky| sky.arrivals().into_iter().map(move |arrival| (sky.schedule, arrival))),
        )
    }

    /// The light that a point of a mesh got, from the beginning on.
    pub fn history(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Vec<LightInterval> {
        self.history_on((mesh, triangle), weights, None)
    }

    /// The same on the side that is seen from somewhere, metres.
    pub fn history_seen_from(
        &self,
        eye: Vec3,
        (mesh, triangle): (usize, usize),
        weights: [f32; 3],
    ) -> Vec<LightInterval> {
        self.history_on((mesh, triangle), weights, Some(eye))
    }

    fn history_on(
        &self,
        (mesh, triangle): (usize, usize),
        weights: [f32; 3],
        eye: Option<Vec3>,
    ) -> Vec<LightInterval> {
        let mut history = Vec::new();
        for (pose, pieces) in self.past.iter() {
            let shines = pieces.iter().any(|piece| piece.on.contains(&true));
            let received = || {
                let place = ReceivingPoint::new(&pose.scene().meshes[mesh], triangle, weights);
                self.irradiance_in(pose, &place, eye.map(|eye| eye - place.position))
            };
            let received = if shines { received() } else { Vec::new() };
            let lit =
                |piece: &Piece| LightInterval { seconds: piece.seconds, irradiance: piece.light(&received) };
            history.extend(pieces.iter().map(lit));
        }
        history
    }

    /// The excited share of each state at a point of a mesh; nothing where it keeps no light.
    pub fn shares(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Option<[f32; MOST_STATES]> {
        let paint = self.paint_at(mesh, triangle, weights)?;
        Some(self.after(&paint, self.history(mesh, triangle, weights)))
    }

    /// The paint at a point of a mesh; none where it keeps no light.
    pub fn paint_at(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Option<Cow<'a, Paint>> {
        let mesh = &self.scene.scene().meshes[mesh];
        let surface = &self.glow.surfaces[self.paints[mesh.material.0 as usize]?];
        Some(surface.paint_at(mesh, triangle, weights))
    }

    /// The excited share of each state at a point of the medium, whose paint it has: what excites it is all
    /// direct light that goes through there.
    pub fn shares_in_medium(&self, point: Vec3, paint: &Paint) -> [f32; MOST_STATES] {
        let mut history = Vec::new();
        for (pose, pieces) in self.past.iter() {
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
        for (schedule, Arrival { direction, distance, irradiance }) in self.arrivals(traced, point) {
            let shown =
                traced.let_through(point, direction, distance) * passed(traced, point, direction, distance);
            received[schedule] += irradiance * shown;
        }
        received
    }

    /// The radiance that a surface gives back where a ray met it.
    pub fn emission(&self, hit: &Hit) -> Vec3 {
        self.emission_at(hit.mesh as usize, hit.triangle as usize, corner_weights(hit.barycentric))
    }

    /// The radiance that a point of a mesh gives back.
    pub fn emission_at(&self, mesh: usize, triangle: usize, weights: [f32; 3]) -> Vec3 {
        let Some(paint) = self.paint_at(mesh, triangle, weights) else { return Vec3::ZERO };
        paint.emission(&self.after(&paint, self.history(mesh, triangle, weights)))
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
