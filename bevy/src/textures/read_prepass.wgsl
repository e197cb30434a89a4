// Bevy's prepass as deepshade's passes read it: planes of positions and normals in camera space, and of what
// is seen. Depth is reversed: 0 is infinitely far away, which is where nothing was drawn.

struct Seen {
    view_from_clip: mat4x4f,
    view_from_world: mat4x4f,
    size: vec2u,
    origin: vec2u,
}

@group(0) @binding(0) var<uniform> seen: Seen;
@group(0) @binding(1) var depths: texture_depth_2d;
// From 0 to 1, in world space.
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> position: array<f32>;
@group(0) @binding(4) var<storage, read_write> normal: array<f32>;
@group(0) @binding(5) var<storage, read_write> valid: array<f32>;

@compute @workgroup_size(8, 8)
fn read_prepass(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= seen.size)) { return; }
    let pixels = seen.size.x * seen.size.y;
    let pixel = id.y * seen.size.x + id.x;
    let depth = textureLoad(depths, seen.origin + id.xy, 0);
    let is_seen = depth > 0.0;
    let place = (vec2f(id.xy) + 0.5) / vec2f(seen.size);
    let clip = vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, depth, 1.0);
    let at = seen.view_from_clip * clip;
    let point = select(vec3f(0.0), at.xyz / at.w, is_seen);
    let world = 2.0 * textureLoad(normals, seen.origin + id.xy, 0).xyz - 1.0;
    let turned = (seen.view_from_world * vec4f(world, 0.0)).xyz;
    let unit = select(vec3f(0.0), turned / max(length(turned), 1e-6), is_seen);
    for (var c = 0u; c < 3u; c++) {
        position[c * pixels + pixel] = point[c];
        normal[c * pixels + pixel] = unit[c];
    }
    valid[pixel] = select(0.0, 1.0, is_seen);
}
