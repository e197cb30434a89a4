// What a surfel sends to a point, irradiance over pi: its radiance times its form factor.
fn added(sum: vec3f, surfel: Surfel, radius: f32, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let is_behind = dot(way, from_octahedron(unpack2x16snorm(surfel.normal))) >= 0.0;
    let sent = unpack_radiance(select(surfel.front, surfel.back, is_behind));
    return sum + sent * form_factor(surfel, radius, way, squared, receiver.normal);
}
