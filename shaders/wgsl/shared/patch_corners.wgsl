// Where patches are. Passes bind `vertices`, [vertices, 3], camera space.

fn camera_space(vertex: u32) -> vec3f {
    return vec3f(vertices[3u * vertex], vertices[3u * vertex + 1u], vertices[3u * vertex + 2u]);
}
