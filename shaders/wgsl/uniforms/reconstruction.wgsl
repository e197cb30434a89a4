/// What the passes of `methods/reconstruction` read.
struct Reconstruction {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Edge of a tile, pixels.
    tile: u32,
    /// Columns of tiles.
    tiles_wide: u32,
    /// Rows of tiles.
    tiles_high: u32,
    /// Tiles on either side whose movements may reach a tile.
    reach: i32,
    /// Samples along a line.
    samples: u32,
    /// Chooses the random numbers.
    seed: u32,
    /// Longest half of a movement, pixels.
    longest: f32,
    /// How much nearer, as a share of the depth, what is fully in front.
    depth_extent: f32,
}
