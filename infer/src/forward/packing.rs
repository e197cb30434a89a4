//! Weights in the order in which kernels read them.
//!
//! A kernel knows blocks of four inputs and blocks of one, four, eight or sixteen outputs, so a layer's own
//! groups become a range of blocks of inputs for each block of outputs. Where they do not fall on whole
//! blocks, zeros fill up.

use crate::{BlockSource, Layer, LayerWeights, NetSpec};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// Channels that lie side by side.
pub const BLOCK: usize = 4;
/// Most outputs that an invocation makes.
pub const MOST_OUTPUTS: usize = 16;

/// What a block of outputs reads; the same in the kernels.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Reads {
    /// First block of four channels of the image that the layer reads, of the coarser one where it joins two.
    pub first: u32,
    /// Number of such blocks.
    pub count: u32,
    /// First block of four channels of the skip connection.
    pub skip_first: u32,
    /// Number of such blocks.
    pub skip_count: u32,
    /// What the sums begin with.
    pub bias: [f32; MOST_OUTPUTS],
}

/// A layer's weights, packed.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// Outputs of a block.
    pub outputs: usize,
    /// What each block of outputs reads.
    pub reads: Vec<Reads>,
    /// Weights of a block of outputs, with what fills it up.
    pub stride: usize,
    /// `[blocks of outputs, stride]`; of a block
    /// `[blocks of four inputs, kernel, kernel, blocks of four outputs, 4 inputs, 4 outputs]`, the blocks of
    /// the skip connection after the others. A single output has one output where the others have four.
    pub weights: Vec<f32>,
}

impl Packed {
    /// Packs the weights of the layer of that index for a kernel that makes `outputs` outputs at a time.
    pub fn new(spec: &NetSpec, index: usize, weights: &LayerWeights, outputs: usize) -> Self {
        let layers = spec.layers();
        let layer = &layers[index];
        let order = match layer.source {
            BlockSource::Folded => folded_order(spec.input_channels()),
            _ => layer.read_order(&layers),
        };
        let split = match layer.source {
            BlockSource::Joined { coarse, .. } => layers[coarse].outputs,
            _ => order.iter().max().map_or(0, |last| last + 1),
        };
        let mut positions = vec![None; order.iter().max().map_or(0, |last| last + 1)];
        order.iter().enumerate().for_each(|(position, channel)| positions[*channel] = Some(position));
        Packing { layer, weights, kernel: layer.kernel, group: outputs, order, positions, split }.packed()
    }
}

/// For each channel that a convolution reads of an input of so many, space to depth, where a kernel has it:
/// the channels of each of four pixels begin with a block.
fn folded_order(channels: usize) -> Vec<usize> {
    let each = channels.next_multiple_of(BLOCK);
    (0..4).flat_map(|pixel| (0..channels).map(move |channel| pixel * each + channel)).collect()
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
    /// The other way round: where the convolution has each channel of the concatenation, if it does.
    positions: Vec<Option<usize>>,
    /// Channels of the first source.
    split: usize,
}

impl Packing<'_> {
    fn packed(&self) -> Packed {
        let groups = 0..self.layer.outputs.div_ceil(self.group);
        let blocks = groups.clone().map(|group| self.blocks(group)).map(|(a, b)| a.len() + b.len());
        let stride = blocks.max().unwrap_or(0) * self.kernel * self.kernel * self.group * BLOCK;
        let weights = groups.clone().flat_map(|group| {
            let mut weights = self.group_weights(group);
            weights.resize(stride, 0.0);
            weights
        });
        Packed {
            outputs: self.group,
            weights: weights.collect(),
            reads: groups.map(|group| self.reads(group)).collect(),
            stride,
        }
    }

    fn reads(&self, group: usize) -> Reads {
        let (blocks, skip) = self.blocks(group);
        let mut bias = [0.0; MOST_OUTPUTS];
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

    /// The weights of a group: block after block, row of the kernel after row, then for each input its
    /// outputs.
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

    /// What one pixel of the kernel adds of four inputs. The shader multiplies a 4x4 matrix a four outputs,
    /// column after column, an input a column.
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
        let position = channel.and_then(|channel| self.positions.get(channel).copied().flatten());
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
