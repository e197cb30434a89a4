// What each froxel scatters of the lamps' light (Wronski 2014, "Volumetric Fog", pass 2). The plain version
// is render/src/methods/froxel/reference.rs.

#import shared/bounded
#import shared/froxel_index
#import shared/froxels
#import shared/medium
#import shared/single_scattering
#import shared/view
#import uniforms/frame_view
#import uniforms/froxels
#import uniforms/light_record
#constant LIGHTS = 1

@group(0) @binding(0) var<uniform> froxels: Froxels;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> pictures: array<u32>;
@group(0) @binding(5) var maps: texture_depth_2d_array;
@group(0) @binding(6) var map_sampler: sampler_comparison;
// [slices, rows, columns, 4]: radiance that a metre of density 1 sends to the eye, over its scattering
// coefficient; density times length, metres.
@group(0) @binding(7) var<storage, read_write> scattered: array<vec4f>;

// Nearer to a lamp than this part of a step it counts as that near: what a froxel is said to scatter is its
// mean.
const NEAREST = 0.25;

@compute @workgroup_size(TILE, TILE)
fn scatter(@builtin(global_invocation_id) cell: vec3u) {
    if cell.x >= froxels.columns || cell.y >= froxels.rows {
        return;
    }
    let pixel = (vec2f(cell.xy) + froxel_shift().xy) * f32(froxels.tile);
    let direction = from_view(normalize(view_position(pixel, 1.0, view)), view);
    let range = froxel_range(direction);
    let begins = slice_distance(f32(cell.z), range);
    let samples = bounded(froxels.samples, cell.xy);
    let step = (slice_distance(f32(cell.z) + 1.0, range) - begins) / f32(samples);
    var light = vec3f(0.0);
    var passed = 0.0;
    for (var i = 0u; i < samples; i++) {
        let point = view.eye.xyz + direction * (begins + (f32(i) + froxel_shift().z) * step);
        let here = density_inside(point) * step;
        if here > 0.0 {
            for (var j = 0u; j < LIGHTS; j++) {
                light += here * scattered_of(lights[j], point, direction, NEAREST * step);
            }
        }
        passed += here;
    }
    // The mean of what is there, where there is some.
    scattered[froxel_index(cell)] = vec4f(light / max(passed, 1e-30), passed);
}
