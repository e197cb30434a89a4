//! The light rays of a slice: where each enters the medium and where its light ends. That is the rectified shadow map of
//! Baran et al. 2010 (section 3), of parallel light rays here and of those of local lights (section 9).

use super::super::shafts::{Haze, Parallel, ShadowMap, Stereographic};
use super::geometry::{Geometry, beta};
use super::integrand::Ways;
use super::prefilter::SAMPLES;
use crate::scene::Bounds;
use glam::Vec3;

/// A light ray's way through the medium.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Between which values of [`beta`] it is in it.
    pub between: [f32; 2],
    /// How much longer its way there is than what the integrand counts, metres.
    pub longer: f32,
}

impl Passage {
    /// Of a medium without an end.
    const ENDLESS: Self = Self { between: [0.0, 2.0], longer: 0.0 };
    /// Beside the medium.
    const NONE: Self = Self { between: [2.0, 0.0], longer: 0.0 };
}

/// The light rays of one slice.
pub trait SliceOfLight {
    /// The values of [`beta`] at which light ends, at samples spread evenly over what belongs to a light ray.
    fn ends(&self, ray: usize) -> [f32; SAMPLES];

    /// Its way through the medium.
    fn passage(&self, ray: usize) -> Passage;

    /// A point of a light ray, world space.
    fn point(&self, ray: usize) -> Vec3;
}

/// The `gamma` of a sample of light rays that are `step` apart; of the middle of one for a fractional `sample`.
fn gamma(ray: usize, sample: f32, step: f32) -> f32 {
    (ray as f32 + (sample + 0.5) / SAMPLES as f32) * step
}

/// What puts `gamma` into the middle of a light ray.
const MIDDLE: f32 = 0.5 * (SAMPLES - 1) as f32;

/// Parallel light rays.
#[derive(Debug)]
pub struct ParallelSlice<'a> {
    geometry: &'a Geometry,
    map: &'a ShadowMap,
    outwards: Vec3,
    step: f32,
    /// Texels and depth of the eye, and by how much they grow from one light ray to the next.
    at_eye: [f32; 3],
    per_metre: [f32; 3],
    /// By axis, where a light ray at `gamma` goes out of the box and into it: their values at 0 and slopes.
    faces: Option<[[[f32; 2]; 2]; 3]>,
    ways: Ways,
}

impl<'a> ParallelSlice<'a> {
    /// Those in the half-plane of a unit vector away from the axis.
    pub fn new(
        geometry: &'a Geometry,
        map: &'a ShadowMap,
        parallel: &Parallel,
        haze: &Haze<'_>,
        outwards: Vec3,
        step: f32,
    ) -> Self {
        let Geometry { eye, axis, .. } = *geometry;
        let crossing = |axis_of_box: usize, face: f32| {
            let speed = axis[axis_of_box];
            let speed = speed.abs().max(1e-6).copysign(speed);
            [(face - eye[axis_of_box]) / speed, -outwards[axis_of_box] / speed]
        };
        let pair = |bounds: Bounds, i: usize| {
            let both = [crossing(i, bounds.min[i]), crossing(i, bounds.max[i])];
            if axis[i] < 0.0 { [both[1], both[0]] } else { both }
        };
        Self {
            geometry,
            map,
            outwards,
            step,
            at_eye: parallel.locate(eye),
            per_metre: parallel.along(outwards),
            faces: haze.bounds().map(|bounds| std::array::from_fn(|i| pair(bounds, i))),
            ways: Ways::of(haze, geometry),
        }
    }
}

impl SliceOfLight for ParallelSlice<'_> {
    #[inline(always)]
    fn ends(&self, ray: usize) -> [f32; SAMPLES] {
        std::array::from_fn(|sample| {
            let gamma = gamma(ray, sample as f32, self.step);
            let [u, v, depth] = std::array::from_fn(|i| self.at_eye[i] + self.per_metre[i] * gamma);
            beta(depth - self.map.depth(0, u, v), gamma)
        })
    }

    #[inline(always)]
    fn passage(&self, ray: usize) -> Passage {
        let Some(faces) = &self.faces else { return Passage::NONE };
        let gamma = gamma(ray, MIDDLE, self.step);
        let at = |[from, slope]: [f32; 2]| from + slope * gamma;
        let out = faces.iter().map(|face| at(face[0])).fold(f32::NEG_INFINITY, f32::max);
        let into = faces.iter().map(|face| at(face[1])).fold(f32::INFINITY, f32::min);
        if out >= into {
            return Passage::NONE;
        }
        let longer = into + self.ways.least - self.ways.view;
        Passage { between: [beta(into, gamma), beta(out, gamma)], longer }
    }

    fn point(&self, ray: usize) -> Vec3 {
        self.geometry.eye + self.outwards * gamma(ray, MIDDLE, self.step)
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
    /// Radians from one to the next.
    pub step: f32,
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
    fn ends(&self, ray: usize) -> [f32; SAMPLES] {
        std::array::from_fn(|sample| {
            let (angle, direction) = self.direction(gamma(ray, sample as f32, self.step));
            self.beta(angle, self.map.towards(self.around, direction))
        })
    }

    #[inline(always)]
    fn passage(&self, ray: usize) -> Passage {
        if self.haze.bounds().is_none() {
            return Passage::ENDLESS;
        }
        let (angle, direction) = self.direction(gamma(ray, MIDDLE, self.step));
        let light = self.geometry.eye + self.geometry.axis * self.geometry.reach;
        let Some([into, out]) = self.haze.span(light, direction, f32::INFINITY) else { return Passage::NONE };
        Passage { between: [self.beta(angle, into), self.beta(angle, out)], longer: self.ways.light - into }
    }

    fn point(&self, ray: usize) -> Vec3 {
        let (_, direction) = self.direction(gamma(ray, MIDDLE, self.step));
        self.geometry.eye + self.geometry.axis * self.geometry.reach + direction
    }
}
