// Light of the environment along pixels' rays: what no surfel hides, and all.

#import shared/bounced_none
#import shared/environment
#import shared/environment_height
#import shared/packing
#import shared/view
#import uniforms/frame_view

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> environment: array<vec4f>;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(2) var<storage, read> directions: array<u32>;
// What is met, or NONE.
@group(0) @binding(3) var<storage, read> met: array<u32>;
// Radiance, as `pack_radiance` has it: what is seen of it, and all.
@group(0) @binding(4) var<storage, read_write> seen: array<u32>;
@group(0) @binding(5) var<storage, read_write> whole: array<u32>;

@compute @workgroup_size(64)
fn arrive(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at >= arrayLength(&met) {
        return;
    }
    let direction = from_view(from_octahedron(unpack2x16snorm(directions[at])), view);
    let radiance = pack_radiance(environment_radiance(0u, environment_height(), direction));
    whole[at] = radiance;
    seen[at] = select(0u, radiance, met[at] == NONE);
}
