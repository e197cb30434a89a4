/// The cells of a medium that keeps light.
struct GlowCells {
    /// The lowest corner of their box, world space, metres.
    low: vec4f,
    /// The highest.
    high: vec4f,
    /// How many there are along x, y and z.
    cells: vec4f,
}
