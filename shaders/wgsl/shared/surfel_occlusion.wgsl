// What a surfel does to ambient occlusion: the form factor from a point to a disk (Wallace, Elmquist and Haines 1989), whichever
// side of it is seen.

fn nothing() -> f32 {
    return 0.0;
}

fn added(sum: f32, surfel: Surfel, radius: f32, way: vec3f, squared: f32, normal: vec3f) -> f32 {
    let facing = max(dot(way, normal), 0.0) * abs(dot(way, from_octahedron(unpack2x16snorm(surfel.normal))));
    return sum + radius * radius * facing / (max(squared, 1e-20) * (squared + radius * radius));
}

fn write_sum(sum: f32, at: u32, pixels: u32) {
    sums[at] = sum;
}
