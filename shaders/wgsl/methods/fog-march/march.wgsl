// Single scattering of one lamp's light by steps along every view ray, each of which looks into its shadow
// maps. The plain version is render/src/methods/fog_march/reference.rs.

#import shared/bounded
#import shared/fog_steps
#import shared/medium_span
#import shared/random
#import shared/surface_distance
#import shared/view
#import uniforms/frame_view
#import uniforms/light_record
#import uniforms/of_lamp

/// What `methods/fog_march/march` reads.
struct FogMarch {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Steps along each view ray.
    steps: u32,
    /// Chooses by how much they are shifted.
    seed: u32,
}

@group(0) @binding(0) var<uniform> marching: FogMarch;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> pictures: array<u32>;
@group(0) @binding(5) var maps: texture_depth_2d_array;
@group(0) @binding(6) var map_sampler: sampler_comparison;
@group(0) @binding(7) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(8) var<storage, read> position_planes: array<f32>;
// [3, height, width]
@group(0) @binding(9) var<storage, read_write> image: array<f32>;

@group(0) @binding(13) var<uniform> of_lamp: OfLamp;

@compute @workgroup_size(TILE, TILE)
fn march(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= marching.width || id.y >= marching.height {
        return;
    }
    let pixels = marching.width * marching.height;
    let at = id.y * marching.width + id.x;
    let reach = surface_distance(at, pixels);
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    let span = medium_span(view.eye.xyz, direction, reach);
    let steps = bounded(marching.steps, id.xy);
    let shift = random(id.xy, marching.seed, 0u);
    var sum = vec3f(0.0);
    if span.y > span.x {
        sum = scattered_along(lights[of_lamp.number], direction, span, steps, shift);
    }
    for (var c = 0u; c < 3u; c++) {
        // The first lamp finds what the frame before left.
        let others = select(image[at + c * pixels], 0.0, of_lamp.number == 0u);
        image[at + c * pixels] = others + medium.scattering[c] * sum[c];
    }
}
