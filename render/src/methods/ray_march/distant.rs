//! Steps through a medium that is the same throughout, towards a distant lamp.
//!
//! Along a view ray the optical depth of both of light's ways is linear in at most four pieces ([`Faces`]),
//! and what is left of light a geometric sequence in each: no exponential a step. Within a step that is lit
//! it is integrated exactly. Steps are taken many at a time in loops that the compiler puts into vectors.

use super::super::shafts::{
    Faces, Haze, IntegrationInputs, Parallel, Projection, ShadowMap, TOGETHER, mean_decay,
};
use super::Ray;
use glam::Vec3;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// A lamp and what its light passes.
#[derive(Debug)]
pub(super) struct Distant<'a> {
    lit: IntegrationInputs<'a>,
    haze: Haze<'a>,
    towards: Vec3,
}

/// A view ray cut into steps.
struct Steps<'a> {
    eye: Vec3,
    direction: Vec3,
    near: f32,
    length: f32,
    count: u32,
    jitter: f32,
    map: &'a ShadowMap,
    parallel: &'a Parallel,
    /// Where the first step is in the light's projection, metres, each with by how much it grows from step to
    /// step.
    locations: [[f32; 2]; 3],
}

/// Steps that follow each other, from where most light is left.
struct Block<const C: usize> {
    /// Number of each.
    numbers: [f32; TOGETHER],
    /// What is left of light at the first, times the step's length, in each colour.
    left: [f32; C],
    /// By what that is multiplied at each step: 0 where no light is.
    factors: [[f32; TOGETHER]; C],
}

impl<'a> Steps<'a> {
    fn new(lit: &IntegrationInputs<'a>, parallel: &'a Parallel, ray: Ray) -> Self {
        let Ray { direction, span: [near, far], count, jitter } = ray;
        let eye = lit.rays.eye;
        let length = (far - near) / count as f32;
        let start = parallel.locate(eye + direction * (near + jitter * length));
        let step = parallel.along(direction * length);
        let locations = std::array::from_fn(|axis| [start[axis], step[axis]]);
        Self { eye, direction, near, length, count, jitter, map: lit.map, parallel, locations }
    }

    /// The pieces of the ray, each with the face that counts there.
    fn pieces(&self, faces: &Faces) -> [(usize, Range<u32>); 4] {
        let step = |distance: f32| (((distance - self.near) / self.length + 0.5) as u32).min(self.count);
        let mut ends = faces.crossings.map(step);
        ends.sort_unstable();
        let [a, b, c] = ends;
        [0..a, a..b, b..c, c..self.count].map(|range| {
            let middle = 0.5 * (range.start + range.end) as f32;
            (faces.at(self.near + middle * self.length), range)
        })
    }

    /// 1 for each of the first `count` steps of these numbers that light reaches, 0 for others.
    #[inline(always)]
    fn lit(&self, numbers: &[f32; TOGETHER], count: u32) -> [f32; TOGETHER] {
        let [right, up, [depth, deeper]] = self.locations;
        let mut lit = self.map.depths_along(self.parallel, [right, up], numbers);
        for (i, (lit, number)) in lit.iter_mut().zip(numbers).enumerate() {
            *lit = if depth + deeper * number < *lit && (i as u32) < count { 1.0 } else { 0.0 };
        }
        lit
    }

    /// World-space point of a step.
    fn point(&self, step: f32) -> Vec3 {
        self.eye + self.direction * (self.near + (self.jitter + step) * self.length)
    }
}

impl<'a> Distant<'a> {
    pub(super) const fn new(lit: &IntegrationInputs<'a>, haze: Haze<'a>, towards: Vec3) -> Self {
        Self { lit: *lit, haze, towards }
    }

    /// Radiance of a ray; black in a medium without an end, where no light of a distant lamp is left.
    pub(super) fn radiance(&self, ray: Ray) -> Vec3 {
        let IntegrationInputs { map, lamp, .. } = self.lit;
        let (Some(bounds), Projection::Parallel(parallel)) = (self.haze.bounds(), &map.projection) else {
            return Vec3::ZERO;
        };
        let steps = Steps::new(&self.lit, parallel, ray);
        let faces = Faces::new(bounds, steps.eye, ray.direction, self.towards);
        let sum = match (lamp.is_even(), self.haze.is_grey()) {
            (true, true) => Vec3::splat(Arch::new().dispatch(Sum::<1> { of: self, steps, faces })[0]),
            (true, false) => Arch::new().dispatch(Sum::<3> { of: self, steps, faces }).into(),
            (false, _) => self.tinted_sum(&steps, &faces),
        };
        let phase = self.haze.phase.evaluate(self.towards.dot(ray.direction));
        lamp.power * self.haze.scattering * phase * sum
    }

