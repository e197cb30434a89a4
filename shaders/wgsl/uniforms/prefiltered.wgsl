/// The image of `methods/prefiltered` and `methods/occluded-prefiltered`.
struct Prefiltered {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
}
