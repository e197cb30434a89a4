// Nothing between a lamp and what it lights dims its light.
fn passed_share(point: vec3f, arrived: Arrival) -> vec3f {
    return vec3f(1.0);
}
