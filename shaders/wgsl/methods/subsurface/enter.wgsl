// What a method of scattering in screen space is given in place of a picture and mean free paths: the light that falls
// on each surface, as a white one reflects it, and the lengths of its profiles. Planes [3, height, width].

@group(0) @binding(0) var<storage, read> diffuse_light: array<f32>;
@group(0) @binding(1) var<storage, read> diffuse: array<f32>;
@group(0) @binding(2) var<storage, read> mean_free_path: array<f32>;
@group(0) @binding(3) var<storage, read_write> received: array<f32>;
@group(0) @binding(4) var<storage, read_write> lengths: array<f32>;

@compute @workgroup_size(64)
fn enter(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at >= arrayLength(&received) {
        return;
    }
    let colour = diffuse[at];
    // Of what is black nobody sees what falls on it.
    received[at] = select(0.0, diffuse_light[at] / colour, colour > 0.0);
    lengths[at] = diffusion_length(mean_free_path[at], colour);
}
