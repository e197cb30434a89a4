// Adds up the levels.

@group(0) @binding(0) var<uniform> level: LevelSum;
// [3, height, width]
@group(0) @binding(1) var<storage, read> sums: array<f32>;
@group(0) @binding(2) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(64)
fn add(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at < arrayLength(&image) {
        image[at] = sums[at] + select(image[at], 0.0, level.first == 1u);
    }
}
