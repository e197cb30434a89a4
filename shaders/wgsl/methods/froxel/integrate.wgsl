// Sums of what columns of froxels send to the eye, front to back (Wronski 2014, pass 3; within a froxel as
// Hillaire 2015, "Physically Based and Unified Volumetric Rendering in Frostbite"): of each what it and those
// before it send. The plain version is render/src/methods/froxel/reference.rs.

#import shared/bounded
#import shared/froxel_index
#import shared/mean_decay
#import uniforms/froxels
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> froxels: Froxels;
@group(0) @binding(1) var<uniform> medium: MediumRecord;
@group(0) @binding(2) var<storage, read> scattered: array<vec4f>;
// [slices, rows, columns, 4]: radiance.
@group(0) @binding(3) var<storage, read_write> sums: array<vec4f>;

@compute @workgroup_size(TILE, TILE)
fn integrate(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= froxels.columns || id.y >= froxels.rows {
        return;
    }
    let extinction = medium.extinction.rgb;
    var sum = vec3f(0.0);
    var before = 0.0;
    let slices = bounded(froxels.slices, id.xy);
    for (var slice = 0u; slice < slices; slice++) {
        let index = froxel_index(vec3u(id.xy, slice));
        let here = scattered[index];
        let left = exp(-extinction * before) * here.w * mean_decay(extinction * here.w);
        sum += medium.scattering.rgb * here.rgb * left;
        before += here.w;
        sums[index] = vec4f(sum, 0.0);
    }
}
