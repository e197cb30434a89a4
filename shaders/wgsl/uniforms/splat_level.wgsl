/// A level of the interleaved framebuffer and the shell that is splatted to it.
struct SplatLevel {
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
