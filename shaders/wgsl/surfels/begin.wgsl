// Turns 64 numbers each into where each begins, from where the 64 begin.

@group(0) @binding(0) var<storage, read> firsts: array<u32>;
@group(0) @binding(1) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= arrayLength(&firsts) {
        return;
    }
    let end = min(index * 64u + 64u, arrayLength(&counts));
    var before = firsts[index];
    for (var i = index * 64u; i < end; i++) {
        let count = counts[i];
        counts[i] = before;
        before += count;
    }
}
