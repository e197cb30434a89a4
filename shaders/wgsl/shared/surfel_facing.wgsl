// By how much a surfel faces where a way to its middle comes from: its cosine times the way's length. Of closed surfaces only
// fronts count.
fn surfel_facing(surfel: Surfel, way: vec3f) -> f32 {
    let towards = -dot(way, from_octahedron(unpack2x16snorm(surfel.normal)));
    return select(max(towards, 0.0), abs(towards), (surfel.normal & 1u) == 1u);
}

// The radiance that it sends against that way.
fn surfel_sent(surfel: Surfel, way: vec3f) -> vec3f {
    let is_behind = dot(way, from_octahedron(unpack2x16snorm(surfel.normal))) >= 0.0;
    return unpack_radiance(select(surfel.front, surfel.back, is_behind));
}
