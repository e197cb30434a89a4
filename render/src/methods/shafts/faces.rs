//! A distant lamp's light on its way through a medium's box: it comes in by the nearest of the three faces
//! that look towards the lamp, so that along a view ray its way is the least of three linear functions, and
//! what is scattered to the eye has a closed form.

use crate::scene::Bounds;
use glam::Vec3;

/// The faces through which light comes that meets a view ray.
#[derive(Clone, Copy, Debug)]
pub struct Faces {
    /// By face, how far light has come through the box: its value at the eye and its slope along the ray.
    pub ways: [[f32; 2]; 3],
    /// The distances at which two faces are equally far, in order; between them one face counts.
    pub crossings: [f32; 3],
}

/// Least share of a direction towards a lamp that crosses a face: one that is crossed less is as far away as
/// it can be.
const LEAST_SPEED: f32 = 1e-6;

impl Faces {
    /// Of light from a unit direction that meets a ray from the eye.
    pub fn new(bounds: Bounds, eye: Vec3, direction: Vec3, towards: Vec3) -> Self {
        let ways: [[f32; 2]; 3] = std::array::from_fn(|axis| {
            let face = if towards[axis].is_sign_positive() { bounds.max[axis] } else { bounds.min[axis] };
            let speed = towards[axis].abs().max(LEAST_SPEED).copysign(towards[axis]);
            [(face - eye[axis]) / speed, -direction[axis] / speed]
        });
        let crossing = |a: usize, b: usize| (ways[a][0] - ways[b][0]) / (ways[b][1] - ways[a][1]);
        let mut crossings = [crossing(0, 1), crossing(0, 2), crossing(1, 2)];
        crossings.sort_unstable_by(f32::total_cmp);
        Self { ways, crossings }
    }

    /// The face that counts at a distance.
    pub fn at(&self, distance: f32) -> usize {
        let way = |face: usize| self.ways[face][0] + self.ways[face][1] * distance;
        let nearer = usize::from(way(1) < way(0));
        if way(2) < way(nearer) { 2 } else { nearer }
    }

    /// Integral over a lit part of the view ray of what is left of light after both ways, that on the view
    /// ray counted from `near`, metres.
    pub fn integral(&self, extinction: f32, near: f32, [from, to]: [f32; 2]) -> f32 {
        let (mut sum, mut start) = (0.0, from);
        for end in self.crossings.into_iter().chain([to]) {
            // What is no number is no crossing.
            let end = end.clamp(from, to).max(start);
            if end > start {
                sum += self.of_piece(extinction, near, [start, end]);
                start = end;
            }
        }
        sum
    }

    /// The same of a part in which one face counts.
    fn of_piece(&self, extinction: f32, near: f32, [from, to]: [f32; 2]) -> f32 {
        let [at_eye, slope] = self.ways[self.at(0.5 * (from + to))];
        // Rounding may bring ends out of the box, where there is no way to go.
        let [first, last] = [from, to].map(|distance| (at_eye + slope * distance).max(0.0));
        let length = to - from;
        (-extinction * ((from - near) + first)).exp()
            * length
            * mean_decay(extinction * (length + last - first))
    }
}

/// Mean of `exp(-x)` from 0 to a depth.
pub fn mean_decay(depth: f32) -> f32 {
    if depth.abs() < 1e-3 { 1.0 - 0.5 * depth } else { -(-depth).exp_m1() / depth }
}
