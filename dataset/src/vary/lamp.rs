//! A point light drawn uniformly in a scene, of those places that light something of what is seen ("the position of the light source is sampled uniformly at random per
//! image", thesis 7.4).

use super::draw::{between, purpose};
use crate::random::uniform;
use crate::views;
use deepshade_render::bvh::TracedScene;
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::scene::{Camera, Light};
use deepshade_shaders::lists;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::PI;

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// Where it is, world space, metres.
    pub position: Vec3,
    /// Radiant intensity, W/sr, RGB.
    pub intensity: Vec3,
}

/// Places that are tried before the lamp goes where the camera is.
const ATTEMPTS: u64 = 256;
/// Least distance to a surface, as a share of the diagonal.
const LEAST_DISTANCE: f32 = 0.02;
/// Share of what the camera sees that must be lit.
const LEAST_LIT: f32 = 0.1;

impl Lamp {
    /// A lamp of a seed: at a place that is uniform in the box that views are sampled in, given that it is not inside of
    /// geometry or nearer to it than 2 % of the diagonal, and lights a tenth of what the camera sees; where none of 256
    /// places is so, at the camera. A white surface that faces it from the median distance of what it lights shines with a
    /// radiance of 0.7 to 1.5.
    pub fn drawn(scene: &TracedScene, camera: &Camera, size: [usize; 2], seed: u32) -> Self {
        let draw = |attempt: u64, which: u64| uniform(&[u64::from(seed), purpose::LAMP, attempt, which]);
        let bounds = views::fitted_box(scene);
        let seen = views::seen_points(scene, camera, size);
        let place = |attempt: u64| {
            bounds.min + bounds.size() * Vec3::new(draw(attempt, 0), draw(attempt, 1), draw(attempt, 2))
        };
        let found = (0..ATTEMPTS).map(place).find_map(|position| {
            let open = views::is_open(scene, position, LEAST_DISTANCE * bounds.diagonal());
            let distances = if open { lit_distances(scene, position, &seen) } else { Vec::new() };
            let enough = !distances.is_empty() && distances.len() as f32 >= LEAST_LIT * seen.len() as f32;
            enough.then_some((position, distances))
        });
        let (position, distances) = found.unwrap_or_else(|| {
            let distances = seen.iter().map(|point| f64::from(point.position.distance(camera.position)));
            (camera.position, distances.chain([f64::from(bounds.diagonal())]).collect())
        });
        let distance = lists::median(distances) as f32;
        let brightness = between([0.7, 1.5], draw(0, 3));
        let warmth = draw(0, 4);
        let colour = Vec3::new(1.0, 0.97 - 0.2 * warmth, 0.94 - 0.4 * warmth);
        Self { position, intensity: colour * brightness * PI * distance * distance }
    }

    /// The light.
    pub const fn light(&self) -> Light {
        Light::Point { position: self.position, intensity: self.intensity, range: f32::INFINITY }
    }
}

/// Distances, metres, from a place to those points that it shines on.
fn lit_distances(scene: &TracedScene, place: Vec3, points: &[SurfacePoint]) -> Vec<f64> {
    let lit = |point: &SurfacePoint| {
        let to_lamp = place - point.position;
        let distance = to_lamp.length();
        let faces = point.normal.dot(to_lamp) > 0.0 && point.geometric_normal.dot(to_lamp) > 0.0;
        (faces && !scene.blocked(point.ray_origin(), to_lamp / distance, distance))
            .then_some(f64::from(distance))
    };
    points.iter().filter_map(lit).collect()
}
