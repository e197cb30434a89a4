//! The networks of the thesis (7.3.2): on the way down, level l has `u0 * 2^l` kernels in `2^l` groups, a
//! leaky ReLU and 2x2 mean pooling; on the way up, the coarser level is doubled bilinearly, joined with the
//! same level's way down, and convolved. The step upwards on level 0 makes the image itself, without an
//! activation: with it ambient occlusion has 71,089 weights, Table 7.1's 71 k. On a single level that step
//! reads the way down alone.

use super::{Block, BlockSource, Colour, Head, NetSpec};
use crate::Reach;
use deepshade_shaders::{Attribute, Effect};

/// Order of the channels after a concatenation, which decides what each group of the next convolution sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelOrder {
    /// All of the coarser level, then all of the skip connection, as in the paper's framework: the first
    /// groups see the coarser level only, the last ones the skip only.
    Contiguous,
    /// Group by group: a share of the coarser level, then the same share of the skip, so that every group
    /// sees both.
    Interleaved,
}

/// The numbers that tell the thesis' networks from each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UNet {
    /// Number of kernels on level 0.
    pub u0: usize,
    /// Number of levels; 1 is no U at all.
    pub levels: usize,
    /// Width and height of every kernel; odd.
    pub kernel: usize,
    /// Groups of the last convolution.
    pub image_groups: usize,
    /// Order of the channels after a concatenation.
    pub order: ChannelOrder,
}

impl UNet {
    /// That of an effect (Table 7.1); none where the thesis has none.
    pub const fn of(effect: Effect, order: ChannelOrder) -> Option<Self> {
        let (u0, levels, kernel, image_groups) = match effect {
            Effect::Ao => (8, 6, 3, 1),
            Effect::Gi | Effect::Dof | Effect::MotionBlur | Effect::Sss | Effect::Multi | Effect::Do => {
                (16, 5, 3, 1)
            }
            Effect::Aa => (8, 1, 5, 1),
            Effect::Ibl => (300, 1, 1, 3),
            Effect::Real => (16, 5, 5, 1),
            Effect::Glossy
            | Effect::OccludedIbl
            | Effect::Subsurface
            | Effect::FogDirect
            | Effect::FogIndirect
            | Effect::FogMultiple
            | Effect::Phosphor
            | Effect::PhosphorGi
            | Effect::Path => return None,
        };
        Some(Self { u0, levels, kernel, image_groups, order })
    }

    /// The blocks of a network whose last one makes so many channels: down, then up.
    pub fn blocks(&self, last: usize) -> Vec<Block> {
        let Self { u0, levels, kernel, image_groups, .. } = *self;
        let mut blocks = Vec::new();
        for level in 0..levels {
            blocks.push(Block {
                name: format!("down{level}"),
                reads: if level == 0 { BlockSource::Input } else { BlockSource::Pooled(level - 1) },
                kernel,
                groups: 1 << level,
                outputs: u0 << level,
            });
        }
        for level in (1..levels.saturating_sub(1)).rev() {
            let reads = self.joined(blocks.len() - 1, level, 1 << level);
            let name = format!("up{level}");
            blocks.push(Block { name, reads, kernel, groups: 1 << level, outputs: u0 << level });
        }
        let coarse = blocks.len().saturating_sub(1);
        let reads =
            if levels == 1 { BlockSource::Plain(coarse) } else { self.joined(coarse, 0, image_groups) };
        blocks.push(Block { name: "up0".to_owned(), reads, kernel, groups: image_groups, outputs: last });
        blocks
    }

    const fn joined(&self, coarse: usize, skip: usize, groups: usize) -> BlockSource {
        let groups = match self.order {
            ChannelOrder::Contiguous => 1,
            ChannelOrder::Interleaved => groups,
        };
        BlockSource::Joined { coarse, skip, groups }
    }
}

