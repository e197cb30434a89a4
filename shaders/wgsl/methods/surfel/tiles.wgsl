// The box around what is seen in each tile of each sub-buffer of a level. Takes the place of the paper's pyramid of least and
// largest positions (thesis 4.2.2, "Optimizations"): of exactly the pixels that a workgroup shades.

@group(0) @binding(0) var<uniform> level: SplatLevel;
// [sub-buffers, rows of tiles, columns of tiles]; least and largest coordinates, the least above the largest where nothing
// is seen.
@group(0) @binding(4) var<storage, read_write> tiles: array<array<vec4f, 2>>;

@compute @workgroup_size(64)
fn bound_tiles(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let a_sub_buffer = level.tile_columns * level.tile_rows;
    if index >= a_sub_buffer << (2u * level.level) {
        return;
    }
    let tile = vec2u(index % level.tile_columns, (index % a_sub_buffer) / level.tile_columns);
    let pixels = level.width * level.height;
    var low = vec3f(1e30);
    var high = vec3f(-1e30);
    for (var i = 0u; i < SUB_TILE * SUB_TILE; i++) {
        let place = tile * SUB_TILE + vec2u(i % SUB_TILE, i / SUB_TILE);
        let pixel = interleaved_pixel(index / a_sub_buffer, place, level.level, level.seed);
        let at = pixel.y * level.width + pixel.x;
        if all(pixel < vec2u(level.width, level.height)) && surface_valid(at) {
            let position = surface_position(at, pixels);
            low = min(low, position);
            high = max(high, position);
        }
    }
    tiles[index] = array<vec4f, 2>(vec4f(low, 0.0), vec4f(high, 0.0));
}
