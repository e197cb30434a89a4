// Forgets the sums of the frame before.

@group(0) @binding(0) var<storage, read_write> light: array<u32>;
@group(0) @binding(1) var<storage, read_write> blockers: array<u32>;

@compute @workgroup_size(64)
fn clear(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index < arrayLength(&light) {
        light[index] = 0u;
    }
    if index < arrayLength(&blockers) {
        blockers[index] = 0u;
    }
}
