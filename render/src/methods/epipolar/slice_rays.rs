//! View rays in rectified coordinates, slice by slice, and back.
//!
//! Where Baran et al. resample the camera's depths into slices and the result back into the image, each pixel
//! asks both slices that it lies between for its own angle and its own depth, and takes the mean by its
//! distance to them. That costs as many questions as a depth map of twice the pixels, and edges in depth stay
//! where they are.

use super::super::shafts::ViewRays;
use super::geometry::{Geometry, beta};
use super::slices::Slices;
use super::spacing::Spacing;
use rayon::prelude::*;

/// A view ray as a slice sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct SliceRay {
    /// See [`beta`].
    pub beta: f32,
    /// Where it comes into the medium, in light rays.
    pub from: f32,
    /// Where it ends.
    pub end: f32,
}

/// The largest value of `beta` for which the integrand has few terms: the tangent of half the angle is 200.
const OPPOSITE: f32 = 1.99;

/// View rays sorted by slices.
#[derive(Debug)]
pub struct SliceRays {
    /// Slice after slice.
    pub rays: Vec<SliceRay>,
    /// Where each slice's begin, and the end of all.
    pub starts: Vec<usize>,
    /// Of each view ray.
    places: Vec<SliceInterpolation>,
}

/// A view ray in rectified coordinates.
#[derive(Clone, Copy, Debug)]
pub struct RectifiedRay {
    beta: f32,
    /// From which `gamma` to which it is in the medium.
    gamma: [f32; 2],
}

impl RectifiedRay {
    /// One of the view rays, as far as `deep` metres into the medium.
    #[inline]
    pub fn new(view: &ViewRays, ray: usize, geometry: &Geometry, deep: f32) -> Self {
        let [near, far] = view.spans[ray];
        let direction = geometry.direction(view.directions[ray]);
        let gamma = [near, far.min(near + deep)].map(|distance| geometry.gamma(direction, distance));
        let gamma = if near < far { gamma } else { Self::NOWHERE };
        Self { beta: beta(direction.along, direction.aside), gamma }
    }

    /// Of a ray that is not in the medium.
    const NOWHERE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

    /// From which to which `gamma` some are in the medium.
    pub fn bounds(all: &[Self]) -> [f32; 2] {
        let joined = |[first, last]: [f32; 2], [from, to]: [f32; 2]| [first.min(from), last.max(to)];
        all.par_iter().map(|seen| seen.gamma).reduce(|| Self::NOWHERE, joined)
    }
}

/// Where a view ray's two slice rays are, and how far it is from the first slice to the second.
#[derive(Clone, Copy, Debug)]
struct SliceInterpolation {
    slots: [u32; 2],
    on: f32,
}

impl SliceInterpolation {
    /// That of a view ray which is in no slice.
    const NONE: Self = Self { slots: [u32::MAX; 2], on: 0.0 };
}

impl SliceRays {
    /// Sorts view rays, but for those that cross fewer than `least` light rays, that are almost opposite to
    /// the light, and that are `left_out`.
    pub fn new(
        view: &ViewRays,
        seen: &[RectifiedRay],
        slices: &Slices,
        (spacing, least): (&Spacing, f32),
        left_out: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let rectified = |ray: usize| {
            let RectifiedRay { beta, gamma } = seen[ray];
            let [from, end] = gamma.map(|gamma| spacing.number(gamma));
            // No number where it is nowhere.
            let crossed = end - from;
            if crossed.is_nan() || crossed < least || beta > OPPOSITE || left_out(ray) {
                return (SliceInterpolation::NONE, SliceRay::default());
            }
            let (before, on) = slices.of(view.at(ray).as_dvec2());
            let slots = [before as u32, slices.after(before) as u32];
            (SliceInterpolation { slots, on }, SliceRay { beta, from, end })
        };
        let (mut places, rays): (Vec<SliceInterpolation>, Vec<SliceRay>) =
            (0..view.count()).into_par_iter().map(rectified).unzip();
        let inside = |place: &&mut SliceInterpolation| place.slots[0] != u32::MAX;
        let mut starts = vec![0; slices.count() + 1];
        for place in places.iter_mut().filter(inside) {
            place.slots.iter().for_each(|slice| starts[*slice as usize + 1] += 1);
        }
        for slice in 0..slices.count() {
            starts[slice + 1] += starts[slice];
        }
        let mut ends = starts.clone();
        let mut sorted = vec![SliceRay::default(); starts[slices.count()]];
        for (place, ray) in places.iter_mut().zip(&rays).filter(|(place, _)| inside(place)) {
            for slot in &mut place.slots {
                let end = &mut ends[*slot as usize];
                sorted[*end] = *ray;
                *slot = *end as u32;
                *end += 1;
            }
        }
        Self { rays: sorted, starts, places }
    }

    /// The value of a view ray, from those of all slice rays; `None` if it is in no slice.
    #[inline]
    pub fn value<const C: usize>(&self, ray: usize, values: &[[f32; C]]) -> Option<[f32; C]> {
        let SliceInterpolation { slots: [first, second], on } = self.places[ray];
        let (first, second) = (values.get(first as usize)?, values.get(second as usize)?);
        Some(std::array::from_fn(|colour| first[colour] + (second[colour] - first[colour]) * on))
    }
}
