// Half of the longest movement of each tile of pixels (McGuire et al. 2012, TileMax).
// The plain version is render/src/methods/reconstruction/reference.rs.

#import shared/motion

@group(0) @binding(2) var<storage, read> valid_plane: array<f32>;
// Pixels, y down, and the length.
@group(0) @binding(4) var<storage, read_write> longest_of_tiles: array<vec3f>;

@compute @workgroup_size(TILE, TILE)
fn longest_of_tile(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.tiles_wide || id.y >= settings.tiles_high {
        return;
    }
    let first = id.xy * settings.tile;
    let end = min(first + settings.tile, vec2u(settings.width, settings.height));
    var longest = vec3f(0.0);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let index = y * settings.width + x;
            if valid_plane[index] <= 0.5 {
                continue;
            }
            let movement = half_movement(index);
            if movement.z > longest.z {
                longest = movement;
            }
        }
    }
    longest_of_tiles[id.y * settings.tiles_wide + id.x] = longest;
}
