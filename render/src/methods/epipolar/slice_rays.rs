//! View rays in rectified coordinates, slice by slice, and back.
//!
//! Where Baran et al. resample the camera's depths into slices and the result back into the image, each pixel asks both
//! slices that it lies between for its own angle and its own depth, and takes the mean by its distance to them. That
//! costs as many questions as a depth map of twice the pixels, and edges in depth stay where they are.

use super::super::shafts::ViewRays;
use super::geometry::{Geometry, beta};
use super::light_rays::Spacing;
use super::slices::Slices;
use rayon::prelude::*;

/// A view ray as a slice sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct SliceRay {
    /// See [`beta`].
    pub beta: f32,
    /// `gamma` of its end, in light rays.
    pub end: f32,
}

/// View rays sorted by slices.
#[derive(Debug)]
pub struct SliceRays {
    /// Slice after slice.
    pub rays: Vec<SliceRay>,
    /// Where each slice's begin, and the end of all.
    pub starts: Vec<usize>,
    /// Of each view ray.
    places: Vec<Place>,
}

/// How far view rays are followed.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// The light rays.
    pub spacing: Spacing,
    /// View rays that cross fewer light rays are in no slice.
    pub least: f32,
    /// Metres in the medium after which nothing is seen.
    pub deep: f32,
}

/// Where a view ray's two slice rays are, and how far it is from the first slice to the second.
#[derive(Clone, Copy, Debug)]
struct Place {
    slots: [u32; 2],
    on: f32,
}

impl Place {
    /// That of a view ray which is in no slice.
    const NONE: Self = Self { slots: [u32::MAX; 2], on: 0.0 };
}

impl SliceRays {
    /// Sorts view rays, but for those that are `left_out`.
    pub fn new(
        view: &ViewRays,
        geometry: &Geometry,
        slices: &Slices,
        reach: Reach,
        left_out: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let rectified = |ray: usize| {
            let [near, far] = view.spans[ray];
            let direction = geometry.direction(view.directions[ray]);
            let number = |distance: f32| reach.spacing.number(geometry.gamma(direction, distance));
            let end = number(far.min(near + reach.deep));
            if near >= far || end - number(near) < reach.least || left_out(ray) {
                return (Place::NONE, SliceRay::default());
            }
            let (before, on) = slices.of(view.at(ray).as_dvec2());
            let slots = [before as u32, slices.after(before) as u32];
            (Place { slots, on }, SliceRay { beta: beta(direction.along, direction.aside), end })
        };
        let (mut places, rays): (Vec<Place>, Vec<SliceRay>) =
            (0..view.count()).into_par_iter().map(rectified).unzip();
        let inside = |place: &&mut Place| place.slots[0] != u32::MAX;
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
        let Place { slots: [first, second], on } = self.places[ray];
        let (first, second) = (values.get(first as usize)?, values.get(second as usize)?);
        Some(std::array::from_fn(|colour| first[colour] + (second[colour] - first[colour]) * on))
    }
}
