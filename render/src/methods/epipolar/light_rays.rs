//! The light rays of a slice: where each enters the medium and where its light ends. That is the rectified shadow map of
//! Baran et al. 2010 (section 3), of parallel light rays here and of those of local lights (section 9).

use super::super::shafts::{Haze, Parallel, ShadowMap, Stereographic, TOGETHER};
use super::geometry::{Geometry, beta};
use super::integrand::Ways;
use super::prefilter::SAMPLES;
use crate::scene::Bounds;
use glam::Vec3;

/// At which values of `gamma` the light rays of all slices are: equally far from each other.
#[derive(Clone, Copy, Debug)]
pub struct Spacing {
    /// Where the first one begins: the least `gamma` of what is seen.
    pub first: f32,
    /// From one to the next.
    pub step: f32,
    /// How many there are.
    pub count: usize,
}

impl Spacing {
    /// `count` light rays between two values.
    pub fn between([first, last]: [f32; 2], count: usize) -> Self {
        Self { first, step: (last - first) / count as f32, count }
    }

    /// `gamma` of a fractional number of light rays.
    #[inline(always)]
    pub fn gamma(self, rays: f32) -> f32 {
        self.first + rays * self.step
    }

    /// Which fractional light ray is at a value of `gamma`.
    #[inline(always)]
    pub fn number(self, gamma: f32) -> f32 {
        (gamma - self.first) / self.step
    }

    /// `gamma` in the middle of a sample.
    #[inline(always)]
    fn of_sample(self, sample: usize) -> f32 {
        self.gamma((sample as f32 + 0.5) * (1.0 / SAMPLES as f32))
    }

    /// `gamma` in the middle of a light ray.
    #[inline(always)]
    fn of_ray(self, ray: usize) -> f32 {
        self.gamma(ray as f32 + 0.5)
    }
}

/// What is known of the light rays of a slice, one after the other.
#[derive(Debug, Default)]
pub struct Traced {
    /// The values of [`beta`] at which light ends, of each [`SAMPLES`] samples spread evenly over what belongs to it.
    pub ends: Vec<f32>,
    /// Between which values of [`beta`] it is in the medium.
    pub enters: Vec<f32>,
    /// See [`Traced::enters`]; where it does not meet the medium, below that.
    pub leaves: Vec<f32>,
    /// How much longer its way there is than what the integrand counts, metres.
    pub longer: Vec<f32>,
}

impl Traced {
    #[inline(always)]
    fn resize(&mut self, rays: usize) {
        self.ends.resize(rays * SAMPLES, 0.0);
        for values in [&mut self.enters, &mut self.leaves, &mut self.longer] {
            values.resize(rays, 0.0);
        }
    }
}

/// The light rays of one slice.
pub trait SliceOfLight {
    /// Follows the first `count`.
    fn trace(&self, count: usize, traced: &mut Traced);

    /// A point of a light ray, world space.
    fn point(&self, ray: usize) -> Vec3;
}

/// Parallel light rays.
#[derive(Debug)]
pub struct ParallelSlice<'a> {
    geometry: &'a Geometry,
    map: &'a ShadowMap,
    outwards: Vec3,
    spacing: Spacing,
    /// Texels and depth of the eye, and by how much they grow from one light ray to the next.
    at_eye: [f32; 3],
    per_metre: [f32; 3],
    /// By axis, where a light ray at `gamma` goes out of the medium's box and into it: their values at 0 and slopes.
    faces: [[[f32; 2]; 2]; 3],
    ways: Ways,
}

impl<'a> ParallelSlice<'a> {
    /// Those in the half-plane of a unit vector away from the axis.
    pub fn new(
        geometry: &'a Geometry,
        map: &'a ShadowMap,
        parallel: &Parallel,
        (bounds, ways): (Bounds, Ways),
        outwards: Vec3,
        spacing: Spacing,
    ) -> Self {
        let Geometry { eye, axis, .. } = *geometry;
        let crossing = |axis_of_box: usize, face: f32| {
            let speed = axis[axis_of_box];
            let speed = speed.abs().max(1e-6).copysign(speed);
            [(face - eye[axis_of_box]) / speed, -outwards[axis_of_box] / speed]
        };
        let pair = |i: usize| {
            let both = [crossing(i, bounds.min[i]), crossing(i, bounds.max[i])];
            if axis[i].is_sign_negative() { [both[1], both[0]] } else { both }
        };
        Self {
            geometry,
            map,
            outwards,
            spacing,
            at_eye: parallel.locate(eye),
            per_metre: parallel.along(outwards),
            faces: std::array::from_fn(pair),
            ways,
        }
    }
}

