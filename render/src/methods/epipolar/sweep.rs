//! The integrals of one slice's view rays (Baran et al. 2010, Figure 6): a sweep over them, from the light
//! away, with a partial-sum tree over the light rays.

use super::factors::Factors;
use super::half_tree::HalfTree;
use super::light_rays::SliceOfLight;
use super::order::Order;
use super::rectified::{Slice, SliceIntegration};
use super::slice_rays::SliceRay;
use super::terminations::Terminations;

/// What a sweep works with.
#[derive(Debug)]
pub struct TreeSweep<const W: usize, const C: usize> {
    order: Order,
    terminations: Terminations,
    /// What is left of each light ray's light.
    weights: Vec<[f32; C]>,
    tree: HalfTree<W>,
}

impl<const W: usize, const C: usize> Default for TreeSweep<W, C> {
    fn default() -> Self {
        let (order, terminations) = <_>::default();
        Self { order, terminations, weights: Vec::new(), tree: HalfTree::default() }
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
        self.order.sort(rays);
        let count = self.order.crossed(factors.light.len());
        let is_inside = slice.of.ways.view == 0.0;
        self.terminations.gather(&slice.light, count, &self.order, is_inside);
        self.plant(factors, |ray, longer| slice.weight(ray, longer));
        let Self { order, terminations, weights, tree } = self;
        let mut done = 0;
        for ray in &order.rays {
            let ray = *ray as usize;
            let until = terminations.until[order.places[ray] as usize] as usize;
            for change in &terminations.changes[done..until] {
                let light = change.ray as usize;
                let weight = weights[light].map(|weight| weight * change.share);
                tree.add(light, &weighted(&factors.light[light], &weight));
            }
            done = until;
            let SliceRay { beta, end, .. } = rays[ray];
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
        let weights =
            rays.map(|(ray, (lit, longer))| if *lit < 0.0 { [0.0; C] } else { weight(ray, *longer) });
        self.weights.extend(weights);
        let weights = &self.weights;
        self.tree.rebuild(lit.len(), |ray| {
            weighted(&factors.light[ray], &weights[ray].map(|weight| weight * lit[ray].max(0.0)))
        });
    }
}

/// The terms of `C` colours, each times its colour's weight.
#[inline(always)]
fn weighted<const W: usize, const C: usize>(terms: &[f32; W], weights: &[f32; C]) -> [f32; W] {
    std::array::from_fn(|i| terms[i] * weights[i / (W / C)])
}
