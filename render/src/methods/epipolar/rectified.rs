//! View rays and light rays of one lamp, in all of its slices, and the way through them that is common to all
//! that integrate slice by slice.

use super::super::shafts::{DEEP, Haze, IntegrationInputs, Lamp, LampPosition, Projection};
use super::exponential::exp;
use super::factors::Factors;
use super::geometry::{Geometry, angle};
use super::integrand::{Integrand, Ways};
use super::light_rays::{FanSlice, ParallelSlice, SliceOfLight};
use super::magnified::Magnified;
use super::slice_rays::{RectifiedRay, SliceRay, SliceRays};
use super::slices::Slices;
use super::spacing::Spacing;
use glam::Vec3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The largest value of `beta` up to which four terms are enough: the tangent of half the angle is 5.
const BACK: f32 = 1.7;

/// The largest sum of the angles of rays that count as meeting, radians.
const WIDEST: f64 = std::f64::consts::PI - 2e-3;

/// A way to integrate along the view rays of a slice, kept from slice to slice. `W` numbers a light ray: the
/// terms of the integrand in each of `C` colours.
pub trait SliceIntegration<const W: usize, const C: usize>: Default + Send {
    /// Fills in the values of view rays: for each colour the sum over lit light rays of what `factors` stand
    /// for, times the light rays' weights.
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        factors: &Factors<W>,
        values: &mut [[f32; C]],
    );
}

/// A half-plane of one lamp.
#[derive(Debug)]
pub struct Slice<'a, L> {
    /// Of which lamp.
    pub of: &'a Rectified<'a>,
    /// Its light rays.
    pub light: L,
    /// Unit vector away from the line between eye and light, world space.
    pub outwards: Vec3,
}

/// The view rays of one lamp's slices, and its light rays.
#[derive(Debug)]
pub struct Rectified<'a> {
    /// The lamp.
    pub lit: &'a IntegrationInputs<'a>,
    /// What scatters its light.
    pub haze: Haze<'a>,
    /// Where it is.
    pub geometry: Geometry,
    /// What the integrand counts of its ways.
    pub ways: Ways,
    /// Its light rays.
    pub spacing: Spacing,
    slices: Slices,
    rays: SliceRays,
}

impl<'a> Rectified<'a> {
    /// `None` where slices do not help: the light is at the eye, or the medium swallows it, being endless, or
    /// is a grid. View rays that cross fewer than `least` light rays are left to others, and so are those on
    /// which errors of the integrand are magnified by more than the exponential of `most_magnified`.
    pub fn new(
        lit: &'a IntegrationInputs<'a>,
        light_rays: usize,
        least: f32,
        most_magnified: f32,
    ) -> Option<Self> {
        let haze = Haze::of(lit.medium)?;
        let geometry = Geometry::new(lit.rays.eye, lit.lamp.position)?;
        let ways = Ways::of(&haze, &geometry);
        if geometry.is_parallel() && haze.bounds().is_none() {
            return None;
        }
        let deep = haze.deep();
        let seen = |ray: usize| RectifiedRay::new(lit.rays, ray, &geometry, deep);
        let seen: Vec<RectifiedRay> = (0..lit.rays.count()).into_par_iter().map(seen).collect();
        let bounds = RectifiedRay::bounds(&seen);
        if bounds[0] >= bounds[1] {
            return None;
        }
        let spacing = Spacing::between(bounds, light_rays);
        let slices = Slices::new(geometry.epipole(lit.rays), lit.rays.height(), lit.rays.width());
        let magnified = Magnified { lit, haze: &haze, ways, deep, most: most_magnified };
        let are_magnified = magnified.may_be_too_much();
        let left_out = |ray: usize| are_magnified && magnified.is_too_much(ray);
        let rays = SliceRays::new(lit.rays, &seen, &slices, (&spacing, least), left_out);
        Some(Self { lit, haze, geometry, ways, spacing, slices, rays })
    }

    /// Whether some view rays are so opposite to the light that the integrand needs many terms.
    pub fn looks_back(&self) -> bool {
        self.rays.rays.par_iter().any(|ray| ray.beta > BACK)
    }

    /// Whether colours differ by more than a factor.
    pub fn are_coloured(&self) -> bool {
        !self.haze.is_grey() || self.lit.lamp.is_coloured()
    }

    /// Adds the radiance of each view ray: of its slices, or of `others` where it is in none.
    pub fn add<const W: usize, const C: usize, I: SliceIntegration<W, C>>(
        &self,
        radiance: &mut [Vec3],
        others: impl Fn(usize) -> Vec3 + Sync,
    ) {
        let factors = self.factors::<W, C>();
        let values = self.integrate::<W, C, I>(&factors);
        radiance.par_iter_mut().enumerate().for_each(|(ray, radiance)| {
            *radiance += match self.rays.value(ray, &values) {
                Some(value) => self.finished(ray, Vec3::from_array(std::array::from_fn(|i| value[i % C]))),
                None => others(ray),
            };
        });
    }

    /// The integrand, decomposed.
    pub fn factors<const W: usize, const C: usize>(&self) -> Factors<W> {
        Factors::new(&self.integrands::<C>(), &self.spacing, self.betas())
    }