    /// Metres of lit steps, each times what is left of light that takes its way and what differs from ray to
    /// ray.
    fn tinted_sum(&self, steps: &Steps<'_>, faces: &Faces) -> Vec3 {
        let mut sum = Vec3::ZERO;
        self.walk(steps, faces, |block: Block<3>| {
            let [red, green, blue] = &block.factors;
            for (((red, green), blue), number) in red.iter().zip(green).zip(blue).zip(block.numbers) {
                let factors = Vec3::new(*red, *green, *blue);
                if factors != Vec3::ZERO {
                    let tint = self.lit.lamp.tint(steps.point(number));
                    sum += Vec3::from(block.left) * factors * tint;
                }
            }
        });
        sum
    }

    /// Goes along a view ray block by block.
    #[inline(always)]
    fn walk<const C: usize>(&self, steps: &Steps<'_>, faces: &Faces, mut with: impl FnMut(Block<C>)) {
        for (face, range) in steps.pieces(faces) {
            let [at_eye, slope] = faces.ways[face];
            let extinction: [f32; C] = std::array::from_fn(|colour| self.haze.extinction[colour]);
            // Against the ray where it comes nearer to the light than it goes away from the eye.
            let forward = 1.0 + slope >= 0.0;
            let depths = extinction.map(|extinction| extinction * (1.0 + slope).abs() * steps.length);
            let powers = depths.map(powers);
            for done in range.clone().step_by(TOGETHER) {
                let passed = done - range.start;
                let first = if forward { done as f32 } else { (range.end - 1 - passed) as f32 };
                let number = |i: usize| if forward { first + i as f32 } else { first - i as f32 };
                let numbers = std::array::from_fn(number);
                let lit = steps.lit(&numbers, range.end - done);
                let distance = (if forward { first } else { first + 1.0 }) * steps.length;
                let way = distance + (at_eye + slope * (steps.near + distance)).max(0.0);
                let left = |colour: usize| {
                    (-extinction[colour] * way).exp() * steps.length * mean_decay(depths[colour])
                };
                let mut factors = powers;
                factors.iter_mut().for_each(|factors| {
                    factors.iter_mut().zip(&lit).for_each(|(factor, lit)| *factor *= lit);
                });
                with(Block { numbers, left: std::array::from_fn(left), factors });
            }
        }
    }
}

/// What is left at each step of what is left at the first, of an optical depth each.
#[inline(always)]
fn powers(depth: f32) -> [f32; TOGETHER] {
    let mut powers = [1.0; TOGETHER];
    let mut known = 1;
    while known < TOGETHER {
        let (before, behind) = powers.split_at_mut(known);
        let factor = (-depth * known as f32).exp();
        behind.iter_mut().zip(before).for_each(|(behind, before)| *behind = *before * factor);
        known *= 2;
    }
    powers
}

/// Metres of lit steps, each times what is left of light that takes its way, of `C` colours.
struct Sum<'a, 'b, const C: usize> {
    of: &'b Distant<'a>,
    steps: Steps<'a>,
    faces: Faces,
}

impl<const C: usize> WithSimd for Sum<'_, '_, C> {
    type Output = [f32; C];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut sum = [0.0; C];
        self.of.walk(&self.steps, &self.faces, |block: Block<C>| {
            for (sum, (left, factors)) in sum.iter_mut().zip(block.left.iter().zip(&block.factors)) {
                *sum += left * total(factors);
            }
        });
        sum
    }
}

/// Sum of some numbers, by lanes.
#[inline(always)]
fn total(numbers: &[f32; TOGETHER]) -> f32 {
    let mut lanes = [0.0; 16];
    for numbers in numbers.as_chunks::<16>().0 {
        lanes.iter_mut().zip(numbers).for_each(|(lane, number)| *lane += number);
    }
    lanes.iter().sum()
}
