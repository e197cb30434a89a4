//! What the lit runs of light rays send to a view ray.

use super::super::epipolar::{Factors, Slice, SliceIntegration, SliceOfLight, SliceRay, angle};
use super::super::shafts::{Faces, Place};
use super::mipmap::{Mipmap, Node};

/// Samples of a light ray's depth.
const SAMPLES: f32 = super::super::epipolar::SAMPLES as f32;

/// Of distant lamps whose rays are alike: exact.
#[derive(Debug, Default)]
pub struct ClosedForm {
    map: Mipmap,
}

/// Of all others: the integrand's terms, summed up from the first light ray on.
#[derive(Debug, Default)]
pub struct PrefixSums<const W: usize> {
    map: Mipmap,
    /// Of each light ray, the sum of those before it; one more at the end.
    sums: Vec<[f32; W]>,
}

/// How many light rays the farthest view ray of a slice crosses.
fn crossed(rays: &[SliceRay], most: usize) -> usize {
    let farthest = rays.iter().map(|ray| ray.end).fold(0.0, f32::max);
    (farthest as usize + 1).min(most)
}

/// Fills the mipmap with the first `count` light rays.
fn gather(map: &mut Mipmap, light: &impl SliceOfLight, count: usize) {
    map.rebuild((0..count).flat_map(|ray| {
        let [enters, leaves] = light.passage(ray).between;
        light.ends(ray).map(|end| Node::sample([enters, end.min(leaves)]))
    }));
}

impl<const C: usize> SliceIntegration<C, C> for ClosedForm {
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        _: &Factors<C>,
        values: &mut [[f32; C]],
    ) {
        let of = slice.of;
        let (Some(bounds), Place::Distant(towards)) = (of.haze.bounds(), of.lit.lamp.place) else { return };
        gather(&mut self.map, &slice.light, crossed(rays, of.light_rays));
        for (ray, value) in rays.iter().zip(values) {
            let [cosine, sine] = angle(ray.beta.into()).map(|value| value as f32);
            let faces = Faces::new(bounds, of.geometry.eye, of.geometry.axis * cosine + slice.outwards * sine, towards);
            let metres = of.step / (SAMPLES * sine);
            self.map.lit_runs(ray.beta, ray.end * SAMPLES, |run| {
                let run = run.map(|sample| sample * metres);
                for (colour, value) in value.iter_mut().enumerate() {
                    *value += sine * faces.integral(of.haze.extinction[colour], of.ways.view, run);
                }
            });
        }
    }
}

impl<const W: usize, const C: usize> SliceIntegration<W, C> for PrefixSums<W> {
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        factors: &Factors<W>,
        values: &mut [[f32; C]],
    ) {
        let count = crossed(rays, factors.light.len());
        gather(&mut self.map, &slice.light, count);
        self.sum_up(slice, factors, count);
        for (ray, value) in rays.iter().zip(values) {
            let mut sums = [0.0; W];
            self.map.lit_runs(ray.beta, ray.end * SAMPLES, |[from, to]| {
                let [from, to] = [self.sum_before(from / SAMPLES), self.sum_before(to / SAMPLES)];
                for (sum, (from, to)) in sums.iter_mut().zip(from.into_iter().zip(to)) {
                    *sum += to - from;
                }
            });
            *value = factors.value(&sums, ray.beta);
        }
    }
}

impl<const W: usize> PrefixSums<W> {
    fn sum_up<const C: usize, L: SliceOfLight>(&mut self, slice: &Slice<'_, L>, factors: &Factors<W>, count: usize) {
        self.sums.clear();
        let mut sum = [0.0; W];
        for (ray, light) in factors.light.iter().take(count).enumerate() {
            self.sums.push(sum);
            let weight = slice.weight::<C>(ray, slice.light.passage(ray).longer);
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum += light[i] * weight[i / (W / C)];
            }
        }
        self.sums.push(sum);
    }

    /// Sum of the light rays before a fractional one.
    #[inline(always)]
    fn sum_before(&self, end: f32) -> [f32; W] {
        let whole = (end as usize).min(self.sums.len() - 2);
        let [before, after] = [&self.sums[whole], &self.sums[whole + 1]];
        std::array::from_fn(|i| before[i] + (after[i] - before[i]) * (end - whole as f32))
    }
}
