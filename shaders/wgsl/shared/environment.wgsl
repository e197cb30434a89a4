// An environment filtered for few samples: equirectangular maps of twice as many columns as rows, RGB and one
// unused. The plain version is render/src/methods/environment_map.rs. A pass that includes this declares
// `environment: array<vec4f>`, which holds them.

const TAU = 6.28318531;

fn environment_texel(first: u32, height: i32, at: vec2i) -> vec3f {
    // Beyond a pole is the other side.
    let beyond = at.y < 0 || at.y >= height;
    let row = select(at.y, (2 * height - 1 - at.y) % (2 * height), beyond);
    let column = select(at.x, at.x + height, beyond);
    return environment[first + u32(row * 2 * height + (column + 2 * height) % (2 * height))].xyz;
}

// From a unit direction in world space, of the map whose first texel is `first`.
fn environment_radiance(first: u32, height: u32, direction: vec3f) -> vec3f {
    let aside = sqrt(direction.x * direction.x + direction.z * direction.z);
    let longitude = atan2(direction.x, -direction.z) / TAU;
    let image = vec2f(longitude - floor(longitude), 2.0 * atan2(aside, direction.y) / TAU);
    let at = image * vec2f(2.0, 1.0) * f32(height) - 0.5;
    let within = at - floor(at);
    let corner = vec2i(floor(at));
    let rows = i32(height);
    let top = mix(environment_texel(first, rows, corner),
        environment_texel(first, rows, corner + vec2i(1, 0)), within.x);
    let bottom = mix(environment_texel(first, rows, corner + vec2i(0, 1)),
        environment_texel(first, rows, corner + vec2i(1, 1)), within.x);
    return mix(top, bottom, within.y);
}
