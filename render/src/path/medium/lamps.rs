//! Distances on a ray in proportion to what lamps would send there through empty space. A lamp in fog lights
//! the ray by the inverse square of the distance between them: distances drawn by transmittance alone meet
//! the brightest part so rarely that the relative variance is the length of the ray over 2 pi times the
//! lamp's distance from it. Drawn so that the angle under which the lamp sees them is uniform, they bring the
//! same light each (Kulla and Fajardo 2012, "Importance sampling techniques for path tracing in participating
//! media").
//!
//! Lamps are points and spots; cones, ranges and shadows are left to the light that is found at the distance.

use super::Segment;
use crate::scene::Light;

/// Nearer lamps than this, metres, count as that far aside.
const NEAREST: f64 = 1e-6;

/// The lamps beside a part of a segment; at least one that shines.
pub(super) struct Lamps<'a> {
    lights: &'a [Light],
    segment: Segment,
    /// From which distance to which.
    span: [f64; 2],
    /// What all of them together send to the part.
    total: f64,
}

/// One lamp, seen from the segment.
struct Lamp {
    /// Mean intensity of the colours.
    intensity: f64,
    /// Distance along the segment where the lamp is nearest.
    foot: f64,
    /// How far aside it is there, metres.
    aside: f64,
    /// Under which angles it sees both ends of the part.
    angles: [f64; 2],
}

impl<'a> Lamps<'a> {
    /// Those of some lights; `None` where no lamp is among them.
    pub(super) fn beside(lights: &'a [Light], segment: &Segment, span: [f32; 2]) -> Option<Self> {
        let mut lamps = Self { lights, segment: *segment, span: span.map(f64::from), total: 0.0 };
        lamps.total = lamps.all().map(|lamp| lamp.sent()).sum();
        (lamps.total > 0.0).then_some(lamps)
    }

    /// A distance along the segment, from a uniform number.
    pub(super) fn distance(&self, at: f32) -> f32 {
        let mut left = f64::from(at) * self.total;
        let mut distance = self.span[0];
        for lamp in self.all() {
            let sent = lamp.sent();
            distance = lamp.distance((left / sent).min(1.0));
            left -= sent;
            if left < 0.0 {
                break;
            }
        }
        distance.clamp(self.span[0], self.span[1]) as f32
    }

    /// Density with which [`Lamps::distance`] takes a distance, 1/m.
    pub(super) fn density(&self, distance: f32) -> f32 {
        let arriving = |lamp: Lamp| {
            let along = f64::from(distance) - lamp.foot;
            lamp.intensity / (along * along + lamp.aside * lamp.aside)
        };
        (self.all().map(arriving).sum::<f64>() / self.total) as f32
    }

    fn all(&self) -> impl Iterator<Item = Lamp> {
        self.lights.iter().filter_map(|light| Lamp::new(light, &self.segment, self.span))
    }
}

impl Lamp {
    /// `None` of a light that is nowhere or dark.
    fn new(light: &Light, segment: &Segment, span: [f64; 2]) -> Option<Self> {
        let (Light::Point { position, intensity, .. } | Light::Spot { position, intensity, .. }) = *light
        else {
            return None;
        };
        if intensity.element_sum() <= 0.0 {
            return None;
        }
        let (to_lamp, direction) =
            (position.as_dvec3() - segment.origin.as_dvec3(), segment.direction.as_dvec3());
        let foot = to_lamp.dot(direction);
        let aside = to_lamp.cross(direction).length().max(NEAREST);
        let angles = span.map(|distance| ((distance - foot) / aside).atan());
        Some(Self { intensity: f64::from(intensity.element_sum()) / 3.0, foot, aside, angles })
    }

    /// Integral over the part of intensity over squared distance.
    fn sent(&self) -> f64 {
        self.intensity * (self.angles[1] - self.angles[0]) / self.aside
    }

    /// The distance that is seen under a share of the angle between both ends.
    fn distance(&self, share: f64) -> f64 {
        let [from, to] = self.angles;
        self.foot + self.aside * (from + share * (to - from)).tan()
    }
}
