/// What the passes of `methods/epipolar` read.
struct Epipolar {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Light rays in a slice, a multiple of 64.
    light_rays: u32,
    /// Lines for which there is room at once: those of a part.
    lines: u32,
    /// View rays that cross fewer are marched,
    least: u32,
    /// in so many steps,
    steps: u32,
    /// which this shifts.
    seed: u32,
}
