/// A triangle whose surface keeps light: `shared/glow_tile.wgsl`.
struct GlowTile {
    /// Its first corner, of the vertices that are drawn.
    corner_0: u32,
    /// Its second corner.
    corner_1: u32,
    /// Its third corner.
    corner_2: u32,
    /// Its first texel.
    first: u32,
    /// Steps between texels along an edge.
    divisions: u32,
    /// Which paint it has.
    paint: u32,
    /// The mesh that it is part of, as object ids count them.
    object: u32,
    /// Fills up.
    padding: u32,
}
