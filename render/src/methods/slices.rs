//! Slices of what a surface sees, marched through the g-buffer into bitmasks of cosine-weighted sectors: what
//! ambient occlusion ([`gtao`](super::gtao)) and indirect light ([`ssgi`](super::ssgi)) share.
//! `shared/slices.wgsl` in Rust, line by line.
//!
//! A slice is a plane through the eye and the point, which the camera sees as a line through the pixel.
//! Slices turn evenly about the direction to the eye (Jimenez, Wu, Pesce and Jarabo, "Practical Realtime
//! Strategies for Accurate Indirect Occlusion", SIGGRAPH 2016 courses, section 4.1), so that in a slice at
//! the angle `phi` directions at the angle `t` from the eye have the solid angle `|sin t| dt dphi` and the
//! cosine `l cos(t - g)` to the normal, where `l` is the length of the normal's projection onto the slice and
//! `g` the projection's angle. The normal's hemisphere is `t` from `g - pi/2` to `g + pi/2`, and of the
//! cosine-weighted solid angle there is up to an angle `t >= 0`
//!
//! ```text
//! integral from g - pi/2 to t of cos(s - g) |sin s| ds = 3/4 cos g - 1/4 cos(2t - g) + 1/2 sin g (t + g - pi/2)
//! ```
//!
//! which for the whole slice is `cos g + g sin g`. The quotient places a direction in [0, 1] so that equal
//! parts count equally; 32 of them are the bits of a mask (Therrien, Levesque and Gilet, "Screen Space
//! Indirect Lighting with Visibility Bitmask", The Visual Computer 2023, section 3, whose sectors are of
//! equal angle). A sample of the g-buffer covers the sectors from its front to its back, a thickness further
//! from the eye, if it is within the radius. What its mask has and those before it had not is newly covered.
//! Slices count by `l (cos g + g sin g)`.
//!
//! Samples are denser near the pixel, by the square. As they are middles of pixels, they lie beside the
//! slice; each is placed in the slice that it does lie in, which keeps slanted planes open. Borders of
//! sectors are moved at random, so that on average nothing is rounded.

#[cfg(test)]
mod tests;
pub mod vector;

use super::Surface;
use crate::screen::View;
use deepshade_shaders::{random, wgsl::uniforms};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// The sectors of a slice: the bits of a mask.
const SECTORS: f32 = 32.0;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct SliceParameters {
    /// Slices of a pixel, at least 1.
    #[schemars(range(min = 1, max = 64))]
    pub slices: u32,
    /// Samples on either side of a slice, at least 1; fewer where there are fewer pixels.
    #[schemars(range(min = 1, max = 128))]
    pub steps: u32,
    /// How thick everything is taken to be, away from the eye, as a share of the radius. Light passes behind
    /// it.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub thickness: f32,
}

impl SliceParameters {
    /// What the passes read.
    pub fn settings(&self, view: &View) -> uniforms::Slices {
        uniforms::Slices {
            width: view.width as u32,
            height: view.height as u32,
            slices: self.slices.max(1),
            steps: self.steps.max(1),
            seed: view.seed,
            radius: view.radius,
            thickness: self.thickness * view.radius,
            focal_length: view.focal_length(),
        }
    }
}

/// What a point gets.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathered {
    /// Cosine-weighted share of all directions that is open.
    pub open: f32,
    /// Mean over all directions of what is sent from them, cosine-weighted.
    pub light: Vec3,
}

/// The normal in the plane of the direction to the eye and one across it: cosine and sine of its angle from
/// the one towards the other, the angle, and the length of its projection onto the plane.
#[derive(Clone, Copy, Debug)]
struct Tilt {
    cosine: f32,
    sine: f32,
    angle: f32,
    length: f32,
}

/// Within 7e-5 (Abramowitz and Stegun 1964, 4.4.45): the same on every device.
fn arc_cosine(x: f32) -> f32 {
    let a = x.abs().min(1.0);
    let angle = (1.0 - a).sqrt() * (1.570_728_8 + a * (-0.212_114_4 + a * (0.074_261_0 - 0.018_729_3 * a)));
    if x < 0.0 { PI - angle } else { angle }
}

impl Tilt {
    fn new(normal: Vec3, to_eye: Vec3, across: Vec3) -> Self {
        // A normal that looks away from the eye is taken for one at a right angle.
        let upright = normal.dot(to_eye).max(0.0);
        let aside = normal.dot(across);
        let length = (upright * upright + aside * aside).sqrt().max(1e-6);
        let sine = (aside / length).clamp(-1.0, 1.0);
        Self { cosine: upright / length, sine, angle: FRAC_PI_2 - arc_cosine(sine), length }
    }

    /// Integral over a slice of the cosine to the normal's projection times the slice's width.
    fn extent(&self) -> f32 {
        self.cosine + self.angle * self.sine
    }

