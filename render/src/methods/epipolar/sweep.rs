//! The integrals of one slice's view rays (Baran et al. 2010, Figure 6): a sweep over them, from the light away, with a
//! partial-sum tree over the light rays.

use super::factors::Factors;
use super::half_tree::HalfTree;
use super::light_rays::SliceOfLight;
use super::rectified::{Slice, SliceIntegration};
use super::slice_rays::SliceRay;
use super::terminations::{PLACES, Sweep, Terminations, counted};

/// What a sweep works with.
#[derive(Debug)]
pub struct TreeSweep<const W: usize, const C: usize> {
    terminations: Terminations,
    /// What is left of each light ray's light.
    weights: Vec<[f32; C]>,
    tree: HalfTree<W>,
    /// Of each view ray.
    places: Vec<u16>,
    /// View rays in the order of the sweep.
    order: Vec<u32>,
    slots: Vec<u32>,
    /// How far view rays of a place or a later one go at most, in light rays.
    reach: Box<[f32; PLACES]>,
}

impl<const W: usize, const C: usize> Default for TreeSweep<W, C> {
    fn default() -> Self {
        Self {
            terminations: Terminations::default(),
            weights: Vec::new(),
            tree: HalfTree::default(),
            places: Vec::new(),
            order: Vec::new(),
            slots: Vec::new(),
            reach: Box::new([0.0; PLACES]),
        }
    }
}

impl<const W: usize, const C: usize> SliceIntegration<W, C> for TreeSweep<W, C> {
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
        self.plant(factors, |ray, longer| slice.weight(ray, longer));
        let Self { terminations, weights, tree, .. } = self;
        let mut done = 0;
        for ray in &self.order {
            let ray = *ray as usize;
            let until = terminations.until[self.places[ray] as usize] as usize;
            for change in &terminations.changes[done..until] {
                let light = change.ray as usize;
                let weight = weights[light].map(|weight| weight * change.share);
                tree.add(light, &weighted(&factors.light[light], &weight));
            }
            done = until;
            let SliceRay { beta, end } = rays[ray];
            values[ray] = factors.value(&tree.sum_before(end.min(count as f32)), beta);
        }
    }
}

impl<const W: usize, const C: usize> TreeSweep<W, C> {
    /// Builds the tree as it is where the sweep begins.
    #[inline(always)]
    fn plant(&mut self, factors: &Factors<W>, weight: impl Fn(usize, f32) -> [f32; C]) {
        let Terminations { lit, traced, .. } = &self.terminations;
        self.weights.clear();
        let rays = lit.iter().zip(&traced.longer).enumerate();
        let weights = rays.map(|(ray, (lit, longer))| if *lit < 0.0 { [0.0; C] } else { weight(ray, *longer) });
        self.weights.extend(weights);
        let weights = &self.weights;
        self.tree.rebuild(lit.len(), |ray| {
            weighted(&factors.light[ray], &weights[ray].map(|weight| weight * lit[ray].max(0.0)))
        });
    }

    /// Sorts view rays by counting.
    #[inline(always)]
    fn sort(&mut self, rays: &[SliceRay], sweep: Sweep) {
        self.places.clear();
        self.places.extend(rays.iter().map(|ray| (sweep.at(ray.beta) as i32).clamp(0, PLACES as i32 - 1) as u16));
        let slots = counted(&mut self.slots, self.places.iter().map(|place| *place as usize));
        self.reach.fill(0.0);
        self.order.resize(rays.len(), 0);
        for (index, (place, ray)) in self.places.iter().zip(rays).enumerate() {
            let place = *place as usize;
            self.order[slots[place] as usize] = index as u32;
            slots[place] += 1;
            self.reach[place] = self.reach[place].max(ray.end);
        }
        let mut farthest = 0f32;
        for reach in self.reach.iter_mut().rev() {
            farthest = farthest.max(*reach);
            *reach = farthest;
        }
    }
}

/// The terms of `C` colours, each times its colour's weight.
#[inline(always)]
fn weighted<const W: usize, const C: usize>(terms: &[f32; W], weights: &[f32; C]) -> [f32; W] {
    std::array::from_fn(|i| terms[i] * weights[i / (W / C)])
}
