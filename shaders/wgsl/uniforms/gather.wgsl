/// What the passes of `methods/gather` read.
struct Gather {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Samples of each colour of a pixel.
    samples: u32,
    /// Chooses the random numbers.
    seed: u32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
}
