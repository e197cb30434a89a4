// What arrives at pixels along their rays, in the place of what these have met.

#import shared/packing

// [directions, height, width]: twice the index of a surfel, and 1 more where its back is met, or NONE; then
// radiance, as `pack_radiance` has it.
@group(0) @binding(0) var<storage, read_write> arrived: array<u32>;

@compute @workgroup_size(64)
fn arrive(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at < arrayLength(&arrived) {
        arrived[at] = pack_radiance(arriving(arrived[at]));
    }
}
