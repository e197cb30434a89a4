// Between which values of `gamma` view rays are in the medium. None is negative, so that their bits are in
// order.

#import shared/epipolar_view
#import uniforms/epipolar
#import uniforms/frame_view
#import uniforms/light_record
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
@group(0) @binding(3) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(4) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(5) var<storage, read> position_planes: array<f32>;
@group(0) @binding(6) var<storage, read_write> lines: array<atomic<u32>>;

var<workgroup> least: atomic<u32>;
var<workgroup> largest: atomic<u32>;

@compute @workgroup_size(TILE, TILE)
fn bound(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        atomicStore(&least, 0x7f7fffffu);
        atomicStore(&largest, 0u);
    }
    workgroupBarrier();
    let ray = seen_ray(id.xy);
    if ray.leaves > ray.enters && all(id.xy < vec2u(epipolar.width, epipolar.height)) {
        atomicMin(&least, bitcast<u32>(min(ray.gamma.x, ray.gamma.y)));
        atomicMax(&largest, bitcast<u32>(max(ray.gamma.x, ray.gamma.y)));
    }
    workgroupBarrier();
    if thread == 0u {
        let place = 2u * (epipolar.width + epipolar.height) + 1u;
        atomicMin(&lines[place], atomicLoad(&least));
        atomicMax(&lines[place + 1u], atomicLoad(&largest));
    }
}
