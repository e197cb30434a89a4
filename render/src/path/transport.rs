//! Path tracing: light carried from where it is emitted to the eye, over any number of surfaces and through
//! the medium.
//!
//! At each vertex of a path, a light is sampled and looked at directly (next event estimation), and the path
//! goes on in a direction sampled from the reflectance or the phase function, which may meet a light too.
//! Both ways of finding the same light are weighed by the power heuristic (Veach 1997, 9.2.2). From the fifth
//! vertex on, paths that carry little end by Russian roulette, which keeps the mean. Blended surfaces are
//! there with the probability of their opacity for paths and let their share through to lights
//! ([`crate::bvh`]), so that every pixel converges. So do smooth panes of glass, tinted: what goes straight
//! on through them is no vertex. What a body of glass absorbs is lost on the ways between its surfaces;
//! bodies within bodies end one another. Light of a [`Route`] takes all surfaces for opaque.

use super::bsdf::Straight;
use super::lights::{LightSample, Lights, LightsAt};
use super::medium::{Flight, Media, Segment};
use super::phosphor::Afterglow;
use super::route::{Route, Vertices};
use super::vertex::Vertex;
use crate::bvh::{Hit, TracedScene};
use crate::intersection::SurfacePoint;
use crate::sampler::Stream;
use crate::scene::Material;
use glam::Vec3;

/// Vertices of a path that are never cut short.
const SURE_VERTICES: u32 = 4;

/// Most likely to go on: a path between white walls ends all the same.
const LARGEST_SURVIVAL: f32 = 0.95;

/// How light is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Finding {
    /// Both ways, weighed.
    #[default]
    Both,
    /// By sampling lights alone, but for what the eye sees itself.
    Lights,
    /// By sampling reflectances and phase functions alone, but for lights without an extent.
    Paths,
}

/// A scene ready for path tracing.
#[derive(Debug)]
pub struct Transport<'a> {
    scene: &'a TracedScene,
    lights: Lights<'a>,
    /// What surfaces give back of light that they kept, where the scene says that they do.
    afterglow: Option<Afterglow<'a>>,
    media: Media<'a>,
    /// Most vertices of a path.
    most_vertices: u32,
    finding: Finding,
    /// Whether light may pass a surface without being bent.
    panes: bool,
    /// The only route that light is wanted of; `None` for all.
    wanted: Option<Route>,
}

/// Radiance that reaches the eye, by how often it was reflected or scattered on the way, RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Split {
    /// Not at all: emission of what is seen, or of the environment.
    pub emitted: Vec3,
    /// Once: direct light.
    pub direct: Vec3,
    /// Twice: the first indirect bounce.
    pub first_indirect: Vec3,
    /// More often.
    pub rest: Vec3,
}

impl Split {
    /// All of it.
    pub fn total(&self) -> Vec3 {
        self.emitted + self.direct + self.first_indirect + self.rest
    }

    /// The part of paths with some number of vertices.
    const fn part(&mut self, vertices: u32) -> &mut Vec3 {
        match vertices {
            0 => &mut self.emitted,
            1 => &mut self.direct,
            2 => &mut self.first_indirect,
            _ => &mut self.rest,
        }
    }
}

/// The last edge of a path, towards the light.
struct Edge<'a> {
    /// Behind the last pane.
    origin: Vec3,
    /// Unit vector.
    direction: Vec3,
    /// How far it has come from its vertex through panes, metres.
    passed: f32,
    /// What a metre takes, of each colour.
    absorption: Vec3,
    /// With which density the direction was sampled, per steradian, and the lights that the vertex sampled
    /// too; `None` from the eye, and from vertices whose light is not wanted.
    sampled: Option<(f32, LightsAt<'a>)>,
}

impl<'a> Transport<'a> {
    /// Transport without a limit to the number of bounces.
    pub fn new(scene: &'a TracedScene) -> Self {
        Self {
            scene,
            lights: Lights::new(scene),
            afterglow: scene.scene().glow.is_some().then(|| Afterglow::new(scene)),
            media: Media::of(scene),
            most_vertices: u32::MAX,
            finding: Finding::Both,
            panes: scene.scene().materials.iter().any(Material::may_pass_light_straight),
            wanted: None,
        }
    }

    /// Only light that was reflected or scattered at most that often: 0 leaves what is emitted towards the
    /// eye, 1 direct light.
    #[must_use]
    pub fn with_bounces(self, most: u32) -> Self {
        Self { most_vertices: most, ..self }
    }

    /// Light found in one way only, to measure what the other is good for.
    #[must_use]
    pub fn with_finding(self, finding: Finding) -> Self {
        Self { finding, ..self }
    }

    /// Only light that took a route. It is looked for where it can be: paths that cannot become it end, and
    /// do not pass by the medium where it must be met.
    #[must_use]
    pub fn with_route(self, wanted: Route) -> Self {
        Self { wanted: Some(wanted), panes: false, ..self }
    }

    /// One sample of the radiance that arrives at `origin` against a unit direction, split.
    pub fn split(&self, origin: Vec3, direction: Vec3, stream: &mut Stream) -> Split {
        let mut split = Split::default();
        self.trace(origin, direction, stream, |vertices, light| *split.part(vertices.count()) += light);
        split
    }

