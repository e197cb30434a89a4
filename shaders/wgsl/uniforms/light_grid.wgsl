/// The cells of a light propagation volume.
struct LightGrid {
    /// The lowest corner, world space, and the edge of a cell, metres.
    low: vec4f,
    /// Cells along x, y and z, and all of them.
    size: vec4f,
    /// Where its border is, in which a coarser grid hands light over: along each axis where it begins, cells
    /// from the lowest corner, far away where there is none.
    begins: vec4f,
    /// And where it ends.
    ends: vec4f,
}
