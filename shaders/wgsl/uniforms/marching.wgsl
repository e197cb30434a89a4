/// What `methods/lpv/march` reads.
struct Marching {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Steps along each view ray.
    steps: u32,
    /// Chooses by how much they are shifted.
    seed: u32,
}
