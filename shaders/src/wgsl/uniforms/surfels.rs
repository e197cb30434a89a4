//! What the passes that make surfels and shade by them read.

use super::{Field, Layout};

uniforms! {
    /// What surfels are made for.
    Surfels {
        /// Radius of a surfel over its distance.
        slope: f32,
        /// Distance of the plane from which distances are counted, metres.
        near: f32,
        /// How far the effect reaches, metres.
        reach: f32,
        /// Chooses where surfels lie.
        seed: u32,
    }

    /// A level of the tree over surfels.
    TreeLevel {
        /// 0 for leaves.
        height: u32,
    }

    /// A level of the interleaved framebuffer and the shell that is splatted to it.
    SplatLevel {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// There are 4^level sub-buffers.
        level: u32,
        /// Chooses which pixel is in which sub-buffer.
        seed: u32,
        /// 1 on the last level, whose shell has no outer end but the effect's.
        last: u32,
        /// Where the shell begins, over a surfel's effect distance.
        nearest: f32,
        /// Where it ends.
        farthest: f32,
        /// How much larger a surfel is taken.
        enlarged: f32,
        /// How far the effect reaches, metres.
        reach: f32,
    }

    /// A level whose sums are added.
    LevelSum {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// 1 on the first level.
        first: u32,
        /// 1 on the last level.
        last: u32,
        /// What is where no surface is seen.
        background: f32,
    }
}
