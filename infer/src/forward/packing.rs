//! Weights in the order in which `shaders/wgsl/shared/net_layer.wgsl` reads them.
//!
//! The shader knows blocks of four inputs and groups of eight outputs (of one, where the layer makes the image), so a
//! layer's own groups become a range of blocks for each group of outputs. Where they do not fall on whole blocks,
//! zeros fill up.

use super::ForwardError;
use crate::{Layer, LayerWeights, NetSpec, Source};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// Channels of a texel.
const BLOCK: usize = 4;
/// Outputs that an invocation makes of a feature map.
pub const FEATURES: usize = 8;
/// Floats of a uniform buffer: 64 KiB, what every device offers. `WEIGHTS` of the shaders is as many.
const ROOM: usize = 16_384;

/// What a group of outputs reads; the same in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Reads {
    first: u32,
    count: u32,
    skip_first: u32,
    skip_count: u32,
    bias: [f32; FEATURES],
}

/// A layer's weights.
pub struct Packed {
    /// In portions that fit into a uniform buffer.
    pub parts: Vec<Part>,
    /// Weights of the shader between the first ones of two groups of outputs.
    pub stride: usize,
}

/// Some groups of outputs.
pub struct Part {
    /// Index of the first group.
    pub first: usize,
    /// What each reads.
    pub reads: Vec<Reads>,
    /// Their weights, [`ROOM`] floats.
    pub weights: Vec<f32>,
}

/// One layer, seen from the shader.
struct Packing<'a> {
    layer: &'a Layer,
    weights: &'a LayerWeights,
    kernel: usize,
    /// Outputs made at a time.
    group: usize,
    /// For each channel that the convolution reads: which of the concatenation (for a single source, of it).
    order: Vec<usize>,
    /// The other way round: where the convolution has each channel of the concatenation.
    positions: Vec<usize>,
    /// Channels of the first source.
    split: usize,
}

/// Packs the weights of the layer of that index.
pub fn pack(
    spec: &NetSpec,
    layers: &[Layer],
    index: usize,
    weights: &LayerWeights,
) -> Result<Packed, ForwardError> {
    let layer = &layers[index];
    let (order, split) = match layer.source {
        Source::Input | Source::Plain(_) | Source::Pooled(_) => ((0..layer.inputs).collect(), layer.inputs),
        Source::Joined { coarse, skip } => {
            let (coarse, skip) = (layers[coarse].outputs, layers[skip].outputs);
            (spec.joined_order(coarse, skip, layer.groups), coarse)
        }
    };
    let group = if layer.activation { FEATURES } else { 1 };
    let mut positions = vec![0; order.len()];
    order.iter().enumerate().for_each(|(position, channel)| positions[*channel] = position);
    let packing = Packing { layer, weights, kernel: spec.kernel, group, order, positions, split };
    packing.packed()
}

impl Packing<'_> {
    fn packed(&self) -> Result<Packed, ForwardError> {
        let groups = self.layer.outputs.div_ceil(self.group);
        let taps = self.kernel * self.kernel;
        let blocks = (0..groups).map(|group| self.blocks(group)).map(|(a, b)| a.len() + b.len());
        let stride = blocks.max().unwrap_or(0) * taps;
        let floats = stride * self.group * BLOCK;
        if floats > ROOM {
            let [bytes, limit] = [floats, ROOM].map(|floats| floats * size_of::<f32>());
            return Err(ForwardError::Weights { layer: self.layer.name.clone(), bytes, limit });
        }
        let at_once = ROOM / floats;
        let parts = (0..groups).step_by(at_once).map(|first| {
            let groups = first..groups.min(first + at_once);
            let mut weights: Vec<f32> = groups
                .clone()
                .flat_map(|group| {
                    let mut weights = self.group_weights(group);
                    weights.resize(floats, 0.0);
                    weights
                })
                .collect();
            weights.resize(ROOM, 0.0);
            Part { first, reads: groups.map(|group| self.reads(group)).collect(), weights }
        });
        Ok(Packed { parts: parts.collect(), stride })
    }

    fn reads(&self, group: usize) -> Reads {
        let (blocks, skip) = self.blocks(group);
        let mut bias = [0.0; FEATURES];
        let outputs = self.outputs(group);
        bias[..outputs.len()].copy_from_slice(&self.weights.bias[outputs]);
        Reads {
            first: blocks.start as u32,
            count: blocks.len() as u32,
            skip_first: skip.start as u32,
            skip_count: skip.len() as u32,
            bias,
        }
    }

    /// The weights of a group: block after block, row of the kernel after row, then for each input its outputs.
    fn group_weights(&self, group: usize) -> Vec<f32> {
        let (blocks, skip) = self.blocks(group);
        let channels = |block: usize| block * BLOCK..(block + 1) * BLOCK;
        let coarse = blocks.map(|block| channels(block).map(|c| (c < self.split).then_some(c)).collect());
        let skip = skip.map(|block| channels(block).map(|c| Some(self.split + c)).collect());
        let mut packed = Vec::new();
        for block in coarse.chain(skip).collect::<Vec<Vec<Option<usize>>>>() {
            for tap in 0..self.kernel * self.kernel {
                self.tap(&mut packed, group, &block, tap);
            }
        }
        packed
    }

    /// What one pixel of the kernel adds of four inputs. The shader multiplies a 4x4 matrix a four outputs, column
    /// after column, an input a column.
    fn tap(&self, packed: &mut Vec<f32>, group: usize, block: &[Option<usize>], tap: usize) {
        let first = group * self.group;
        for outputs in (first..first + self.group).collect::<Vec<_>>().chunks(BLOCK) {
            for channel in block {
                packed.extend(outputs.iter().map(|output| self.weight(*output, *channel, tap)));
            }
        }
    }

    /// The weight of a channel of the concatenation in an output, 0 where the output does not read it.
    fn weight(&self, output: usize, channel: Option<usize>, tap: usize) -> f32 {
        let share = self.layer.inputs / self.layer.groups;
        let position = channel.and_then(|channel| self.positions.get(channel));
        let Some(position) = position.filter(|_| output < self.layer.outputs) else { return 0.0 };
        let first = output / (self.layer.outputs / self.layer.groups) * share;
        match position.checked_sub(first).filter(|input| *input < share) {
            None => 0.0,
            Some(input) => self.weights.weight[(output * share + input) * self.kernel * self.kernel + tap],
        }
    }

    fn outputs(&self, group: usize) -> Range<usize> {
        group * self.group..((group + 1) * self.group).min(self.layer.outputs)
    }

    /// The blocks of the first and of the second source that a group of outputs reads.
    fn blocks(&self, group: usize) -> (Range<usize>, Range<usize>) {
        let share = self.layer.inputs / self.layer.groups;
        let of_group = |output: usize| output / (self.layer.outputs / self.layer.groups);
        let outputs = self.outputs(group);
        let read = of_group(outputs.start) * share..(of_group(outputs.end - 1) + 1) * share;
        let channels = &self.order[read];
        let (coarse, skip): (Vec<usize>, Vec<usize>) = channels.iter().partition(|c| **c < self.split);
        (covering(coarse), covering(skip.into_iter().map(|c| c - self.split)))
    }
}

/// The blocks in which some channels lie.
fn covering(channels: impl IntoIterator<Item = usize>) -> Range<usize> {
    channels.into_iter().fold(0..0, |blocks, channel| {
        let block = channel / BLOCK;
        if blocks.is_empty() { block..block + 1 } else { blocks.start.min(block)..blocks.end.max(block + 1) }
    })
}
