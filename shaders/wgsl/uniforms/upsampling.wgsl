/// What `frame/halve` and `frame/upsample` read.
struct Upsampling {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Columns of the smaller one.
    small_width: u32,
    /// Rows of the smaller one.
    small_height: u32,
    /// Columns of the smaller image a column of the full one.
    columns: f32,
    /// Rows of the smaller image a row of the full one.
    rows: f32,
    /// Where the images meet, in pixels of either: 0.5 at their corners, 0 at the middles of their first
    /// pixels.
    corner: f32,
    /// The image where no surface is seen.
    background: f32,
}
