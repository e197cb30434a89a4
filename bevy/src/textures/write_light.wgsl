// Exposed light back into a picture of Bevy's. It stays as it was outside the viewport, and as opaque.

struct Seen {
    view_from_clip: mat4x4f,
    view_from_world: mat4x4f,
    size: vec2u,
    origin: vec2u,
    blur_at_infinity: f32,
    focus: f32,
}

const BRIGHTEST = 65504.0;

@group(0) @binding(0) var<uniform> seen: Seen;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> image: array<f32>;
@group(0) @binding(3) var<storage, read> exposure: array<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2u(position.xy);
    let before = textureLoad(picture, at, 0);
    if (any(at < seen.origin) || any(at >= seen.origin + seen.size)) { return before; }
    let pixels = seen.size.x * seen.size.y;
    let first = (at.y - seen.origin.y) * seen.size.x + at.x - seen.origin.x;
    let light = vec3f(image[first], image[first + pixels], image[first + 2u * pixels]) / exposure[0];
    return vec4f(min(light, vec3f(BRIGHTEST)), before.a);
}