    /// The share of a slice's cosine-weighted directions before a unit direction in its half `across`; 1 at
    /// the horizon.
    fn place(&self, direction: Vec3, to_eye: Vec3, across: Vec3, normal: Vec3) -> f32 {
        if direction.dot(normal) <= 0.0 {
            return 1.0;
        }
        let cosine = direction.dot(to_eye);
        let sine = direction.dot(across);
        let doubled = (2.0 * cosine * cosine - 1.0) * self.cosine + 2.0 * sine * cosine * self.sine;
        let before = 0.75 * self.cosine - 0.25 * doubled
            + 0.5 * self.sine * (arc_cosine(cosine) + self.angle - FRAC_PI_2);
        (before / self.extent()).clamp(0.0, 1.0)
    }
}

/// The sectors, from the middle of a slice outwards, that the surface at `at` covers, seen from `position`.
/// It is `thickness` thick along the ray from the eye, and ends at the radius.
fn covered_by(
    slices: &uniforms::Slices,
    at: Vec3,
    position: Vec3,
    normal: Vec3,
    to_eye: Vec3,
    jitter: f32,
) -> u32 {
    let toward = at - position;
    let distance = toward.length();
    if !(distance > 0.0 && distance < slices.radius) || toward.dot(normal) <= 0.0 {
        return 0;
    }
    let aside = toward - toward.dot(to_eye) * to_eye;
    let across = aside / aside.length().max(1e-20);
    let tilt = Tilt::new(normal, to_eye, across);
    let along_ray = at.normalize();
    let inward = toward.dot(along_ray);
    let to_radius = (inward * inward + slices.radius * slices.radius - distance * distance).sqrt() - inward;
    let behind = toward + slices.thickness.min(to_radius) * along_ray;
    let first = tilt.place(toward / distance, to_eye, across, normal);
    let last = tilt.place(behind.normalize(), to_eye, across, normal);
    let low = ((SECTORS * first + jitter) as u32).min(32);
    let high = ((SECTORS * last + jitter) as u32).min(32);
    if high <= low { 0 } else { (u32::MAX >> (32 - (high - low))) << low }
}

/// Pixels that may be marched in a direction of the image: as far as the radius reaches and the image goes
/// on.
fn reach_of(slices: &uniforms::Slices, pixel: IVec2, depth: f32, direction: Vec2) -> f32 {
    let squared = depth * depth - slices.radius * slices.radius;
    let radius = slices.focal_length * slices.radius / squared.max(1e-6 * depth * depth).sqrt();
    let last = Vec2::new(slices.width as f32, slices.height as f32) - 1.0;
    let pixels = Vec2::select(direction.cmpgt(Vec2::ZERO), last - pixel.as_vec2(), pixel.as_vec2());
    let edge = pixels / direction.abs().max(Vec2::splat(1e-6));
    radius.min(edge.min_element())
}

/// What the surface at `pixel` gets. `sent` says what the surface at another pixel sends to it; the vector is
/// from it to the other.
pub fn gather(
    surface: &Surface,
    slices: &uniforms::Slices,
    pixel: IVec2,
    sent: impl Fn(IVec2, Vec3) -> Vec3,
) -> Gathered {
    let position = surface.position_at(pixel);
    let normal = surface.normal_at(pixel);
    let to_eye = -position.normalize();
    let right = Vec3::new(to_eye.z, 0.0, -to_eye.x).normalize();
    let up = to_eye.cross(right);
    let draw = |dimension| random::random(pixel.x as u32, pixel.y as u32, slices.seed, dimension);
    let turn = draw(0);
    let mut gathered = Gathered::default();
    let mut weights = 0.0;
    for k in 0..slices.slices {
        let angle = (k as f32 + turn) * (PI / slices.slices as f32);
        let start = draw(1 + 2 * k);
        let jitter = draw(2 + 2 * k);
        let axis = angle.cos() * right + angle.sin() * up;
        let tilt = Tilt::new(normal, to_eye, axis);
        let weight = tilt.length * tilt.extent();
        let mut covered = 0u32;
        for side in 0..2 {
            let across = if side == 1 { -axis } else { axis };
            // Where the image of a point goes that moves across; image y points down, camera y up.
            let moved = across.truncate() - position.truncate() * (across.z / position.z);
            let direction = Vec2::new(moved.x, -moved.y).normalize();
            let reach = reach_of(slices, pixel, -position.z, direction);
            if reach.is_nan() || reach < 1.0 {
                continue;
            }
            let count = slices.steps.min(reach as u32);
            for step in 0..count {
                let share = (step as f32 + start) / count as f32;
                let offset = (direction * (1.0 + (reach - 1.0) * share * share) + 0.5).floor();
                let at = pixel + offset.as_ivec2();
                if !surface.contains(at) {
                    break;
                }
                if !surface.valid_at(at) {
                    continue;
                }
                let sender = surface.position_at(at);
                let outward = covered_by(slices, sender, position, normal, to_eye, jitter);
                let sectors = if side == 1 { outward.reverse_bits() } else { outward } & !covered;
                if sectors != 0 {
                    covered |= sectors;
                    let share_of_all = weight * sectors.count_ones() as f32 / SECTORS;
                    gathered.light += share_of_all * sent(at, sender - position);
                }
            }
        }
        gathered.open += weight * covered.count_zeros() as f32 / SECTORS;
        weights += weight;
    }
    Gathered { open: gathered.open / weights, light: gathered.light / weights }
}