    /// The integrand of each colour.
    fn integrands<const C: usize>(&self) -> [Integrand<'_>; C] {
        std::array::from_fn(|colour| Integrand {
            geometry: &self.geometry,
            lamp: self.lit.lamp,
            extinction: self.haze.extinction[colour].into(),
            phase: self.haze.phase,
            ways: self.ways,
            widest: self.widest(),
        })
    }

    /// See [`Integrand::widest`].
    fn widest(&self) -> f64 {
        let sum = |ray: &SliceRay| {
            let [cosine, sine] = angle(ray.beta.into());
            sine.atan2(cosine) + f64::from(self.spacing.gamma(ray.end))
        };
        let rays = if self.geometry.is_parallel() { &[] } else { self.rays.rays.as_slice() };
        rays.par_iter().map(sum).reduce(|| 0.0, f64::max).min(WIDEST)
    }

    /// From which to which value of `beta` view rays are.
    fn betas(&self) -> [f32; 2] {
        let all = self.rays.rays.iter().map(|ray| ray.beta);
        let [low, high] = all.fold([2.0f32, 0.0], |[low, high], beta| [low.min(beta), high.max(beta)]);
        [low, high.max(low)]
    }

    /// The values of all slice rays.
    fn integrate<const W: usize, const C: usize, I: SliceIntegration<W, C>>(
        &self,
        factors: &Factors<W>,
    ) -> Vec<[f32; C]> {
        let mut values = vec![[0.0; C]; self.rays.rays.len()];
        let mut left = values.as_mut_slice();
        let mut slices = Vec::with_capacity(self.slices.count());
        for slice in 0..self.slices.count() {
            let range = self.rays.starts[slice]..self.rays.starts[slice + 1];
            let (values, behind) = left.split_at_mut(range.len());
            left = behind;
            slices.push((slice, &self.rays.rays[range], values));
        }
        let occupied = slices.into_par_iter().filter(|(_, rays, _)| !rays.is_empty());
        occupied.for_each_init(I::default, |integration, (slice, rays, values)| {
            let end = self.lit.rays.direction(self.slices.end(slice).as_vec2());
            self.integrate_slice(integration, self.geometry.outwards(end), rays, factors, values);
        });
        values
    }

    fn integrate_slice<const W: usize, const C: usize>(
        &self,
        integration: &mut impl SliceIntegration<W, C>,
        outwards: Vec3,
        rays: &[SliceRay],
        factors: &Factors<W>,
        values: &mut [[f32; C]],
    ) {
        let Self { lit, haze, geometry, ways, spacing, .. } = self;
        match (&lit.map.projection, haze.bounds()) {
            // Without a box no sunlight is left.
            (Projection::Parallel(_), None) => {}
            (Projection::Parallel(parallel), Some(bounds)) => {
                let light =
                    ParallelSlice::new(geometry, lit.map, parallel, (bounds, *ways), outwards, spacing);
                let slice = &Slice { of: self, light, outwards };
                Arch::new().dispatch(InVectors { integration, slice, rays, factors, values });
            }
            (Projection::Stereographic(around), _) => {
                let (map, ways) = (lit.map, *ways);
                let light = FanSlice { geometry, map, around, haze, outwards, spacing, ways };
                let slice = &Slice { of: self, light, outwards };
                Arch::new().dispatch(InVectors { integration, slice, rays, factors, values });
            }
        }
    }

    /// Radiance of a view ray from the value of its integral.
    fn finished(&self, ray: usize, value: Vec3) -> Vec3 {
        let [near, _] = self.lit.rays.spans[ray];
        let view = self.geometry.direction(self.lit.rays.directions[ray]);
        let per_gamma = match self.lit.lamp.position {
            LampPosition::Distant(_) => self.haze.phase.evaluate(view.along) / view.aside,
            LampPosition::Local(_) => 1.0 / (self.geometry.reach * view.aside),
        };
        let before = near - self.ways.view;
        let longer = if before > 0.0 { (self.haze.extinction * before).exp() } else { Vec3::ONE };
        // What rounding leaves of light rays that were taken out may be negative.
        self.lit.lamp.power * self.haze.scattering * (value * per_gamma * longer).max(Vec3::ZERO)
    }
}

/// One slice, compiled for the vectors that the processor has.
struct InVectors<'a, 's, I, L, const W: usize, const C: usize> {
    integration: &'a mut I,
    slice: &'a Slice<'s, L>,
    rays: &'a [SliceRay],
    factors: &'a Factors<W>,
    values: &'a mut [[f32; C]],
}

impl<I: SliceIntegration<W, C>, L: SliceOfLight, const W: usize, const C: usize> WithSimd
    for InVectors<'_, '_, I, L, W, C>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.integration.integrate(self.slice, self.rays, self.factors, self.values);
    }
}

impl<L: SliceOfLight> Slice<'_, L> {
    /// What is left of a light ray's light where the integrand begins to count, of each colour; its way
    /// through the medium being so much `longer`, metres.
    #[inline(always)]
    pub fn weight<const C: usize>(&self, ray: usize, longer: f32) -> [f32; C] {
        let lamp: &Lamp<'_> = self.of.lit.lamp;
        let tint = if lamp.is_even() { Vec3::ONE } else { lamp.tint(self.light.point(ray)) };
        std::array::from_fn(|colour| {
            let depth = self.of.haze.extinction[colour] * longer;
            // What would not be a number is of no view ray that asks.
            tint[colour] * exp((-depth).min(DEEP))
        })
    }
}
