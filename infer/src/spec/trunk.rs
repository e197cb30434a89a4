//! A network of today's form: at half the resolution and coarser, dense, with skip connections.
//!
//! The input is folded, space to depth, so that no convolution runs at full resolution (Shi et al. 2016,
//! "Real-time single image and video super-resolution using an efficient sub-pixel convolutional neural
//! network", the other way round). Each level has a convolution and a residual one (He et al. 2016, "Deep
//! residual learning for image recognition"); a residual convolution of one layer is one whose kernel begins
//! as the identity, so that no form of the network knows of it. The last block is at half the resolution as
//! well, its channels the four pixels of a square.

use super::{Block, BlockSource};

/// Channels of the levels, as shares of the first one's.
const WIDTHS: [f32; 5] = [1.0, 4.0 / 3.0, 2.0, 8.0 / 3.0, 8.0 / 3.0];
/// Channels come by so many, as kernels take them.
const STEP: usize = 4;

/// The blocks of the trunk of so many channels at half the resolution, whose last one makes `last`.
pub fn blocks(channels: usize, last: usize) -> Vec<Block> {
    let width =
        |level: usize| ((WIDTHS[level] * channels as f32 / STEP as f32).round() as usize).max(1) * STEP;
    let block = |name: String, reads, kernel, outputs| Block { name, reads, kernel, groups: 1, outputs };
    let mut blocks = vec![block("fold".to_owned(), BlockSource::Folded, 1, width(0))];
    let mut ways_down = Vec::new();
    for level in 0..WIDTHS.len() {
        if level > 0 {
            let from = blocks.len() - 1;
            blocks.push(block(format!("down{}", level + 1), BlockSource::Pooled(from), 3, width(level)));
        }
        let from = blocks.len() - 1;
        blocks.push(block(format!("residual{}", level + 1), BlockSource::Plain(from), 3, width(level)));
        ways_down.push(blocks.len() - 1);
    }
    for level in (0..WIDTHS.len() - 1).rev() {
        let reads = BlockSource::Joined { coarse: blocks.len() - 1, skip: ways_down[level], groups: 1 };
        blocks.push(block(format!("up{}", level + 1), reads, 3, width(level)));
    }
    let from = blocks.len() - 1;
    blocks.push(block("head".to_owned(), BlockSource::Plain(from), 1, last));
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_halved_down_and_joined_up() {
        let blocks = blocks(24, 8);
        let widths: Vec<usize> = blocks.iter().map(|block| block.outputs).collect();
        assert_eq!(widths, [24, 24, 32, 32, 48, 48, 64, 64, 64, 64, 64, 48, 32, 24, 8]);
        assert_eq!(blocks[13].reads, BlockSource::Joined { coarse: 12, skip: 1, groups: 1 });
    }
}
