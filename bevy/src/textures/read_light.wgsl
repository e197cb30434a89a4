// Bevy's picture and its depth as deepshade's passes read them: planes of light, depth and blurriness. What
// is brighter than nothing is counted. Depth is reversed: 0 is infinitely far away.

struct Seen {
    view_from_clip: mat4x4f,
    view_from_world: mat4x4f,
    size: vec2u,
    origin: vec2u,
    // Radius in pixels of the circle of confusion of what is infinitely far away.
    blur_at_infinity: f32,
    // Depth of the plane in focus.
    focus: f32,
}

// Depth of a sky, in that of the plane in focus: as good as infinitely far away.
const SKY = 1e4;
// The largest half float, which is what pictures have.
const BRIGHTEST = 65504.0;

@group(0) @binding(0) var<uniform> seen: Seen;
@group(0) @binding(1) var depths: texture_depth_2d;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> light: array<f32>;
@group(0) @binding(4) var<storage, read_write> depth: array<f32>;
@group(0) @binding(5) var<storage, read_write> blurriness: array<f32>;
@group(0) @binding(6) var<storage, read_write> valid: array<f32>;
// By the bits of half floats.
@group(0) @binding(7) var<storage, read_write> counts: array<atomic<u32>>;

@compute @workgroup_size(8, 8)
fn read_light(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= seen.size)) { return; }
    let pixels = seen.size.x * seen.size.y;
    let pixel = id.y * seen.size.x + id.x;
    let drawn = textureLoad(depths, seen.origin + id.xy, 0);
    var ahead = SKY * seen.focus;
    if (drawn > 0.0) {
        let place = (vec2f(id.xy) + 0.5) / vec2f(seen.size);
        let clip = vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, drawn, 1.0);
        let at = seen.view_from_clip * clip;
        ahead = min(-at.z / at.w, ahead);
    }
    depth[pixel] = ahead;
    blurriness[pixel] = seen.blur_at_infinity * (ahead - seen.focus);
    // A sky has light, too.
    valid[pixel] = 1.0;
    let colour = textureLoad(picture, seen.origin + id.xy, 0);
    for (var c = 0u; c < 3u; c++) {
        // What is no number is no light.
        let value = select(0.0, min(colour[c], BRIGHTEST), colour[c] > 0.0);
        light[c * pixels + pixel] = value;
        let bits = pack2x16float(vec2f(value, 0.0)) & 0x7fffu;
        if (bits > 0u) { atomicAdd(&counts[bits], 1u); }
    }
}
