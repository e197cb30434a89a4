// The form factor from a point with a normal to a disk (Wallace, Elmquist and Haines 1989); `way` leads to the disk's middle, and
// `squared` is its length squared. Of closed surfaces only fronts count.
fn form_factor(surfel: Surfel, radius: f32, way: vec3f, squared: f32, normal: vec3f) -> f32 {
    let towards = -dot(way, from_octahedron(unpack2x16snorm(surfel.normal)));
    let facing = max(dot(way, normal), 0.0) * select(max(towards, 0.0), abs(towards), (surfel.normal & 1u) == 1u);
    return radius * radius * facing / (max(squared, 1e-20) * (squared + radius * radius));
}
