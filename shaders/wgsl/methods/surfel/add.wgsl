// Adds up the levels, and says what the sum of the last one means.

#import uniforms/level_sum

@group(0) @binding(0) var<uniform> level: LevelSum;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
// [CHANNELS, height, width]
@group(0) @binding(2) var<storage, read> sums: array<f32>;
@group(0) @binding(3) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= level.width || id.y >= level.height {
        return;
    }
    let pixels = level.width * level.height;
    let at = id.y * level.width + id.x;
    for (var c = 0u; c < CHANNELS; c++) {
        let sum = sums[at + c * pixels] + select(image[at + c * pixels], 0.0, level.first == 1u);
        let whole = select(level.background, meaning(sum), valid_plane[at] > 0.5);
        image[at + c * pixels] = select(sum, whole, level.last == 1u);
    }
}
