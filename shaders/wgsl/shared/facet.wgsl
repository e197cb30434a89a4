// Facets: parts of triangles as they are now, camera space, metres.

struct Facet {
    a: array<f32, 3>,
    b: array<f32, 3>,
    c: array<f32, 3>,
    // That of its patch.
    part: u32,
}

fn point(at: array<f32, 3>) -> vec3f {
    return vec3f(at[0], at[1], at[2]);
}

// A point lifted off its own surface, by more than what rounding may have sunk it.
fn lifted(at: vec3f, normal: vec3f, reach: f32) -> vec3f {
    return at + (1e-4 * reach + 4e-6 * length(at)) * normal;
}
