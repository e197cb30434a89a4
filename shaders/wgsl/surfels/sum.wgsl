// Sums of 64 numbers each.

@group(0) @binding(0) var<storage, read> counts: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(64)
fn sum(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let first = index * 64u;
    let end = min(first + 64u, arrayLength(&counts));
    if index >= arrayLength(&sums) {
        return;
    }
    var total = 0u;
    for (var i = first; i < end; i++) {
        total += counts[i];
    }
    sums[index] = total;
}
