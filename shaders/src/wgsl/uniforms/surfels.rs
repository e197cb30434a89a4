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
        /// How many surfels one stands for.
        stands_for: f32,
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

    /// What `methods/bounced_z/trace` reads.
    Bounces {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions of a pixel.
        directions: u32,
        /// Levels of the interleaved framebuffer.
        levels: u32,
        /// Chooses directions, and which pixel meets which surfels.
        seed: u32,
        /// Where the shell of the finest level ends, over a surfel's radius.
        shell: f32,
        /// How much larger than its own is the radius that rays meet.
        cover: f32,
        /// How far the effect reaches, metres.
        reach: f32,
    }

    /// What `methods/aov/occlusion` reads.
    FacetSum {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// How far the effect reaches, metres.
        reach: f32,
        /// What is where no surface is seen.
        background: f32,
    }

    /// The facets of one run of `methods/aov/occlusion` or `methods/aov/trace`.
    FacetSlice {
        /// Which of the nodes that are as high as a slice.
        index: u32,
        /// 1 for the last one, after which occlusion is complete; rays do not read it.
        last: u32,
    }

    /// What `methods/aov/trace` reads.
    FacetRays {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions of a pixel.
        directions: u32,
        /// Chooses directions.
        seed: u32,
        /// How far the effect reaches, metres.
        reach: f32,
    }

    /// What `methods/bounced_z/filter` reads.
    BounceWindow {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions of a pixel.
        directions: u32,
        /// Pixels on every side that are filtered together.
        radius: i32,
        /// The Gaussian's exponent of a distance of one pixel.
        falloff: f32,
        /// Factor, one over metres, of a distance from the tangent plane before it is squared into the exponent.
        sharpness: f32,
        /// What is where no surface is seen.
        background: f32,
    }
}
