// The radiance that a surfel sends, on the side that is seen.
fn arriving(hit: Hit, direction: vec3f) -> vec3f {
    if hit.level == NONE {
        return vec3f(0.0);
    }
    return surfel_sent(surfels[hit.surfel], direction);
}
