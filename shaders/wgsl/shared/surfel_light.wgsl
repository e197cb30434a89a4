// What a surfel sends to a point, irradiance over pi: its radiance times its form factor.
fn added(sum: vec3f, surfel: Surfel, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    return sum + surfel_sent(surfel, way) * form_factor(surfel, way, squared, receiver.normal);
}
