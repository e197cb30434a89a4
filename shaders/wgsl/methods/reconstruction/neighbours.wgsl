// Half of the longest movement that reaches a tile, from whatever tile (McGuire et al. 2012, NeighborMax).
// The plain version is render/src/methods/reconstruction/reference.rs.

#import uniforms/reconstruction

@group(0) @binding(0) var<uniform> settings: Reconstruction;
@group(0) @binding(1) var<storage, read> longest_of_tiles: array<vec3f>;
// Pixels, y down, and the length.
@group(0) @binding(2) var<storage, read_write> longest_around: array<vec3f>;

@compute @workgroup_size(TILE, TILE)
fn longest_of_neighbours(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.tiles_wide || id.y >= settings.tiles_high {
        return;
    }
    var longest = vec3f(0.0);
    for (var y = -settings.reach; y <= settings.reach; y++) {
        for (var x = -settings.reach; x <= settings.reach; x++) {
            let at = vec2i(id.xy) + vec2i(x, y);
            if at.x < 0 || at.y < 0 || at.x >= i32(settings.tiles_wide) || at.y >= i32(settings.tiles_high) {
                continue;
            }
            let movement = longest_of_tiles[u32(at.y) * settings.tiles_wide + u32(at.x)];
            let gap = f32(settings.tile) * vec2f(max(abs(vec2i(x, y)) - 1, vec2i(0)));
            if all(abs(movement.xy) >= gap) && movement.z > longest.z {
                longest = movement;
            }
        }
    }
    longest_around[id.y * settings.tiles_wide + id.x] = longest;
}
