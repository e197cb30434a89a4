// An image of what surfels send, in W/m²/sr: give_back.wgsl has it in another unit.

#constant UNIT = 128

@group(0) @binding(0) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(64)
fn in_watts(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at < arrayLength(&image) {
        image[at] *= exp2(128.0 - f32(UNIT));
    }
}
