//! Steps through a medium that is the same throughout, towards a distant lamp.
//!
//! Along a view ray the optical depth of both of light's ways is linear in at most four pieces ([`Faces`]), and what is
//! left of light a geometric sequence in each: no exponential a step. Within a step that is lit it is integrated exactly.

use super::super::shafts::{Faces, Haze, Lit, Parallel, Projection, ShadowMap, mean_decay};
use glam::Vec3;
use std::ops::Range;

/// A lamp and what its light passes.
#[derive(Debug)]
pub(super) struct Distant<'a> {
    lit: Lit<'a>,
    haze: Haze<'a>,
    towards: Vec3,
}

/// A view ray cut into steps.
struct Steps {
    direction: Vec3,
    near: f32,
    length: f32,
    count: u32,
    jitter: f32,
}

impl Steps {
    /// The pieces of the ray, each with the face that counts there.
    fn pieces(&self, faces: &Faces) -> [(usize, Range<u32>); 4] {
        let step = |distance: f32| (((distance - self.near) / self.length + 0.5) as u32).min(self.count);
        let mut ends = faces.crossings().map(step);
        ends.sort_unstable();
        let [a, b, c] = ends;
        [0..a, a..b, b..c, c..self.count].map(|range| {
            let middle = 0.5 * (range.start + range.end) as f32;
            (faces.at(self.near + middle * self.length), range)
        })
    }
}

impl<'a> Distant<'a> {
    pub(super) const fn new(lit: &Lit<'a>, haze: Haze<'a>, towards: Vec3) -> Self {
        Self { lit: *lit, haze, towards }
    }

    /// Radiance of a ray; black in a medium without an end, where no light of a distant lamp is left.
    pub(super) fn radiance(&self, direction: Vec3, [near, far]: [f32; 2], count: u32, jitter: f32) -> Vec3 {
        let Lit { map, lamp, .. } = self.lit;
        let (Some(bounds), Projection::Parallel(parallel)) = (self.haze.bounds(), &map.projection) else {
            return Vec3::ZERO;
        };
        let steps = Steps { direction, near, length: (far - near) / count as f32, count, jitter };
        let faces = Faces::new(bounds, self.lit.rays.eye, direction, self.towards);
        let sum = match (lamp.is_even(), self.haze.is_grey()) {
            (true, true) => Vec3::splat(self.sum::<1>(&steps, parallel, &faces)[0]),
            (true, false) => self.sum::<3>(&steps, parallel, &faces).into(),
            (false, _) => self.tinted_sum(&steps, parallel, &faces),
        };
        let phase = self.haze.phase.evaluate(self.towards.dot(direction));
        lamp.power * self.haze.scattering * phase * sum
    }

    /// Metres of lit steps, each times what is left of light that takes its way, of `C` colours.
    fn sum<const C: usize>(&self, steps: &Steps, parallel: &Parallel, faces: &Faces) -> [f32; C] {
        let mut sum = [0.0; C];
        self.walk(steps, parallel, faces, |_, left: [f32; C]| {
            for (sum, left) in sum.iter_mut().zip(left) {
                *sum += left;
            }
        });
        sum
    }

    /// The same for light whose rays differ.
    fn tinted_sum(&self, steps: &Steps, parallel: &Parallel, faces: &Faces) -> Vec3 {
        let mut sum = Vec3::ZERO;
        self.walk(steps, parallel, faces, |distance, left: [f32; 3]| {
            sum += Vec3::from(left) * self.lit.lamp.tint(self.lit.rays.eye + steps.direction * distance);
        });
        sum
    }

    /// Calls `lit` with the distance and what is left of light, for each step that light reaches.
    #[inline(always)]
    fn walk<const C: usize>(
        &self,
        steps: &Steps,
        parallel: &Parallel,
        faces: &Faces,
        mut lit: impl FnMut(f32, [f32; C]),
    ) {
        let map: &ShadowMap = self.lit.map;
        let first = steps.near + steps.jitter * steps.length;
        let start = parallel.locate(self.lit.rays.eye + steps.direction * first);
        let step = parallel.along(steps.direction * steps.length);
        for (face, range) in steps.pieces(faces) {
            let (mut left, factor) = self.decay::<C>(steps, faces.0[face], range.start);
            for i in range {
                let along = i as f32;
                let [u, v, depth] = std::array::from_fn(|axis| start[axis] + step[axis] * along);
                if depth < map.depth(0, u, v) {
                    lit(first + along * steps.length, left);
                }
                for (left, factor) in left.iter_mut().zip(factor) {
                    *left *= factor;
                }
            }
        }
    }

    /// What is left of light through a face in a step, times the step's length, and by what that is multiplied from step
    /// to step.
    fn decay<const C: usize>(
        &self,
        steps: &Steps,
        [at_eye, slope]: [f32; 2],
        step: u32,
    ) -> ([f32; C], [f32; C]) {
        let distance = step as f32 * steps.length;
        let way = (at_eye + slope * (steps.near + distance)).max(0.0);
        let extinction: [f32; C] = std::array::from_fn(|colour| self.haze.extinction[colour]);
        let depth = extinction.map(|extinction| extinction * (1.0 + slope) * steps.length);
        let first = std::array::from_fn(|colour| {
            (-extinction[colour] * (distance + way)).exp() * steps.length * mean_decay(depth[colour])
        });
        (first, depth.map(|depth| (-depth).exp()))
    }
}
