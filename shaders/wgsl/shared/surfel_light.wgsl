// What a surfel sends to a point, irradiance over pi: its radiance times its form factor.
fn added(sum: vec3f, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    return sum + surfel_sent(which, way) * form_factor(surfels[which], way, squared, receiver.normal);
}