impl SliceOfLight for ParallelSlice<'_> {
    /// Loops that the compiler puts into vectors.
    #[inline(always)]
    fn trace(&self, count: usize, traced: &mut Traced) {
        traced.resize(count);
        let first = self.spacing.of_sample(0);
        let step = self.spacing.of_sample(1) - first;
        let [u, v, [depth, deeper]] =
            [0, 1, 2].map(|i| [self.at_eye[i] + self.per_metre[i] * first, self.per_metre[i] * step]);
        for (block, ends) in traced.ends.chunks_mut(TOGETHER).enumerate() {
            let number = (block * TOGETHER) as f32;
            let depths = self.map.depths_along([u, v], number);
            for (i, (end, blocker)) in ends.iter_mut().zip(depths).enumerate() {
                let number = number + i as u32 as f32;
                *end = beta(depth + number * deeper - blocker, first + number * step);
            }
        }
        let at = |[from, slope]: [f32; 2], gamma: f32| from + slope * gamma;
        let (enters, leaves, longer) =
            (&mut traced.enters[..count], &mut traced.leaves[..count], &mut traced.longer[..count]);
        let [x, y, z] = self.faces;
        for ray in 0..count {
            let gamma = self.spacing.gamma(ray as u32 as f32 + 0.5);
            let out = at(x[0], gamma).max(at(y[0], gamma)).max(at(z[0], gamma));
            let into = at(x[1], gamma).min(at(y[1], gamma)).min(at(z[1], gamma));
            enters[ray] = beta(into, gamma);
            leaves[ray] = if out < into { beta(out, gamma) } else { -1.0 };
            longer[ray] = into + self.ways.least - self.ways.view;
        }
    }

    fn point(&self, ray: usize) -> Vec3 {
        self.geometry.eye + self.outwards * self.spacing.of_ray(ray)
    }
}

/// Light rays from a point.
#[derive(Debug)]
pub struct FanSlice<'a> {
    pub geometry: &'a Geometry,
    pub map: &'a ShadowMap,
    pub around: &'a Stereographic,
    pub haze: &'a Haze<'a>,
    /// Unit vector away from the axis.
    pub outwards: Vec3,
    pub spacing: Spacing,
    pub ways: Ways,
}

impl FanSlice<'_> {
    /// Direction of a light ray.
    #[inline(always)]
    fn direction(&self, gamma: f32) -> ([f32; 2], Vec3) {
        let (sin, cos) = gamma.sin_cos();
        ([cos, sin], self.outwards * sin - self.geometry.axis * cos)
    }

    /// What stands for the angle of the view ray to a point of a light ray.
    #[inline(always)]
    fn beta(&self, [cos, sin]: [f32; 2], distance: f32) -> f32 {
        beta(self.geometry.reach - distance * cos, distance * sin)
    }
}

impl SliceOfLight for FanSlice<'_> {
    #[inline(always)]
    fn trace(&self, count: usize, traced: &mut Traced) {
        traced.resize(count);
        for (sample, end) in traced.ends.iter_mut().enumerate() {
            let (angle, direction) = self.direction(self.spacing.of_sample(sample));
            *end = self.beta(angle, self.map.towards(self.around, direction));
        }
        let light = self.geometry.eye + self.geometry.axis * self.geometry.reach;
        for ray in 0..count {
            let (angle, direction) = self.direction(self.spacing.of_ray(ray));
            let span = self.haze.span(light, direction, f32::INFINITY);
            (traced.enters[ray], traced.leaves[ray], traced.longer[ray]) = match span {
                None => (0.0, -1.0, 0.0),
                // Everything before the eye is in a medium without an end.
                Some([0.0, f32::INFINITY]) => (0.0, 2.0, 0.0),
                Some([into, out]) => (self.beta(angle, into), self.beta(angle, out), self.ways.light - into),
            };
        }
    }

    fn point(&self, ray: usize) -> Vec3 {
        let (_, direction) = self.direction(self.spacing.of_ray(ray));
        self.geometry.eye + self.geometry.axis * self.geometry.reach + direction
    }
}
