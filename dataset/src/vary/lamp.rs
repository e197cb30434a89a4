//! A point light drawn uniformly in a scene, of those places that light something of what is seen ("the
//! position of the light source is sampled uniformly at random per image", thesis 7.4).

use super::draw::{between, purpose};
use crate::random::uniform;
use crate::views;
use deepshade_render::bvh::TracedScene;
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::scene::{Bounds, Camera, Light};
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

/// Places beside a camera, to its right and above it, in parts of the distance of what it sees; the best one
/// first.
const BESIDE: [[f32; 2]; 5] = [[-0.35, 0.35], [0.35, 0.35], [0.0, 0.45], [-0.45, 0.0], [0.45, 0.0]];
/// Share of what the camera sees that a lamp there must light.
const LEAST_LIT_BESIDE: f32 = 0.7;

impl Lamp {
    /// A lamp of a seed: at a place that is uniform in the box that views are sampled in, given that it is
    /// not inside of geometry or nearer to it than 2 % of the diagonal, and lights a tenth of what the camera
    /// sees; where none of 256 places is so, at the camera. A white surface that faces it from the median
    /// distance of what it lights shines with a radiance of 0.7 to 1.5.
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
        Self { position, intensity: intensity(distances, &draw) }
    }

    /// A lamp for a picture that somebody looks at: [`Lamp::drawn`] where the camera is among what is seen.
    /// Where it looks at things from outside, a place in their box would light one spot of them from within
    /// or from too near; the lamp is then beside the camera, where a photographer would put it, as bright as
    /// one that is drawn.
    pub fn of_view(scene: &TracedScene, camera: &Camera, size: [usize; 2], seed: u32) -> Self {
        let Bounds { min, max } = views::fitted_box(scene);
        if camera.position.cmpge(min).all() && camera.position.cmple(max).all() {
            return Self::drawn(scene, camera, size, seed);
        }
        let seen = views::seen_points(scene, camera, size);
        let away = seen.iter().map(|point| f64::from(point.position.distance(camera.position)));
        let away = lists::median(away.chain([f64::from(scene.diagonal())]).collect()) as f32;
        let place = |[right, up]: [f32; 2]| {
            camera.position + (camera.rotation.x_axis * right + camera.rotation.y_axis * up) * away
        };
        let places = BESIDE.into_iter().map(place).filter(|place| views::is_open(scene, *place, 0.0));
        let lit = places.map(|place| (place, lit_distances(scene, place, &seen)));
        let (position, distances) = lit
            .filter(|(_, distances)| distances.len() as f32 >= LEAST_LIT_BESIDE * seen.len() as f32)
            .chain([(camera.position, vec![f64::from(away)])])
            .find(|(_, distances)| !distances.is_empty())
            .expect("the camera's place has a distance");
        let draw = |attempt: u64, which: u64| uniform(&[u64::from(seed), purpose::LAMP, attempt, which]);
        Self { position, intensity: intensity(distances, &draw) }
    }

    /// The light.
    pub const fn light(&self) -> Light {
        Light::Point { position: self.position, intensity: self.intensity, range: f32::INFINITY }
    }
}

/// Intensity of which a white surface that faces the lamp from the median of some distances, metres, shines
/// with a radiance of 0.7 to 1.5.
fn intensity(distances: Vec<f64>, draw: &impl Fn(u64, u64) -> f32) -> Vec3 {
    let distance = lists::median(distances) as f32;
    let brightness = between([0.7, 1.5], draw(0, 3));
    let warmth = draw(0, 4);
    let colour = Vec3::new(1.0, 0.97 - 0.2 * warmth, 0.94 - 0.4 * warmth);
    colour * brightness * PI * distance * distance
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
