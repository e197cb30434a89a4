/// The cells of a light propagation volume.
struct LightGrid {
    /// The lowest corner, world space, and the edge of a cell, metres.
    low: vec4f,
    /// Cells along x, y and z, and all of them.
    size: vec4f,
}
