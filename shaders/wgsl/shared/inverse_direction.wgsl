// One over it, and a large number where it is nothing.
fn inverse_of(direction: vec3f) -> vec3f {
    return 1.0 / select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
}
