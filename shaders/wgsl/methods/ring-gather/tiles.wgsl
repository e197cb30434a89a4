// Radius of the largest circle of confusion in front of the plane in focus, of each tile of TILE x TILE
// gathered pixels. The plain version is render/src/methods/ring_gather/reference.rs.

#import uniforms/ring_gather

@group(0) @binding(0) var<uniform> gather: RingGather;
@group(0) @binding(1) var<storage, read> low: array<vec4f>;
// Pixels that are gathered.
@group(0) @binding(2) var<storage, read_write> largest_in_front: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn largest_of_tile(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.tiles_wide || id.y >= gather.tiles_high {
        return;
    }
    let first = id.xy * TILE;
    let end = min(first + TILE, vec2u(gather.low_width, gather.low_height));
    var largest = 0.0;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            largest = max(largest, -low[y * gather.low_width + x].w);
        }
    }
    largest_in_front[id.y * gather.tiles_wide + id.x] = largest / f32(gather.scale);
}
