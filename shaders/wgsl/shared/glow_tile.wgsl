// Tiles: a triangle whose surface keeps light, with a lattice of texels of its own. Texels lie in rows of n +
// 1, n, ... 1 points, drawn in from the triangle's edges by half a step: a texel on an edge would be in two
// surfaces. The same as render/src/methods/phosphor/tile.rs.

#import uniforms/glow_tile

fn tile_vertices(tile: GlowTile) -> vec3u {
    return vec3u(tile.corner_0, tile.corner_1, tile.corner_2);
}

// How far the lattice is drawn in.
fn drawn_in(divisions: u32) -> f32 {
    return 3.0 / f32(2u * divisions + 3u);
}

fn row_start(row: u32, divisions: u32) -> u32 {
    return row * (2u * divisions + 3u - row) / 2u;
}
