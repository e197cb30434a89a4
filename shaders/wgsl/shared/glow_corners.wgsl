// Where the corners of tiles are in this frame. Passes bind `posed`, [vertices, POSED], world space.

// Numbers of a vertex that is drawn, of which the first six are its position and its normal, world space.
const POSED = 16u;

fn vertex_position(vertex: u32) -> vec3f {
    let first = vertex * POSED;
    return vec3f(posed[first], posed[first + 1u], posed[first + 2u]);
}

fn tile_corners(tile: GlowTile) -> mat3x3f {
    return mat3x3f(
        vertex_position(tile.corner_0), vertex_position(tile.corner_1), vertex_position(tile.corner_2)
    );
}
