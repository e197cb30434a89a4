//! The lights of a scene from one point: how likely each is to be chosen there, and the choice.

use super::{Arrival, LightSample, Lights, brightness};
use crate::bvh::Hit;
use crate::sampler::Stream;
use glam::{Vec2, Vec3};

/// How much is spread evenly over all lights that count, in parts of what is shared out by importance: a
/// fifth of all.
const EVEN: f32 = 0.25;

/// The lights of a scene from one point.
#[derive(Clone, Copy, Debug)]
pub struct LightsAt<'a> {
    lights: &'a Lights<'a>,
    point: Vec3,
    /// Normals that light is on the outer side of; `None` in the medium.
    horizon: Option<[Vec3; 2]>,
    importance: Importance,
}

/// How likely each kind of light is to be chosen, not normalised.
#[derive(Clone, Copy, Debug)]
struct Importance {
    /// Part of every light's, whatever arrives from it.
    even: f32,
    without_extent: f32,
    emitters: f32,
    environment: f32,
    total: f32,
}

impl<'a> LightsAt<'a> {
    /// From `point`, where the rays to the lights will start: off a surface, not on it.
    pub(super) fn new(lights: &'a Lights<'a>, point: Vec3, horizon: Option<[Vec3; 2]>) -> Self {
        let emitters = lights.emitters.as_ref().map_or(0.0, |emitters| emitters.importance(point));
        let environment = lights.environment_importance;
        let counts = |importance: f32| f32::from(importance > 0.0);
        let (mut without_extent, mut count) = (0.0, 0.0);
        for (_, importance) in arrivals(lights, point, horizon) {
            without_extent += importance;
            count += 1.0;
        }
        let all = count + counts(emitters) + counts(environment);
        let even = EVEN * (without_extent + emitters + environment) / all.max(1.0);
        let importance = Importance {
            even,
            without_extent: without_extent + count * even,
            emitters: emitters + counts(emitters) * even,
            environment: environment + counts(environment) * even,
            total: without_extent + emitters + environment + all * even,
        };
        Self { lights, point, horizon, importance }
    }

    /// One light, chosen at random; `None` where no light can shine on the point. Takes four numbers.
    pub fn sample(&self, stream: &mut Stream) -> Option<LightSample> {
        let (kind, which, square) = (stream.next_1d(), stream.next_1d(), stream.next_2d());
        let Importance { without_extent, emitters, total, .. } = self.importance;
        let left = kind * total;
        if left < without_extent {
            return self.sample_without_extent(left);
        }
        if left < without_extent + emitters {
            return self.sample_emitters(which, square);
        }
        self.sample_environment(square)
    }

    /// Density per steradian with which [`LightsAt::sample`] takes the direction in which a ray from the
    /// point met an emissive triangle; 0 where that does not emit.
    pub fn density_of_hit(&self, direction: Vec3, hit: &Hit) -> f32 {
        let Some(emitters) = &self.lights.emitters else { return 0.0 };
        emitters.density(self.lights.scene.scene(), direction, hit) * self.share(self.importance.emitters)
    }

    /// Density per steradian with which [`LightsAt::sample`] takes a direction for the environment.
    pub fn density_of_environment(&self, direction: Vec3) -> f32 {
        let Some(environment) = self.lights.environment else { return 0.0 };
        environment.density(direction) * self.share(self.importance.environment)
    }

    /// The probability of what has some importance.
    fn share(&self, importance: f32) -> f32 {
        if importance > 0.0 { importance / self.importance.total } else { 0.0 }
    }

    /// The light without an extent at `left` of the total importance.
    fn sample_without_extent(&self, mut left: f32) -> Option<LightSample> {
        let mut chosen = None;
        for (arrival, importance) in arrivals(self.lights, self.point, self.horizon) {
            let importance = importance + self.importance.even;
            chosen = Some((arrival, importance));
            if left < importance {
                break;
            }
            left -= importance;
        }
        let (Arrival { direction, distance, irradiance }, importance) = chosen?;
        let radiance = irradiance / self.share(importance);
        Some(LightSample { direction, distance, radiance, density: None })
    }

    fn sample_emitters(&self, which: f32, square: Vec2) -> Option<LightSample> {
        let emitters = self.lights.emitters.as_ref()?;
        let sample = emitters.sample(self.lights.scene.scene(), self.point, which, square)?;
        let to_light = sample.position - self.point;
        let distance = to_light.length();
        let density = sample.density * self.share(self.importance.emitters);
        Some(LightSample {
            direction: to_light / distance,
            distance,
            radiance: sample.radiance / density,
            density: Some(density),
        })
    }

    fn sample_environment(&self, square: Vec2) -> Option<LightSample> {
        let share = self.share(self.importance.environment);
        let sample = self.lights.environment.filter(|_| share > 0.0)?.sample(square)?;
        let density = sample.density * share;
        Some(LightSample {
            direction: sample.direction,
            distance: f32::INFINITY,
            radiance: sample.radiance / density,
            density: Some(density),
        })
    }
}

/// What would arrive from each light without an extent that shines on a point, in order, and its importance:
/// irradiance on a surface that faces it.
fn arrivals(
    lights: &Lights<'_>,
    point: Vec3,
    horizon: Option<[Vec3; 2]>,
) -> impl Iterator<Item = (Arrival, f32)> {
    let scene = lights.scene.scene();
    let above = move |direction: Vec3| {
        horizon.is_none_or(|normals| normals.iter().all(|normal| normal.dot(direction) > 0.0))
    };
    scene
        .lights
        .iter()
        .zip(&lights.on)
        .filter(|(_, on)| **on)
        .map(move |(light, _)| Arrival::new(scene, light, point))
        .map(|arrival| (arrival, brightness(arrival.irradiance)))
        .filter(move |(arrival, importance)| *importance > 0.0 && above(arrival.direction))
}
