//! The light rays of a slice: where each enters the medium and where its light ends. That is the rectified
//! shadow map of Baran et al. 2010 (section 3), of parallel light rays here and of those of local lights
//! (section 9).

use super::super::shafts::{Haze, Parallel, ShadowMap, Stereographic, TOGETHER};
use super::geometry::{Geometry, beta};
use super::integrand::Ways;
use super::prefilter::SAMPLES;
use super::spacing::Spacing;
use crate::scene::Bounds;
use glam::Vec3;

/// What is known of the light rays of a slice, one after the other.
#[derive(Debug, Default)]
pub struct Traced {
    /// The values of [`beta`] at which light ends, of [`SAMPLES`] samples spread evenly over what belongs to
    /// it: of the first sample of all light rays, of the second, and so on.
    pub ends: [Vec<f32>; SAMPLES],
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
        let others = [&mut self.enters, &mut self.leaves, &mut self.longer];
        self.ends.iter_mut().chain(others).for_each(|values| values.resize(rays, 0.0));
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
    parallel: &'a Parallel,
    outwards: Vec3,
    spacing: &'a Spacing,
    /// Where the eye is in the light's projection, metres, and by how much that grows with `gamma`.
    at_eye: [f32; 3],
    per_metre: [f32; 3],
    /// By axis, where a light ray at `gamma` goes out of the medium's box and into it: their values at 0 and
    /// slopes.
    faces: [[[f32; 2]; 2]; 3],
    ways: Ways,
}

impl<'a> ParallelSlice<'a> {
    /// Those in the half-plane of a unit vector away from the axis.
    pub fn new(
        geometry: &'a Geometry,
        map: &'a ShadowMap,
        parallel: &'a Parallel,
        (bounds, ways): (Bounds, Ways),
        outwards: Vec3,
        spacing: &'a Spacing,
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
            parallel,
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
        let [right, up, [depth, deeper]] = [0, 1, 2].map(|i| [self.at_eye[i], self.per_metre[i]]);
        for (ends, gammas) in traced.ends.iter_mut().zip(&self.spacing.samples) {
            let blocks = ends.chunks_mut(TOGETHER).zip(gammas.as_chunks().0);
            for (ends, gammas) in blocks {
                let depths = self.map.depths_along(self.parallel, [right, up], gammas);
                for ((end, blocker), gamma) in ends.iter_mut().zip(depths).zip(gammas) {
                    *end = beta(depth + gamma * deeper - blocker, *gamma);
                }
            }
        }
        let at = |[from, slope]: [f32; 2], gamma: f32| from + slope * gamma;
        let (enters, leaves, longer) =
            (&mut traced.enters[..count], &mut traced.leaves[..count], &mut traced.longer[..count]);
        let [x, y, z] = self.faces;
        let middles = &self.spacing.middles[..count];
        for ray in 0..count {
            let gamma = middles[ray];
            let out = at(x[0], gamma).max(at(y[0], gamma)).max(at(z[0], gamma));
            let into = at(x[1], gamma).min(at(y[1], gamma)).min(at(z[1], gamma));
            enters[ray] = beta(into, gamma);
            leaves[ray] = if out < into { beta(out, gamma) } else { -1.0 };
            longer[ray] = into + self.ways.least - self.ways.view;
        }
    }

    fn point(&self, ray: usize) -> Vec3 {
        self.geometry.eye + self.outwards * self.spacing.middles[ray]
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
    pub spacing: &'a Spacing,
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
        for (ends, gammas) in traced.ends.iter_mut().zip(&self.spacing.samples) {
            for (end, gamma) in ends.iter_mut().zip(gammas) {
                let (angle, direction) = self.direction(*gamma);
                *end = self.beta(angle, self.map.towards(self.around, direction));
            }
        }
        let light = self.geometry.eye + self.geometry.axis * self.geometry.reach;
        for ray in 0..count {
            let (angle, direction) = self.direction(self.spacing.middles[ray]);
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
        let (_, direction) = self.direction(self.spacing.middles[ray]);
        self.geometry.eye + self.geometry.axis * self.geometry.reach + direction
    }
}
