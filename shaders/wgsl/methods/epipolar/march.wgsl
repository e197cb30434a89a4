// Fog in front of pixels whose view rays cross few light rays, those around the epipole (Baran et al. 2010,
// section 8): by steps.

#import shared/bounded
#import shared/epipolar_lines
#import shared/epipolar_view
#import shared/fog_steps
#import shared/random
#import uniforms/epipolar
#import uniforms/frame_view
#import uniforms/light_record

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> pictures: array<u32>;
@group(0) @binding(5) var<storage, read> valid_plane: array<f32>;
@group(0) @binding(6) var<storage, read> position_planes: array<f32>;
@group(0) @binding(7) var<storage, read> lines: array<u32>;
// [3, height, width]
@group(0) @binding(8) var<storage, read_write> image: array<f32>;
@group(0) @binding(9) var maps: texture_depth_2d_array;
@group(0) @binding(10) var map_sampler: sampler_comparison;

@compute @workgroup_size(TILE, TILE)
fn march(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= epipolar.width || id.y >= epipolar.height {
        return;
    }
    let ray = seen_ray(id.xy);
    if ray.leaves <= ray.enters || !crosses_few(crossed(ray, gamma_bounds())) {
        return;
    }
    let steps = bounded(epipolar.steps, id.xy);
    let shift = random(id.xy, epipolar.seed, 0u);
    let sum = scattered_along(lights[of_lamp.number], ray.direction, vec2f(ray.enters, ray.leaves), steps, shift);
    let pixels = epipolar.width * epipolar.height;
    let at = id.y * epipolar.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] += medium.scattering[c] * sum[c];
    }
}
