//! The language of networks: blocks, each a convolution with what comes before it.

use serde::{Deserialize, Serialize};

/// A convolution as `net.json` says it. A leaky ReLU follows all but the last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Its name in files and messages.
    pub name: String,
    /// What it reads.
    pub reads: BlockSource,
    /// Width and height of the kernel; odd.
    pub kernel: usize,
    /// Groups of the convolution.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub groups: usize,
    /// Channels made.
    pub outputs: usize,
}

const fn one() -> usize {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
const fn is_one(count: &usize) -> bool {
    *count == 1
}

/// Where a block reads from. Blocks are named by their index in the network's list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum BlockSource {
    /// The network's input.
    Input,
    /// The network's input at half the resolution: the four pixels of a square as channels, space to depth.
    /// Channel `c` of the pixel `(x, y)` of the square is channel `(2 y + x) C + c`, where the input has `C`.
    Folded,
    /// A block's image as it is.
    Plain(usize),
    /// The means of 2x2 pixels of a block's image.
    Pooled(usize),
    /// The coarser block, doubled bilinearly, joined with the skip connection's block.
    Joined {
        /// A block one level below.
        coarse: usize,
        /// A block of the same level on the way down.
        skip: usize,
        /// Their channels are dealt out in so many groups: a share of the coarser block, then the same share
        /// of the skip connection. One group is all of the coarser block, then all of the skip connection.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        groups: usize,
    },
}

impl BlockSource {
    /// Indices of the blocks that are read.
    pub fn blocks(self) -> impl Iterator<Item = usize> {
        let [first, second] = match self {
            Self::Input | Self::Folded => [None, None],
            Self::Plain(from) | Self::Pooled(from) => [Some(from), None],
            Self::Joined { coarse, skip, .. } => [Some(coarse), Some(skip)],
        };
        first.into_iter().chain(second)
    }

    /// Whether the network's input is read.
    pub const fn is_input(self) -> bool {
        matches!(self, Self::Input | Self::Folded)
    }
}

/// A block as it runs, with what follows from those that it reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// The name in files and messages.
    pub name: String,
    /// 0 is full resolution; each further level halves it.
    pub level: usize,
    /// Where it reads from.
    pub source: BlockSource,
    /// Width and height of the kernel.
    pub kernel: usize,
    /// Channels read.
    pub inputs: usize,
    /// Channels made.
    pub outputs: usize,
    /// Groups of the convolution; the weights are `[outputs, inputs / groups, kernel, kernel]`.
    pub groups: usize,
    /// Whether a leaky ReLU follows.
    pub activation: bool,
}

impl Layer {
    /// The layers of blocks of which each reads earlier ones only, the first of them an input of so many
    /// channels.
    pub(super) fn of_blocks(blocks: &[Block], input_channels: usize) -> Vec<Self> {
        let mut layers: Vec<Self> = Vec::with_capacity(blocks.len());
        for (index, block) in blocks.iter().enumerate() {
            let (level, inputs) = match block.reads {
                BlockSource::Input => (0, input_channels),
                BlockSource::Folded => (1, 4 * input_channels),
                BlockSource::Plain(from) => (layers[from].level, layers[from].outputs),
                BlockSource::Pooled(from) => (layers[from].level + 1, layers[from].outputs),
                BlockSource::Joined { coarse, skip, .. } => {
                    (layers[skip].level, layers[coarse].outputs + layers[skip].outputs)
                }
            };
            layers.push(Self {
                name: block.name.clone(),
                level,
                source: block.reads,
                kernel: block.kernel,
                inputs,
                outputs: block.outputs,
                groups: block.groups,
                activation: index + 1 < blocks.len(),
            });
        }
        layers
    }

    /// Number of weights and biases.
    pub const fn weight_count(&self) -> usize {
        self.outputs * (self.inputs / self.groups) * self.kernel * self.kernel + self.outputs
    }

    /// Shape of the weights, `[outputs, inputs / groups, kernel, kernel]`.
    pub const fn weight_shape(&self) -> [usize; 4] {
        [self.outputs, self.inputs / self.groups, self.kernel, self.kernel]
    }

    /// For each channel that the convolution reads, in order: which channel it is of what it reads as that
    /// lies in memory, of two blocks one after the other.
    pub fn read_order(&self, layers: &[Self]) -> Vec<usize> {
        match self.source {
            BlockSource::Joined { coarse, skip, groups } => {
                joined_order(layers[coarse].outputs, layers[skip].outputs, groups)
            }
            _ => (0..self.inputs).collect(),
        }
    }
}

/// For each channel of two images concatenated group by group: which channel of the plain concatenation it
/// is.
pub fn joined_order(coarse: usize, skip: usize, groups: usize) -> Vec<usize> {
    let (a, b) = (coarse / groups, skip / groups);
    let group = |group| (group * a..(group + 1) * a).chain(coarse + group * b..coarse + (group + 1) * b);
    (0..groups).flat_map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interleaving_gives_every_group_both_sources() {
        assert_eq!(joined_order(4, 2, 2), vec![0, 1, 4, 2, 3, 5]);
        assert_eq!(joined_order(4, 2, 1), vec![0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn a_block_is_written_in_few_words() {
        let block = |reads, groups| Block { name: "a".to_owned(), reads, kernel: 3, groups, outputs: 8 };
        let text = |block: &Block| serde_json::to_string(block).expect("JSON");
        let first = block(BlockSource::Input, 1);
        assert_eq!(text(&first), r#"{"name":"a","reads":"input","kernel":3,"outputs":8}"#);
        let joined = block(BlockSource::Joined { coarse: 3, skip: 1, groups: 2 }, 2);
        for block in [first, block(BlockSource::Folded, 1), block(BlockSource::Pooled(2), 4), joined] {
            assert_eq!(serde_json::from_str::<Block>(&text(&block)).ok(), Some(block));
        }
    }
}