    /// One sample of the radiance that arrives at `origin` against a unit direction.
    pub fn radiance(&self, origin: Vec3, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let mut sum = Vec3::ZERO;
        self.trace(origin, direction, stream, |_, light| sum += light);
        sum
    }

    /// One path from the eye. `found` gets every piece of light that it finds, with the vertices that the
    /// light met: the sum of all is one sample of the radiance.
    pub fn trace(
        &self,
        origin: Vec3,
        direction: Vec3,
        stream: &mut Stream,
        mut found: impl FnMut(Vertices, Vec3),
    ) {
        let mut edge = Edge { origin, direction, passed: 0.0, absorption: Vec3::ZERO, sampled: None };
        let (mut throughput, mut vertices) = (Vec3::ONE, Vertices::default());
        loop {
            let hit = self.hit(&edge, stream);
            let length = hit.map_or(f32::INFINITY, |hit| hit.distance);
            let segment = Segment { origin: edge.origin, direction: edge.direction, length };
            if let Some(afterglow) = self.afterglow.as_ref().filter(|_| self.wants(vertices)) {
                found(vertices, throughput * self.kept_by_medium(afterglow, &segment, stream));
            }
            let Flight { scattered, weight } = self.follow(vertices, &segment, throughput, stream);
            throughput *= weight * left_after(edge.absorption, scattered.unwrap_or(length));
            if throughput == Vec3::ZERO {
                return;
            }
            let vertex = match (scattered, &hit) {
                (Some(distance), _) => {
                    Vertex::medium(&self.media, segment.start_at(distance, self.scene), edge.direction)
                }
                (None, Some(hit)) => {
                    self.surface(SurfacePoint::new(self.scene, hit, edge.direction), edge.direction)
                }
                (None, None) => {
                    if self.wants(vertices) {
                        found(vertices, throughput * self.environment(&edge));
                    }
                    return;
                }
            };
            if let (Vertex::Surface { point, .. }, Some(hit), true) = (&vertex, &hit, self.wants(vertices)) {
                let kept = self.kept(hit, stream);
                found(vertices, throughput * (kept + self.emission(&edge, point, hit)));
            }
            if let Some(Straight { share, probability }) = vertex.straight() {
                if stream.next_1d() < probability {
                    throughput *= share / probability;
                    edge = Edge { origin: vertex.behind(), passed: edge.passed + length, ..edge };
                    continue;
                }
                throughput /= 1.0 - probability;
            }
            if vertices.count() == self.most_vertices {
                return;
            }
            vertices = vertices.then(&vertex);
            if self.wanted.is_some_and(|wanted| !vertices.lead_to(wanted)) {
                return;
            }
            let lights = self.wants(vertices).then(|| self.lights_at(&vertex));
            if let Some(lights) = &lights {
                found(vertices, throughput * self.lit(&vertex, edge.absorption, lights, stream));
            }
            let Some(next) = vertex.sample(stream) else { return };
            throughput *= next.weight;
            if vertices.count() > SURE_VERTICES && !survives(&mut throughput, stream) {
                return;
            }
            edge = Edge {
                origin: vertex.ray_origin_towards(next.direction),
                direction: next.direction,
                passed: 0.0,
                absorption: vertex.absorption_towards(next.direction, edge.absorption),
                sampled: lights.map(|lights| (next.density, lights)),
            };
        }
    }

    /// Whether light that these vertices look at is wanted.
    fn wants(&self, vertices: Vertices) -> bool {
        self.wanted.is_none_or(|wanted| vertices.route() == wanted)
    }

    /// Where light goes along a segment: where the wanted route says, or at random if it says nothing.
    fn follow(&self, vertices: Vertices, segment: &Segment, throughput: Vec3, stream: &mut Stream) -> Flight {
        match self.wanted {
            None | Some(Route::Multiple) => self.media.flight(segment, throughput, stream),
            Some(Route::Direct) if vertices.count() == 0 => {
                self.media.scattering_of_lamps(&self.scene.scene().lights, segment, throughput, stream)
            }
            Some(Route::Indirect) if vertices.count() == 0 => {
                self.media.scattering(segment, throughput, stream)
            }
            Some(_) => Flight::passed(self.media.transmittance(segment, stream)),
        }
    }

    /// The surface at an edge's end.
    fn hit(&self, edge: &Edge<'_>, stream: &mut Stream) -> Option<Hit> {
        self.scene.hit_by_chance(edge.origin, edge.direction, f32::INFINITY, || stream.next_1d())
    }

    /// A vertex on a surface.
    fn surface(&self, point: SurfacePoint, direction: Vec3) -> Vertex {
        match self.wanted {
            None => Vertex::surface(point, direction),
            Some(_) => Vertex::opaque(point, direction),
        }
    }

