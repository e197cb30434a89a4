// Light, dimmed by how open its surface is. The plain version is render/src/methods/occluded_gather/mod.rs.

#import uniforms/ring_gather

@group(0) @binding(0) var<uniform> gather: RingGather;
// [3, height, width], radiance
@group(0) @binding(1) var<storage, read> light_planes: array<f32>;
// [height, width]
@group(0) @binding(2) var<storage, read> openness: array<f32>;
// [3, height, width], radiance
@group(0) @binding(3) var<storage, read_write> occluded: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn occlude(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.width || id.y >= gather.height {
        return;
    }
    let pixels = gather.width * gather.height;
    let at = id.y * gather.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        occluded[at + c * pixels] = light_planes[at + c * pixels] * openness[at];
    }
}