impl NetSpec {
    /// The paper's network for an effect (Table 7.1); none where the paper has none.
    pub fn published(effect: Effect, order: ChannelOrder, reach: Reach) -> Option<Self> {
        use Attribute::{
            Blurriness, Depth, Diffuse, DiffuseLight, Glossiness, Light, MeanFreePath, Motion, Normal,
            Position, Specular, ToCamera, WorldNormal,
        };
        let (inputs, colour): (&[Attribute], Colour) = match effect {
            Effect::Gi => (&[Normal, Position, DiffuseLight], Colour::Mono),
            Effect::Dof => (&[Blurriness, Depth, Light], Colour::Mono),
            Effect::MotionBlur => (&[Motion, Light, Depth], Colour::Mono),
            Effect::Sss => (&[Position, MeanFreePath, Light], Colour::Mono),
            Effect::Aa => (&[Depth, Light], Colour::Mono),
            Effect::Multi => (&[Normal, Position, Blurriness, Depth, Light], Colour::Rgb),
            Effect::Ibl => (&[WorldNormal, ToCamera, Diffuse, Specular, Glossiness], Colour::Rgb),
            Effect::Do => (&[WorldNormal, Normal, Position], Colour::Rgb),
            Effect::Real => (&[Normal], Colour::Rgb),
            _ => (&[Normal, Position], Colour::Mono),
        };
        let mut spec = Self {
            effect,
            inputs: inputs.to_vec(),
            estimates: Vec::new(),
            colour,
            leak: 0.01,
            blocks: Vec::new(),
            head: Head::Image,
            reach,
            trained: None,
            environment: None,
        };
        spec.blocks = UNet::of(effect, order)?.blocks(spec.head_channels());
        Some(spec)
    }

    /// The paper's network for ambient occlusion.
    pub fn ao(order: ChannelOrder, reach: Reach) -> Self {
        Self::published(Effect::Ao, order, reach).expect("it has one")
    }

    /// The numbers of a network of the thesis' form; none where it has another.
    pub fn u_net(&self) -> Option<UNet> {
        let levels = self.levels();
        let (first, last) = (self.blocks.first()?, self.blocks.last()?);
        let of = |order| UNet {
            u0: first.outputs,
            levels,
            kernel: first.kernel,
            image_groups: last.groups,
            order,
        };
        let is_it = |net: &UNet| net.blocks(last.outputs) == self.blocks;
        [ChannelOrder::Interleaved, ChannelOrder::Contiguous].map(of).into_iter().find(is_it)
    }

    /// A network of the thesis' form with other numbers; one of another form as it is.
    #[must_use]
    pub fn reshaped(mut self, change: impl FnOnce(&mut UNet)) -> Self {
        if let Some(mut net) = self.u_net() {
            change(&mut net);
            self.blocks = net.blocks(self.head_channels());
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn networks_have_the_papers_numbers_of_weights() {
        // Table 7.1 says 71 k, 134 k, 133 k, 133 k, 133 k, 135 k, 135 k, 370 k; for aa it says 1.2 k and for
        // ibl
        // 3.9 k, which what the text says of them does not give.
        let weights = [
            (Effect::Ao, 71_089),
            (Effect::Gi, 133_489),
            (Effect::Dof, 132_913),
            (Effect::MotionBlur, 133_057),
            (Effect::Sss, 133_201),
            (Effect::Aa, 609),
            (Effect::Multi, 134_931),
            (Effect::Ibl, 4_503),
            (Effect::Do, 134_643),
            (Effect::Real, 370_323),
        ];
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            for (effect, weights) in weights {
                let spec = NetSpec::published(effect, order, REACH).expect("the paper has one");
                assert_eq!((effect, spec.weight_count(), spec.validate()), (effect, weights, Ok(())));
                let one_level = UNet::of(effect, order).is_some_and(|net| net.levels == 1);
                assert!(spec.u_net() == UNet::of(effect, order) || one_level, "{effect}");
            }
        }
        assert_eq!(NetSpec::published(Effect::Path, ChannelOrder::Contiguous, REACH), None);
    }

    #[test]
    fn a_network_of_one_level_makes_the_image_of_its_way_down() {
        let aa = NetSpec::published(Effect::Aa, ChannelOrder::Interleaved, REACH).expect("has one");
        let layers: Vec<_> =
            aa.layers().into_iter().map(|l| (l.source, l.inputs, l.outputs, l.activation)).collect();
        assert_eq!(layers, [(BlockSource::Input, 2, 8, true), (BlockSource::Plain(0), 8, 1, false)]);
    }

    #[test]
    fn the_last_layer_makes_the_image() {
        let layers = NetSpec::ao(ChannelOrder::Contiguous, REACH).layers();
        let last = &layers[10];
        assert_eq!(layers.len(), 11);
        assert_eq!((last.inputs, last.outputs, last.activation), (24, 1, false));
        assert_eq!(last.source, BlockSource::Joined { coarse: 9, skip: 0, groups: 1 });
    }

    #[test]
    fn another_shape_keeps_inputs_and_head() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        let small = spec.clone().reshaped(|net| (net.u0, net.levels) = (4, 2));
        assert_eq!((small.levels(), small.blocks[1].outputs, small.inputs), (2, 8, spec.inputs));
        assert_eq!(small.head, spec.head);
    }
}
