/// A medium: `render/src/scene/medium.rs`.
struct MediumRecord {
    /// Scattering coefficient of each colour at density 1, 1/m; the mean cosine of the scattering angle.
    scattering: vec4f,
    /// Extinction coefficient.
    extinction: vec4f,
    /// The box's least coordinates, world space, metres; the largest density.
    low: vec4f,
    /// Its largest.
    high: vec4f,
    /// Cells along x, y and z.
    cells: vec4f,
}
