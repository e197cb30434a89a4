/// What the passes of `methods/ring_gather` read.
struct RingGather {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Pixels of the image along the edge of one that is gathered.
    scale: u32,
    /// Columns of what is gathered.
    low_width: u32,
    /// Rows of what is gathered.
    low_height: u32,
    /// Columns of tiles.
    tiles_wide: u32,
    /// Rows of tiles.
    tiles_high: u32,
    /// Tiles on either side whose circles may reach a tile.
    reach: i32,
    /// Most rings around a pixel.
    rings: u32,
    /// Radius of the circle of what is infinitely far away, pixels of the image.
    blur_at_infinity: f32,
    /// Radii beyond this are taken for this, pixels of the image.
    largest: f32,
    /// Circles up to this radius are points, pixels of the image.
    sharp: f32,
    /// Circles from this radius on are gathered and nothing else, pixels of the image.
    blurred: f32,
    /// How much nearer in radius one is that is fully in front, pixels of the image.
    softness: f32,
}
