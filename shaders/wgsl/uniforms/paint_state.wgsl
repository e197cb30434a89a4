/// A state of a paint: `render/src/phosphor/paint.rs`.
struct PaintState {
    /// Excitation rate by irradiance of 1 of each colour, re-radiation rate, per second.
    rates: vec4f,
    /// Radiance where all is excited; the share that is at first.
    emission: vec4f,
}
