//! The integrals of one slice's view rays by what is lit of each, in closed form (Max 1986, "Atmospheric
//! Illumination and Shadows"): for distant lamps whose rays are alike. A sweep over the view rays keeps which
//! samples of light rays are lit, a bit each; the lit segments of a view ray are read from it.

use super::super::shafts::{Faces, LampPosition};
use super::factors::Factors;
use super::geometry::angle;
use super::light_rays::{SliceOfLight, Traced};
use super::order::{Order, PLACES, counted};
use super::prefilter::SAMPLES;
use super::rectified::{Slice, SliceIntegration};
use super::slice_rays::SliceRay;

/// What a sweep works with.
#[derive(Debug, Default)]
pub struct SegmentSweep {
    order: Order,
    traced: Traced,
    lit: BitSet,
    /// Samples whose light ends, with their places, and in the order of the sweep.
    unsorted: Vec<(u32, u32)>,
    changes: Vec<u32>,
    /// How many changes are up to each place of the sweep, it included.
    until: Vec<u32>,
}

/// A set of small numbers.
#[derive(Debug, Default)]
struct BitSet(Vec<u64>);

impl<const C: usize> SliceIntegration<C, C> for SegmentSweep {
    #[inline(always)]
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        _: &Factors<C>,
        values: &mut [[f32; C]],
    ) {
        let of = slice.of;
        let (Some(bounds), LampPosition::Distant(towards)) = (of.haze.bounds(), of.lit.lamp.position) else {
            return;
        };
        self.order.sort(rays);
        slice.light.trace(self.order.crossed(of.spacing.count), &mut self.traced);
        self.gather();
        let mut done = 0;
        for ray in &self.order.rays {
            let ray = *ray as usize;
            let until = self.until[self.order.places[ray] as usize] as usize;
            self.changes[done..until].iter().for_each(|sample| self.lit.flip(*sample as usize));
            done = until;
            let SliceRay { beta, from, end } = rays[ray];
            let [cosine, sine] = angle(beta.into()).map(|value| value as f32);
            let direction = of.geometry.axis * cosine + slice.outwards * sine;
            let faces = Faces::new(bounds, of.geometry.eye, direction, towards);
            self.lit.runs(end * SAMPLES as f32, |run| {
                let run = run.map(|sample| of.spacing.gamma((sample / SAMPLES as f32).max(from)) / sine);
                for (colour, value) in values[ray].iter_mut().enumerate() {
                    *value += sine * faces.integral(of.haze.extinction[colour], of.ways.view, run);
                }
            });
        }
    }
}

impl SegmentSweep {
    /// Notes which samples are lit where the sweep begins, and in its order where each is no more. Where they
    /// enter the medium matters only if they end before, since view rays are only followed in it.
    #[inline(always)]
    fn gather(&mut self) {
        let sweep = self.order.sweep;
        let count = self.traced.ends[0].len();
        self.lit.empty(count * SAMPLES);
        self.unsorted.clear();
        for ray in 0..count {
            for (sample, ends) in self.traced.ends.iter().enumerate() {
                let sample = ray * SAMPLES + sample;
                // View rays are on average in the middle of their place.
                let end = (sweep.at(ends[ray]) + 0.5).max(0.0) as u32;
                if ends[ray] <= self.traced.enters[ray] || end == 0 {
                    continue;
                }
                self.lit.flip(sample);
                if end < PLACES as u32 {
                    self.unsorted.push((end, sample as u32));
                }
            }
        }
        let slots = counted(&mut self.until, self.unsorted.iter().map(|(place, _)| *place as usize));
        self.changes.resize(self.unsorted.len(), 0);
        for (place, sample) in &self.unsorted {
            let slot = &mut slots[*place as usize];
            self.changes[*slot as usize] = *sample;
            *slot += 1;
        }
    }
}

impl BitSet {
    /// Begins anew, for so many numbers.
    fn empty(&mut self, numbers: usize) {
        self.0.clear();
        self.0.resize(numbers.div_ceil(64), 0);
    }

    /// Puts a number in or takes it out.
    #[inline(always)]
    fn flip(&mut self, number: usize) {
        self.0[number / 64] ^= 1 << (number % 64);
    }

    /// Calls `run` with the first number and the end of each run of numbers that are in it, up to `end`.
    #[inline(always)]
    fn runs(&self, end: f32, mut run: impl FnMut([f32; 2])) {
        let words = (end as usize / 64 + 1).min(self.0.len());
        let (mut begin, mut before) = (None, 0);
        for (word, bits) in self.0[..words].iter().enumerate() {
            // Numbers that are in where the one before is not, or the other way round.
            let mut edges = bits ^ (bits << 1 | before);
            before = bits >> 63;
            while edges != 0 {
                let edge = (word * 64) as f32 + edges.trailing_zeros() as f32;
                edges &= edges - 1;
                begin = match begin {
                    None => Some(edge),
                    Some(begin) => {
                        if begin < end {
                            run([begin, edge.min(end)]);
                        }
                        None
                    }
                };
            }
        }
        if let Some(begin) = begin.filter(|begin| *begin < end) {
            run([begin, end.min((words * 64) as f32)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_those_of_a_walk_over_all_numbers(
            bits in prop::collection::vec(prop::bool::weighted(0.8), 1..300),
            end in 0.01f32..1.0,
        ) {
            let end = end * bits.len() as f32;
            let mut set = BitSet::default();
            set.empty(999);
            set.flip(7);
            set.empty(bits.len());
            bits.iter().enumerate().filter(|(_, is_in)| **is_in).for_each(|(number, _)| set.flip(number));
            let (mut found, mut last) = (vec![0.0; bits.len()], -1.0);
            set.runs(end, |[from, to]| {
                assert!(from > last && to > from, "runs are in order and apart");
                last = to;
                for (number, found) in found.iter_mut().enumerate() {
                    *found += (to.min(number as f32 + 1.0) - from.max(number as f32)).max(0.0);
                }
            });
            for (number, is_in) in bits.into_iter().enumerate() {
                let part = (end - number as f32).clamp(0.0, 1.0);
                let expected = if is_in { part } else { 0.0 };
                prop_assert!((found[number] - expected).abs() < 1e-4, "{number}: {}", found[number]);
            }
        }
    }
}
