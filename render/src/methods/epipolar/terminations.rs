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

/// A light ray's share that is lit from a place on, or no more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Where in the sweep.
    pub place: u32,
    /// Which light ray.
    pub ray: u32,
    /// By how much its lit share changes.
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
    unsorted: Vec<Change>,
    starts: Vec<u32>,
}

impl Terminations {
    /// Those of the first `count` light rays of a slice. `reach` says of each place how far the view rays there or later
    /// in the sweep go at most, in light rays: what changes beyond is left out, such as where light rays end on a surface
    /// that hides what is behind it.
    #[inline(always)]
    pub fn gather(&mut self, slice: &impl SliceOfLight, count: usize, sweep: Sweep, reach: &[f32]) {
        slice.trace(count, &mut self.traced);
        self.lit.clear();
        self.unsorted.clear();
        let traced = std::mem::take(&mut self.traced);
        let ends = traced.ends.as_chunks::<SAMPLES>().0;
        for (ray, (ends, (enters, leaves))) in
            ends.iter().zip(traced.enters.iter().zip(&traced.leaves)).enumerate()
        {
            let [enters, leaves] = [*enters, *leaves].map(|beta| sweep.at(beta));
            let ends = ends.map(|beta| sweep.at(beta).min(leaves));
            let lit = self.push(ray as u32, enters, ends, reach);
            self.lit.push(lit);
        }
        self.traced = traced;
        self.sort();
    }

    /// Notes where a light ray is lit; its lit share at the beginning, negative if it is never lit.
    #[inline(always)]
    fn push(&mut self, ray: u32, enters: f32, ends: [f32; SAMPLES], reach: &[f32]) -> f32 {
        let [a, b, c, d] = ends;
        let (first, last) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let begin = enters.max(0.0);
        if last <= begin {
            return NEVER;
        }
        if enters <= 0.0 && first >= (PLACES - 1) as f32 {
            return 1.0;
        }
        if last - first <= APART && first > begin {
            self.change(0.25 * (a + b + c + d), ray, -1.0, reach);
            return self.begun(enters, ray, 1.0, reach);
        }
        let mut lit = 0.0;
        modes(ends, APART, |Mode { depth, weight }| {
            if depth > begin {
                lit += weight;
                self.change(depth, ray, -weight, reach);
            }
        });
        self.begun(enters, ray, lit, reach)
    }

    /// Notes that a share of a light ray is lit from where it enters; what is lit where the sweep begins.
    #[inline(always)]
    fn begun(&mut self, enters: f32, ray: u32, lit: f32, reach: &[f32]) -> f32 {
        if enters <= 0.0 || lit == 0.0 {
            return lit;
        }
        self.change(enters, ray, lit, reach);
        0.0
    }

    /// Notes a change unless no view ray sees it.
    #[inline(always)]
    fn change(&mut self, place: f32, ray: u32, share: f32, reach: &[f32]) {
        // View rays are on average in the middle of their place.
        let place = (place + 0.5) as i32 as usize;
        if reach.get(place).is_some_and(|reach| (ray as f32) < *reach) {
            self.unsorted.push(Change { place: place as u32, ray, share });
        }
    }

    /// Sorts by counting.
    #[inline(always)]
    fn sort(&mut self) {
        self.starts.clear();
        self.starts.resize(PLACES + 1, 0);
        for change in &self.unsorted {
            self.starts[change.place as usize + 1] += 1;
        }
        for place in 0..PLACES {
            self.starts[place + 1] += self.starts[place];
        }
        self.changes.resize(self.unsorted.len(), Change::default());
        for change in &self.unsorted {
            let slot = &mut self.starts[change.place as usize];
            self.changes[*slot as usize] = *change;
            *slot += 1;
        }
    }
}
