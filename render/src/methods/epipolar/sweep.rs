//! The integrals of one slice's view rays (Baran et al. 2010, Figure 6): a sweep over them, from the light away, with a
//! partial-sum tree over the light rays.

use super::factors::Factors;
use super::half_tree::HalfTree;
use super::light_rays::SliceOfLight;
use super::rectified::{Slice, SliceIntegration};
use super::slice_rays::SliceRay;
use super::terminations::{Change, PLACES, Sweep, Terminations};

/// What a sweep works with.
#[derive(Debug, Default)]
pub struct TreeSweep<const W: usize> {
    terminations: Terminations,
    /// The tree's elements where all light rays are lit.
    full: Vec<[f32; W]>,
    elements: Vec<[f32; W]>,
    tree: HalfTree<W>,
    /// View rays in the order of the sweep, with their places.
    order: Vec<[u32; 2]>,
    starts: Vec<u32>,
    /// How far view rays of a place or a later one go at most, in light rays.
    reach: Vec<f32>,
}

impl<const W: usize, const C: usize> SliceIntegration<W, C> for TreeSweep<W> {
    #[inline(always)]
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        factors: &Factors<W>,
        values: &mut [[f32; C]],
    ) {
        let bounds = |value: fn(&SliceRay) -> f32| {
            let all = rays.iter().map(value);
            all.fold([f32::INFINITY, 0.0f32], |[low, high], value| [low.min(value), high.max(value)])
        };
        let sweep = Sweep::between(bounds(|ray| ray.beta));
        let [_, farthest] = bounds(|ray| ray.end);
        let count = (farthest as usize + 1).min(factors.light.len());
        self.sort(rays, sweep);
        self.terminations.gather(&slice.light, count, sweep, &self.reach);
        self.plant(factors, |ray, longer| slice.weight::<C>(ray, longer));
        let mut changes = self.terminations.changes.iter().peekable();
        for [place, ray] in &self.order {
            while let Some(Change { ray, share, .. }) = changes.next_if(|change| change.place <= *place) {
                let change = self.full[*ray as usize].map(|value| value * share);
                self.tree.add(*ray as usize, &change);
            }
            let SliceRay { beta, end } = rays[*ray as usize];
            let sums = self.tree.sum_before(end.min(count as f32));
            values[*ray as usize] = factors.value(&sums, beta);
        }
    }
}

impl<const W: usize> TreeSweep<W> {
    /// Builds the tree as it is where the sweep begins.
    #[inline(always)]
    fn plant<const C: usize>(&mut self, factors: &Factors<W>, weight: impl Fn(usize, f32) -> [f32; C]) {
        self.full.clear();
        self.elements.clear();
        let Terminations { lit, traced, .. } = &self.terminations;
        let rays = factors.light.iter().zip(lit.iter().zip(&traced.longer)).enumerate();
        for (ray, (light, (lit, longer))) in rays {
            if *lit < 0.0 {
                self.full.push([0.0; W]);
                self.elements.push([0.0; W]);
                continue;
            }
            let weight = weight(ray, *longer);
            let full: [f32; W] = std::array::from_fn(|i| light[i] * weight[i / (W / C)]);
            self.full.push(full);
            self.elements.push(full.map(|value| value * lit));
        }
        self.tree.rebuild(&self.elements);
    }

    /// Sorts view rays by counting.
    #[inline(always)]
    fn sort(&mut self, rays: &[SliceRay], sweep: Sweep) {
        let place = |ray: &SliceRay| (sweep.at(ray.beta) as i32).clamp(0, PLACES as i32 - 1) as usize;
        self.starts.clear();
        self.starts.resize(PLACES + 1, 0);
        rays.iter().for_each(|ray| self.starts[place(ray) + 1] += 1);
        for at in 0..PLACES {
            self.starts[at + 1] += self.starts[at];
        }
        self.reach.clear();
        self.reach.resize(PLACES, 0.0);
        self.order.resize(rays.len(), [0; 2]);
        for (index, ray) in rays.iter().enumerate() {
            let place = place(ray);
            let slot = &mut self.starts[place];
            self.order[*slot as usize] = [place as u32, index as u32];
            *slot += 1;
            self.reach[place] = self.reach[place].max(ray.end);
        }
        let mut farthest = 0f32;
        for reach in self.reach.iter_mut().rev() {
            farthest = farthest.max(*reach);
            *reach = farthest;
        }
    }
}
