// Light that leaves a surface, in the surface's colour. Planes [3, height, width].

@group(0) @binding(0) var<storage, read> scattered: array<f32>;
@group(0) @binding(1) var<storage, read> diffuse: array<f32>;
@group(0) @binding(2) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(64)
fn leave(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at < arrayLength(&image) {
        image[at] = diffuse[at] * scattered[at];
    }
}
