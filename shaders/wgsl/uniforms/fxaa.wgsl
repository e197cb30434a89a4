/// What `methods/fxaa/luma` and `methods/fxaa/smooth` read.
struct Fxaa {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Steps of the search for an edge's end, at most 12.
    steps: u32,
    /// Contrast, as a share of the brightest luma around, below which there is no edge.
    contrast: f32,
    /// Contrast of luma below which there is no edge.
    least_contrast: f32,
    /// How much of what is smaller than a pixel is blurred, 0 to 1.
    subpixel: f32,
}
