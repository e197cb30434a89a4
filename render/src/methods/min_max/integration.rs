//! What the lit runs of light rays send to a view ray.

use super::super::epipolar::{
    Factors, SAMPLES, Slice, SliceIntegration, SliceOfLight, SliceRay, Traced, angle,
};
use super::super::shafts::{Faces, LampPosition};
use super::mipmap::{Mipmap, Node};

/// Samples of a light ray's depth.
const PER_RAY: f32 = SAMPLES as f32;

/// Of distant lamps whose rays are alike: exact.
#[derive(Debug, Default)]
pub struct ClosedForm {
    traced: Traced,
    map: Mipmap,
}

/// Of all others: the integrand's terms, summed up from the first light ray on.
#[derive(Debug, Default)]
pub struct PrefixSums<const W: usize> {
    traced: Traced,
    map: Mipmap,
    /// Of each light ray, the sum of those before it; one more at the end.
    sums: Vec<[f32; W]>,
}

/// How many light rays the farthest view ray of a slice crosses.
#[inline(always)]
fn crossed(rays: &[SliceRay], most: usize) -> usize {
    let farthest = rays.iter().map(|ray| ray.end).fold(0.0, f32::max);
    (farthest as usize + 1).min(most)
}

/// The samples of light rays for the mipmap, from where they enter the medium.
#[inline(always)]
fn samples(traced: &Traced) -> impl Iterator<Item = Node> {
    (0..traced.enters.len() * SAMPLES).map(|sample| {
        let ray = sample / SAMPLES;
        Node::sample([traced.enters[ray], traced.ends[sample % SAMPLES][ray].min(traced.leaves[ray])])
    })
}

/// The same, lit from the first view ray on wherever they leave the medium, since view rays are only followed
/// in it; but for those that end before they enter it.
#[inline(always)]
fn whole_samples(traced: &Traced) -> impl Iterator<Item = Node> {
    (0..traced.enters.len() * SAMPLES).map(|sample| {
        let end = traced.ends[sample % SAMPLES][sample / SAMPLES];
        let is_ever_lit = end > traced.enters[sample / SAMPLES];
        Node::sample([f32::NEG_INFINITY, if is_ever_lit { end } else { f32::NEG_INFINITY }])
    })
}

impl<const C: usize> SliceIntegration<C, C> for ClosedForm {
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
        slice.light.trace(crossed(rays, of.spacing.count), &mut self.traced);
        self.map.rebuild(whole_samples(&self.traced));
        for (ray, value) in rays.iter().zip(values) {
            let [cosine, sine] = angle(ray.beta.into()).map(|value| value as f32);
            let faces = Faces::new(
                bounds,
                of.geometry.eye,
                of.geometry.axis * cosine + slice.outwards * sine,
                towards,
            );
            self.map.lit_runs(ray.beta, ray.end * PER_RAY, |run| {
                let run = run.map(|sample| of.spacing.gamma((sample / PER_RAY).max(ray.from)) / sine);
                for (colour, value) in value.iter_mut().enumerate() {
                    *value += sine * faces.integral(of.haze.extinction[colour], of.ways.view, run);
                }
            });
        }
    }
}

impl<const W: usize, const C: usize> SliceIntegration<W, C> for PrefixSums<W> {
    #[inline(always)]
    fn integrate<L: SliceOfLight>(
        &mut self,
        slice: &Slice<'_, L>,
        rays: &[SliceRay],
        factors: &Factors<W>,
        values: &mut [[f32; C]],
    ) {
        let count = crossed(rays, factors.light.len());
        slice.light.trace(count, &mut self.traced);
        self.map.rebuild(samples(&self.traced));
        self.sum_up::<C, L>(slice, factors);
        for (ray, value) in rays.iter().zip(values) {
            let mut sums = [0.0; W];
            self.map.lit_runs(ray.beta, ray.end * PER_RAY, |[from, to]| {
                let [from, to] = [self.sum_before(from / PER_RAY), self.sum_before(to / PER_RAY)];
                for (sum, (from, to)) in sums.iter_mut().zip(from.into_iter().zip(to)) {
                    *sum += to - from;
                }
            });
            *value = factors.value(&sums, ray.beta);
        }
    }
}

impl<const W: usize> PrefixSums<W> {
    #[inline(always)]
    fn sum_up<const C: usize, L: SliceOfLight>(&mut self, slice: &Slice<'_, L>, factors: &Factors<W>) {
        self.sums.clear();
        let mut sum = [0.0; W];
        for (ray, light) in factors.light.iter().take(self.traced.longer.len()).enumerate() {
            self.sums.push(sum);
            // No view ray in the medium meets the others, whose way there is none.
            if self.traced.leaves[ray] <= self.traced.enters[ray] {
                continue;
            }
            let weight = slice.weight::<C>(ray, self.traced.longer[ray]);
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
