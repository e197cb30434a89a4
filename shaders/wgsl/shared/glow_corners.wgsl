// Where the corners of triangles are in this frame. Passes bind `posed`, [vertices, POSED], world space.

// Numbers of a vertex that is drawn, of which the first six are its position and its normal, world space.
const POSED = 16u;

fn vertex_position(vertex: u32) -> vec3f {
    let first = vertex * POSED;
    return vec3f(posed[first], posed[first + 1u], posed[first + 2u]);
}

fn corners_of(vertices: vec3u) -> mat3x3f {
    return mat3x3f(vertex_position(vertices.x), vertex_position(vertices.y), vertex_position(vertices.z));
}
