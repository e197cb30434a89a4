//! When light rays are lit and when no more, in the order in which a sweep over view rays meets it: the
//! `termination_depths` of Baran et al. 2010 (Figure 6), with modes (section 7) and with where light enters
//! the medium.

use super::light_rays::{SliceOfLight, Traced};
use super::order::{Order, PLACES, Sweep, counted};
use super::prefilter::{Mode, SAMPLES, modes};

/// Depths of a light ray that are nearer to each other, in places, are one mode.
const APART: f32 = 2.0;

/// The lit share of light rays that are never lit.
const NEVER: f32 = -1.0;

/// A change of a light ray's share that is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Which light ray.
    pub ray: u32,
    /// By how much.
    pub share: f32,
}

/// The changes of one slice.
#[derive(Debug, Default)]
pub struct Terminations {
    /// Share of each light ray that is lit where the sweep begins; negative of one that never is.
    pub lit: Vec<f32>,
    /// The light rays.
    pub traced: Traced,
    /// In the order of the sweep.
    pub changes: Vec<Change>,
    /// How many are up to each place of the sweep, it included.
    pub until: Vec<u32>,
    /// Least, greatest and mean place at which each light ray's light ends.
    spans: [Vec<f32>; 3],
    /// Changes with their places, of which `noted` count.
    unsorted: Vec<(u32, Change)>,
    noted: usize,
}

impl Terminations {
    /// Those of the first `count` light rays of a slice. What changes beyond the view rays that are there or
    /// later in the sweep is left out, such as where light rays end on a surface that hides what is behind
    /// it. If the eye is inside the medium, view rays do not ask for light before it enters or after it
    /// leaves.
    #[inline(always)]
    pub fn gather(&mut self, slice: &impl SliceOfLight, count: usize, order: &Order, is_inside: bool) {
        slice.trace(count, &mut self.traced);
        self.measure(count, order.sweep, is_inside);
        let reach = &order.reach[..PLACES];
        self.lit.resize(count, 0.0);
        self.unsorted.resize(count * (SAMPLES + 1), <_>::default());
        self.noted = 0;
        for ray in 0..count {
            let [first, last, mean] = [0, 1, 2].map(|i| self.spans[i][ray]);
            let enters = self.traced.enters[ray];
            self.lit[ray] = if last <= enters.max(0.0) {
                NEVER
            } else if (is_inside || enters <= 0.0) && last - first <= APART {
                self.change(mean, ray, -1.0, reach);
                1.0
            } else {
                self.changes_of_modes(ray, reach, is_inside)
            };
        }
        self.sort();
    }

    /// Turns values of `beta` into places of the sweep; what ends behind it ends together.
    #[inline(always)]
    fn measure(&mut self, count: usize, sweep: Sweep, is_inside: bool) {
        let Traced { ends: [a, b, c, d], enters, leaves, .. } = &mut self.traced;
        let [a, b, c, d] = [a, b, c, d].map(|ends| &mut ends[..count]);
        let (enters, leaves) = (&mut enters[..count], &leaves[..count]);
        let [firsts, lasts, means] = self.spans.each_mut().map(|values| {
            values.resize(count, 0.0);
            &mut values[..count]
        });
        for ray in 0..count {
            enters[ray] = sweep.at(enters[ray]);
            let leaves = if is_inside { PLACES as f32 } else { sweep.at(leaves[ray]).min(PLACES as f32) };
            let [a, b, c, d] = [&mut a[ray], &mut b[ray], &mut c[ray], &mut d[ray]].map(|end| {
                *end = sweep.at(*end).min(leaves);
                *end
            });
            firsts[ray] = a.min(b).min(c.min(d));
            lasts[ray] = a.max(b).max(c.max(d));
            means[ray] = 0.25 * (a + b + c + d);
        }
    }

    /// Notes where a light ray is lit that ends at several places or enters on the way; its share that is lit
    /// at the beginning.
    #[inline(always)]
    fn changes_of_modes(&mut self, ray: usize, reach: &[f32], is_inside: bool) -> f32 {
        let enters = self.traced.enters[ray];
        let ends = self.traced.ends.each_ref().map(|ends| ends[ray]);
        let mut lit = 0.0;
        modes(ends, APART, |Mode { depth, weight }| {
            if depth > enters.max(0.0) {
                lit += weight;
                self.change(depth, ray, -weight, reach);
            }
        });
        if is_inside || enters <= 0.0 {
            return lit;
        }
        self.change(enters, ray, lit, reach);
        0.0
    }

    /// Notes a change unless no view ray sees it.
    #[inline(always)]
    fn change(&mut self, place: f32, ray: usize, share: f32, reach: &[f32]) {
        // View rays are on average in the middle of their place.
        let place = (place + 0.5) as i32 as usize;
        let is_seen = reach.get(place).is_some_and(|reach| (ray as f32) < *reach);
        self.unsorted[self.noted] = (place as u32, Change { ray: ray as u32, share });
        self.noted += usize::from(is_seen);
    }

    /// Sorts by counting.
    #[inline(always)]
    fn sort(&mut self) {
        let unsorted = &self.unsorted[..self.noted];
        let begins = counted(&mut self.until, unsorted.iter().map(|(place, _)| *place as usize));
        self.changes.resize(unsorted.len(), Change::default());
        for (place, change) in unsorted {
            let slot = &mut begins[*place as usize];
            self.changes[*slot as usize] = *change;
            *slot += 1;
        }
    }
}
