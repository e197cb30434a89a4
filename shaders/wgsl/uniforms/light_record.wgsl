/// A light: `render/src/scene/light.rs`.
struct LightRecord {
    /// Where it is; 0 point, 1 spot, 2 directional.
    place: vec4f,
    /// In which direction it shines; its range, metres, 0 without an end.
    axis: vec4f,
    /// Intensity or irradiance; its first map, -1 without one.
    power: vec4f,
    /// Cosines of the inner and outer cone, number of maps, metres after which a pattern repeats.
    cone: vec4f,
    /// First word of the picture that it projects, columns, rows; 1 where there is one in sRGB, 2 a linear
    /// one, and 2 more where only the nearest texel is read.
    picture: vec4f,
    /// The picture's right.
    right: vec4f,
    /// The picture's up.
    up: vec4f,
}
