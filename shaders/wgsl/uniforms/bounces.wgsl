/// What rays read that walk the tree over surfels.
struct Bounces {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions of a pixel.
    directions: u32,
    /// Chooses directions.
    seed: u32,
    /// How much larger than its own is the radius that rays meet.
    cover: f32,
    /// How far the effect reaches, metres.
    reach: f32,
}
