//! The view rays of a slice in the order of a sweep over them, from the light away, sorted by counting.

use super::slice_rays::SliceRay;

/// Places along a sweep at which something can change.
pub const PLACES: usize = 4096;

/// Where a sweep over `beta` begins, and its places.
#[derive(Clone, Copy, Debug, Default)]
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

/// View rays by places.
#[derive(Debug, Default)]
pub struct Order {
    /// The sweep over them.
    pub sweep: Sweep,
    /// The place of each view ray.
    pub places: Vec<u16>,
    /// View rays, first those of the first place.
    pub rays: Vec<u32>,
    /// How far view rays of a place or a later one go at most, in light rays.
    pub reach: Vec<f32>,
    slots: Vec<u32>,
}

impl Order {
    /// Sorts the view rays of another slice.
    #[inline(always)]
    pub fn sort(&mut self, rays: &[SliceRay]) {
        let betas = rays.iter().map(|ray| ray.beta);
        let sweep =
            Sweep::between(betas.fold([2.0, 0.0], |[low, high], beta| [beta.min(low), beta.max(high)]));
        self.sweep = sweep;
        self.places.clear();
        self.places
            .extend(rays.iter().map(|ray| (sweep.at(ray.beta) as i32).clamp(0, PLACES as i32 - 1) as u16));
        let slots = counted(&mut self.slots, self.places.iter().map(|place| *place as usize));
        self.reach.clear();
        self.reach.resize(PLACES, 0.0);
        self.rays.resize(rays.len(), 0);
        for (index, (place, ray)) in self.places.iter().zip(rays).enumerate() {
            let place = *place as usize;
            self.rays[slots[place] as usize] = index as u32;
            slots[place] += 1;
            self.reach[place] = self.reach[place].max(ray.end);
        }
        let mut farthest = 0f32;
        for reach in self.reach.iter_mut().rev() {
            farthest = farthest.max(*reach);
            *reach = farthest;
        }
    }

    /// How many of `most` light rays the farthest view ray meets.
    pub fn crossed(&self, most: usize) -> usize {
        (self.reach[0] as usize + 1).min(most)
    }
}

/// How many come before each place; who puts each in its slot, and moves the slot on, has how many there are
/// up to it.
#[inline(always)]
pub fn counted(counts: &mut Vec<u32>, places: impl Iterator<Item = usize>) -> &mut [u32] {
    counts.clear();
    counts.resize(PLACES, 0);
    places.for_each(|place| counts[place] += 1);
    let mut before = 0;
    for count in counts.iter_mut() {
        (*count, before) = (before, before + *count);
    }
    counts
}
