/// What `methods/prefiltered/shade` reads.
struct Prefiltered {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
}
