// Where patches are. Passes bind `vertices`, [vertices, 3], camera space.

fn camera_space(vertex: u32) -> vec3f {
    return vec3f(vertices[3u * vertex], vertices[3u * vertex + 1u], vertices[3u * vertex + 2u]);
}

// The weights of a patch's corners.
fn patch_weights(part: u32) -> mat3x3f {
    var at = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let halvings = part >> 28u;
    for (var i = 0u; i < halvings; i++) {
        let quarter = (part >> (2u * (halvings - 1u - i))) & 3u;
        let middles = mat3x3f(0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0]), 0.5 * (at[0] + at[1]));
        if quarter == 3u {
            at = middles;
        } else {
            at = mat3x3f(
                select(middles[(3u - quarter) % 3u], at[0], quarter == 0u),
                select(middles[(5u - quarter) % 3u], at[1], quarter == 1u),
                select(middles[(4u - quarter) % 3u], at[2], quarter == 2u),
            );
        }
    }
    return at;
}
