//! What a network costs, counted and not measured: multiply-adds, and numbers that must move.

use crate::{BlockSource, Filter, Head, Layer, NetSpec};

/// What a layer costs on one image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Multiplications with additions; two floating-point operations each.
    pub multiply_adds: u64,
    /// Numbers of feature maps that it reads or writes at least once: what the layers that it reads have
    /// made, what it makes, pooled where the next level reads it so.
    pub maps: u64,
    /// Other such numbers: the network's input, its image, weights, and what a filter works on. 32-bit floats
    /// where the network runs in WGSL, however it keeps its maps.
    pub others: u64,
}

impl Cost {
    /// All numbers that are read or written at least once.
    pub const fn numbers(&self) -> u64 {
        self.maps + self.others
    }
}

impl std::iter::Sum for Cost {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::default(), |sum, cost| Self {
            multiply_adds: sum.multiply_adds + cost.multiply_adds,
            maps: sum.maps + cost.maps,
            others: sum.others + cost.others,
        })
    }
}

impl NetSpec {
    /// The cost of every layer on an image of a size; the last one's with that of the filter.
    pub fn costs(&self, height: usize, width: usize) -> Vec<Cost> {
        let layers = self.layers();
        let pixels = |level: usize| {
            [height, width]
                .map(|size| size.next_multiple_of(self.alignment()) >> level)
                .iter()
                .product::<usize>()
        };
        let cost = |layer: &Layer| {
            let frame = pixels(layer.level);
            let made = layer.outputs * frame;
            let read = match layer.source {
                BlockSource::Input | BlockSource::Folded => 0,
                BlockSource::Plain(_) | BlockSource::Pooled(_) => layer.inputs * frame,
                BlockSource::Joined { coarse, skip, .. } => {
                    layers[coarse].outputs * pixels(layer.level + 1) + layers[skip].outputs * frame
                }
            };
            let input = if layer.source.is_input() { self.input_channels() * height * width } else { 0 };
            let is_pooled = layers
                .iter()
                .any(|other| matches!(other.source, BlockSource::Pooled(of) if layers[of] == *layer));
            let pooled = if is_pooled { layer.outputs * pixels(layer.level + 1) } else { 0 };
            let (map, image) = if layer.activation { (made, 0) } else { (0, made) };
            let weights = layer.weight_count();
            Cost {
                multiply_adds: ((weights - layer.outputs) * frame) as u64,
                maps: (read + map + pooled) as u64,
                others: (input + image + weights) as u64,
            }
        };
        let mut costs: Vec<Cost> = layers.iter().map(cost).collect();
        let filter = match self.head {
            Head::Image => None,
            Head::Filter(filter) => Some(filter),
            Head::Correction(correction) => Some(correction.filter()),
        };
        if let (Some(filter), Some(last)) = (filter, costs.last_mut()) {
            *last = [*last, self.filter_cost(filter, height * width)].into_iter().sum();
        }
        costs
    }

    /// A tap is a weighted sum of the light, and on coarser levels of four pixels between which the light is
    /// read, as GPUs do it; the processor reads between them once for all taps of a row.
    fn filter_cost(&self, filter: Filter, pixels: usize) -> Cost {
        let on_a_level = filter.kernel * filter.kernel;
        let multiply_adds = on_a_level + 5 * on_a_level * filter.levels.saturating_sub(1);
        let others = self.head_channels() + 2 * self.output_channels();
        Cost {
            multiply_adds: (self.output_channels() * multiply_adds * pixels) as u64,
            maps: 0,
            others: (others * pixels) as u64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};
    use deepshade_shaders::Effect;

    #[test]
    fn ao_needs_2547_multiply_adds_a_pixel() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let cost: Cost = spec.costs(512, 768).into_iter().sum();
        assert_eq!(cost.multiply_adds, 2547 * 512 * 768);
        // Level 0: 6 channels in, 8 out and their means, then 16 of half the size and 8 in, 1 out.
        let pixels = 512 * 768;
        let layers = spec.costs(512, 768);
        let numbers = |index: usize| (layers[index].maps, layers[index].others);
        assert_eq!(numbers(0), (8 * pixels + 2 * pixels, 6 * pixels + 440));
        assert_eq!(numbers(10), (4 * pixels + 8 * pixels, pixels + 217));
    }

    #[test]
    fn a_filter_costs_its_weights_and_its_taps() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let paper = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, reach).expect("it has one");
        let cost = |spec: &NetSpec| spec.costs(64, 64).into_iter().sum::<Cost>().multiply_adds / (64 * 64);
        for (kernel, taps) in [(1, 1), (3, 9)] {
            let filter = paper.clone().with_head(Head::Filter(Filter { levels: 5, kernel, black: false }));
            let expected = (5 * taps - 1) * 48 * 9 + taps * (1 + 4 * 5);
            assert_eq!(cost(&filter) - cost(&paper), expected, "{kernel}x{kernel}");
        }
    }

    #[test]
    fn a_cost_grows_with_the_frame_and_not_with_the_image() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let cost = |height| spec.costs(height, 64).into_iter().sum::<Cost>().multiply_adds;
        assert_eq!((cost(33), cost(65)), (cost(64), cost(96)));
    }
}
