/// Two levels of a Gaussian pyramid.
struct Pyramid {
    /// Columns of the finer one.
    fine_width: u32,
    /// Its rows.
    fine_height: u32,
    /// Columns of the coarser one.
    coarse_width: u32,
    /// Its rows.
    coarse_height: u32,
}
