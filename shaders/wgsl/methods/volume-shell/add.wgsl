// Adds up the levels. What is smooth is light over how much there is that scatters it, so that a silhouette
// before fog stays sharp.

#import uniforms/level_sum

@group(0) @binding(0) var<uniform> level: LevelSum;
// [height, width, 4]: light, and how much of what the ray scatters there is: of each pixel, and with those
// around it.
@group(0) @binding(1) var<storage, read> sums: array<vec4f>;
@group(0) @binding(2) var<storage, read> smooth_sums: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= level.width || id.y >= level.height {
        return;
    }
    let pixels = level.width * level.height;
    let at = id.y * level.width + id.x;
    let light = smooth_sums[at].rgb * (sums[at].w / max(smooth_sums[at].w, 1e-30));
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] = light[c] + select(image[at + c * pixels], 0.0, level.first == 1u);
    }
}
