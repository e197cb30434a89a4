// Radius of the largest circle of confusion in front of the plane in focus that reaches a tile, from whatever
// tile. The plain version is render/src/methods/ring_gather/reference.rs.

#import uniforms/ring_gather

@group(0) @binding(0) var<uniform> gather: RingGather;
@group(0) @binding(1) var<storage, read> largest_in_front: array<f32>;
// Pixels that are gathered.
@group(0) @binding(2) var<storage, read_write> largest_around: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn largest_of_neighbours(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.tiles_wide || id.y >= gather.tiles_high {
        return;
    }
    var largest = 0.0;
    for (var y = -gather.reach; y <= gather.reach; y++) {
        for (var x = -gather.reach; x <= gather.reach; x++) {
            let at = vec2i(id.xy) + vec2i(x, y);
            if at.x < 0 || at.y < 0 || at.x >= i32(gather.tiles_wide) || at.y >= i32(gather.tiles_high) {
                continue;
            }
            let radius = largest_in_front[u32(at.y) * gather.tiles_wide + u32(at.x)];
            let gap = f32(TILE) * vec2f(max(abs(vec2i(x, y)) - 1, vec2i(0)));
            if radius * radius >= dot(gap, gap) {
                largest = max(largest, radius);
            }
        }
    }
    largest_around[id.y * gather.tiles_wide + id.x] = largest;
}
