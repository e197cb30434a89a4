/// What surfels are made for.
struct Surfels {
    /// Radius of a surfel over its distance, to which counts how far it is outside of what is seen.
    slope: f32,
    /// Distance of the plane from which distances are counted, metres.
    near: f32,
    /// How far the effect reaches, metres.
    reach: f32,
    /// Half images to the right per metre, at depth 1.
    slope_x: f32,
    /// Half images up.
    slope_y: f32,
}
