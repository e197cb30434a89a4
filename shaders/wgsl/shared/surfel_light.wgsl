// What a surfel sends to a point: irradiance over pi, its radiance times the form factor from the point to the disk (Wallace,
// Elmquist and Haines 1989).

fn nothing() -> vec3f {
    return vec3f(0.0);
}

fn added(sum: vec3f, surfel: Surfel, radius: f32, way: vec3f, squared: f32, normal: vec3f) -> vec3f {
    let away = dot(way, from_octahedron(unpack2x16snorm(surfel.normal)));
    let facing = max(dot(way, normal), 0.0) * abs(away);
    let sent = unpack_radiance(select(surfel.back, surfel.front, away < 0.0));
    return sum + sent * (radius * radius * facing / (max(squared, 1e-20) * (squared + radius * radius)));
}

fn write_sum(sum: vec3f, at: u32, pixels: u32) {
    for (var c = 0u; c < CHANNELS; c++) {
        sums[at + c * pixels] = sum[c];
    }
}
