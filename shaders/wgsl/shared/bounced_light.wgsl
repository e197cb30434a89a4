// The radiance that a surfel sends, on the side that is seen.
fn arriving(hit: Hit, direction: vec3f) -> vec3f {
    if hit.level == NONE {
        return vec3f(0.0);
    }
    let surfel = surfels[hit.surfel];
    let away = dot(direction, from_octahedron(unpack2x16snorm(surfel.normal)));
    return unpack_radiance(select(surfel.back, surfel.front, away < 0.0));
}
