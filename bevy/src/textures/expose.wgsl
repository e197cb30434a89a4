// Exposes light.

@group(0) @binding(0) var<storage, read> exposure: array<f32>;
@group(0) @binding(1) var<storage, read_write> light: array<f32>;

@compute @workgroup_size(256)
fn expose(@builtin(global_invocation_id) id: vec3u) {
    // 256 workgroups make a row.
    let index = id.y * 65536u + id.x;
    if (index < arrayLength(&light)) { light[index] *= exposure[0]; }
}