    /// The lights from a vertex.
    fn lights_at(&self, vertex: &Vertex) -> LightsAt<'_> {
        match vertex {
            Vertex::Surface { bsdf, .. } if bsdf.looks_below_horizon() => self.lights.at(vertex.ray_origin()),
            Vertex::Surface { point, .. } => self.lights.at_surface(point),
            Vertex::Medium { point, .. } => self.lights.at(*point),
        }
    }

    /// Light of one light, sampled, that a vertex turns to the vertex before, from where a metre takes
    /// `absorption`.
    fn lit(&self, vertex: &Vertex, absorption: Vec3, lights: &LightsAt<'_>, stream: &mut Stream) -> Vec3 {
        let Some(light) = lights.sample(stream) else { return Vec3::ZERO };
        let LightSample { direction, distance, radiance, density } = light;
        let weight = match (density, self.finding) {
            (None, _) | (_, Finding::Lights) => 1.0,
            (_, Finding::Paths) => return Vec3::ZERO,
            (Some(density), Finding::Both) => power_heuristic(density, vertex.density(direction)),
        };
        let turned = vertex.evaluate(direction) * radiance * weight;
        if turned == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let segment = towards(vertex, direction, distance);
        let let_through = self.let_through(&segment);
        if let_through == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let left = left_after(vertex.absorption_towards(direction, absorption), segment.length);
        turned * let_through * left * self.media.transmittance(&segment, stream)
    }

    /// Share of light that surfaces let through on the way to a light.
    fn let_through(&self, &Segment { origin, direction, length }: &Segment) -> Vec3 {
        if !self.panes {
            return Vec3::splat(self.scene.let_through(origin, direction, length));
        }
        self.scene.let_through_tinted(origin, direction, length, |hit| {
            let point = SurfacePoint::new(self.scene, hit, direction);
            self.surface(point, direction).straight().map_or(Vec3::ZERO, |straight| straight.share)
        })
    }

    /// Light of the environment at the end of an edge, weighed.
    fn environment(&self, edge: &Edge<'_>) -> Vec3 {
        let radiance = self.lights.environment(edge.direction);
        if radiance == Vec3::ZERO {
            return radiance;
        }
        radiance * self.weight(edge, |lights| lights.density_of_environment(edge.direction))
    }

    /// Light that the medium on a segment kept: nothing but paths finds it.
    fn kept_by_medium(&self, afterglow: &Afterglow<'_>, segment: &Segment, stream: &mut Stream) -> Vec3 {
        if !afterglow.is_in_medium() {
            return Vec3::ZERO;
        }
        let number = stream.next_1d();
        afterglow
            .sampled(stream)
            .of_medium(segment, number, |before| self.media.transmittance(before, stream))
    }

    /// What a surface gives back of light that it kept: nothing but paths finds it.
    fn kept(&self, hit: &Hit, stream: &mut Stream) -> Vec3 {
        self.afterglow.as_ref().map_or(Vec3::ZERO, |afterglow| afterglow.sampled(stream).emission(hit))
    }

    /// Emission of a surface at the end of an edge, weighed.
    fn emission(&self, edge: &Edge<'_>, point: &SurfacePoint, hit: &Hit) -> Vec3 {
        let emission = point.surface.emission;
        if emission == Vec3::ZERO {
            return emission;
        }
        let hit = Hit { distance: hit.distance + edge.passed, ..*hit };
        emission * self.weight(edge, |lights| lights.density_of_hit(edge.direction, &hit))
    }

    /// How much light that an edge met counts, which is sampled among the lights with the density of
    /// `sampled`.
    fn weight(&self, edge: &Edge<'_>, sampled: impl Fn(&LightsAt<'_>) -> f32) -> f32 {
        match (&edge.sampled, self.finding) {
            (None, _) | (_, Finding::Paths) => 1.0,
            (Some((density, lights)), Finding::Both) => power_heuristic(*density, sampled(lights)),
            (Some((_, lights)), Finding::Lights) => f32::from(sampled(lights) == 0.0),
        }
    }
}

/// The way to a light that was sampled from a vertex's viewer's side.
fn towards(vertex: &Vertex, direction: Vec3, length: f32) -> Segment {
    let (sampled_from, origin) = (vertex.ray_origin(), vertex.ray_origin_towards(direction));
    if origin == sampled_from || length == f32::INFINITY {
        return Segment { origin, direction, length };
    }
    let way = sampled_from + direction * length - origin;
    Segment { origin, direction: way / way.length(), length: way.length() }
}

/// Share of light that a way through what absorbs it leaves, for each colour.
fn left_after(absorption: Vec3, length: f32) -> Vec3 {
    absorption.map(|each| if each == 0.0 { 1.0 } else { (-each * length).exp() })
}

/// Weight of light that was found with a density and could have been found with another (Veach 1997, 9.2.2).
pub fn power_heuristic(density: f32, other: f32) -> f32 {
    let ratio = other / density;
    1.0 / (1.0 + ratio * ratio)
}

/// Russian roulette: ends a path that carries little, and makes up for it where it does not.
fn survives(throughput: &mut Vec3, stream: &mut Stream) -> bool {
    let survival = throughput.max_element().min(LARGEST_SURVIVAL);
    if stream.next_1d() >= survival {
        return false;
    }
    *throughput /= survival;
    true
}

#[cfg(test)]
mod tests;
