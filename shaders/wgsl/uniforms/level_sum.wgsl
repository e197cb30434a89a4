/// A level whose sums are added.
struct LevelSum {
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
