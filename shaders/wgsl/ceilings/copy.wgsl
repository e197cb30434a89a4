// Copies vectors of four floats, each invocation some that lie far apart, so that neighbours read side by
// side.

@group(0) @binding(0) var<storage, read> source: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> made: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let count = arrayLength(&source);
    for (var i = id.x; i < count; i += 64u * groups.x) {
        made[i] = source[i];
    }
}
