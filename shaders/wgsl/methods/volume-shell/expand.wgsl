// A level of a Gaussian pyramid brought to the size of the one below, between the middles of its texels.

#import uniforms/pyramid

@group(0) @binding(0) var<uniform> sizes: Pyramid;
// [coarse_height, coarse_width, 4]
@group(0) @binding(1) var<storage, read> coarse: array<vec4f>;
// [fine_height, fine_width, 4]
@group(0) @binding(2) var<storage, read_write> fine: array<vec4f>;

fn coarse_at(x: i32, y: i32) -> vec4f {
    let at = clamp(vec2i(x, y), vec2i(0), vec2i(i32(sizes.coarse_width), i32(sizes.coarse_height)) - 1);
    return coarse[u32(at.y) * sizes.coarse_width + u32(at.x)];
}

@compute @workgroup_size(TILE, TILE)
fn expand(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sizes.fine_width || id.y >= sizes.fine_height {
        return;
    }
    let near = vec2i(id.xy) / 2;
    // The other of the two texels between whose middles this one's is.
    let far = near + 2 * (vec2i(id.xy) % 2) - 1;
    let rows = 3.0 * coarse_at(near.x, near.y) + coarse_at(far.x, near.y);
    let others = 3.0 * coarse_at(near.x, far.y) + coarse_at(far.x, far.y);
    fine[id.y * sizes.fine_width + id.x] = (3.0 * rows + others) / 16.0;
}
