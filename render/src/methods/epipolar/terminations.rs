//! When light rays are lit and when no more, in the order in which a sweep over view rays meets it: the
//! `termination_depths` of Baran et al. 2010 (Figure 6), with modes (section 7) and with where light enters the medium.

use super::light_rays::{SliceOfLight, Traced};
use super::prefilter::{Mode, SAMPLES, modes};

/// Places along the sweep at which something can change.
pub const PLACES: usize = 4096;
/// Depths of a light ray that are nearer to each other, in places, are one mode.
const APART: f32 = 2.0;

/// The lit share of light rays that are never lit.
const NEVER: f32 = -1.0;

/// Where a sweep over `beta` begins, and its places.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    first: f32,
    places: f32,
}

impl Sweep {
    /// Between two values.
    pub fn between([low, high]: [f32; 2]) -> Self {
        Self { first: low, places: PLACES as f32 / (high - low).max(1e-7) }
    }

    /// A value in places.
    #[inline(always)]
    pub fn at(self, beta: f32) -> f32 {
        (beta - self.first) * self.places
    }
}

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
    /// Those of the first `count` light rays of a slice. `reach` says of each place how far the view rays there or later
    /// in the sweep go at most, in light rays: what changes beyond is left out, such as where light rays end on a surface
    /// that hides what is behind it.
    #[inline(always)]
    pub fn gather(&mut self, slice: &impl SliceOfLight, count: usize, sweep: Sweep, reach: &[f32; PLACES]) {
        slice.trace(count, &mut self.traced);
        self.measure(count, sweep);
        self.lit.resize(count, 0.0);
        self.unsorted.resize(count * (SAMPLES + 1), <_>::default());
        self.noted = 0;
        for ray in 0..count {
            let [first, last, mean] = [0, 1, 2].map(|i| self.spans[i][ray]);
            let enters = self.traced.enters[ray];
            self.lit[ray] = if last <= enters.max(0.0) {
                NEVER
            } else if enters <= 0.0 && last - first <= APART {
                self.change(mean, ray, -1.0, reach);
                1.0
            } else {
                self.changes_of_modes(ray, reach)
            };
        }
        self.sort();
    }

    /// Turns values of `beta` into places of the sweep; what ends behind it ends together.
    #[inline(always)]
    fn measure(&mut self, count: usize, sweep: Sweep) {
        let Traced { ends: [a, b, c, d], enters, leaves, .. } = &mut self.traced;
        let [a, b, c, d] = [a, b, c, d].map(|ends| &mut ends[..count]);
        let (enters, leaves) = (&mut enters[..count], &mut leaves[..count]);
        let [firsts, lasts, means] = self.spans.each_mut().map(|values| {
            values.resize(count, 0.0);
            &mut values[..count]
        });
        for ray in 0..count {
            let [leaves, enters] = [&mut leaves[ray], &mut enters[ray]].map(|beta| {
                *beta = sweep.at(*beta);
                *beta
            });
            let [a, b, c, d] = [&mut a[ray], &mut b[ray], &mut c[ray], &mut d[ray]].map(|end| {
                *end = sweep.at(*end).min(leaves).min(PLACES as f32);
                *end
            });
            firsts[ray] = a.min(b).min(c.min(d));
            lasts[ray] = a.max(b).max(c.max(d));
            means[ray] = 0.25 * (a + b + c + d);
        }
    }

    /// Notes where a light ray is lit that ends at several places or enters on the way; its share that is lit at the
    /// beginning.
    #[inline(always)]
    fn changes_of_modes(&mut self, ray: usize, reach: &[f32; PLACES]) -> f32 {
        let enters = self.traced.enters[ray];
        let ends = self.traced.ends.each_ref().map(|ends| ends[ray]);
        let mut lit = 0.0;
        modes(ends, APART, |Mode { depth, weight }| {
            if depth > enters.max(0.0) {
                lit += weight;
                self.change(depth, ray, -weight, reach);
            }
        });
        if enters <= 0.0 {
            return lit;
        }
        self.change(enters, ray, lit, reach);
        0.0
    }

    /// Notes a change unless no view ray sees it.
    #[inline(always)]
    fn change(&mut self, place: f32, ray: usize, share: f32, reach: &[f32; PLACES]) {
        // View rays are on average in the middle of their place.
        let place = ((place + 0.5) as i32 as usize).min(PLACES);
        let is_seen = place < PLACES && (ray as f32) < reach[place % PLACES];
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

/// How many come before each place; who puts each in its slot, and moves the slot on, has how many there are up to it.
#[inline(always)]
pub fn counted(counts: &mut Vec<u32>, places: impl Iterator<Item = usize>) -> &mut [u32; PLACES] {
    counts.clear();
    counts.resize(PLACES, 0);
    places.for_each(|place| counts[place] += 1);
    let mut before = 0;
    for count in counts.iter_mut() {
        (*count, before) = (before, before + *count);
    }
    counts.as_mut_array().expect("one of each place")
}
