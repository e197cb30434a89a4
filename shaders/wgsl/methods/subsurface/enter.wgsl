// What a method of scattering in screen space is given in place of a picture and mean free paths: the light
// that falls on each surface, as a white one reflects it, and the lengths of its profiles. Planes [3, height,
// width].

#import shared/diffusion_length

@group(0) @binding(0) var<storage, read> diffuse_light: array<f32>;
@group(0) @binding(1) var<storage, read> diffuse: array<f32>;
@group(0) @binding(2) var<storage, read> mean_free_path: array<f32>;
@group(0) @binding(3) var<storage, read_write> received: array<f32>;
@group(0) @binding(4) var<storage, read_write> lengths: array<f32>;

// Where a colour is black nobody sees what falls on it: the mean of the other colours, or nothing if all are.
fn received_at(at: u32) -> f32 {
    if diffuse[at] > 0.0 {
        return diffuse_light[at] / diffuse[at];
    }
    let pixels = arrayLength(&received) / 3u;
    var sum = vec2f(0.0);
    for (var c = 0u; c < 3u; c++) {
        let other = at % pixels + c * pixels;
        if diffuse[other] > 0.0 {
            sum += vec2f(diffuse_light[other] / diffuse[other], 1.0);
        }
    }
    return sum.x / max(sum.y, 1.0);
}

@compute @workgroup_size(64)
fn enter(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at >= arrayLength(&received) {
        return;
    }
    received[at] = received_at(at);
    lengths[at] = diffusion_length(mean_free_path[at], diffuse[at]);
}
