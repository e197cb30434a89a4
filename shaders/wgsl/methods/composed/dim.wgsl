// Dims what comes from surfaces and from the sky by the medium in front of them.

#import shared/colours
#import shared/medium
#import shared/surface_distance
#import shared/view
#import uniforms/frame_view
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<uniform> medium: MediumRecord;
@group(0) @binding(2) var densities: texture_3d<f32>;
@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(4) var<storage, read> position_planes: array<f32>;
// [3, height, width]
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

// Points of a way through a grid at which density is looked up.
const POINTS = 32u;

@compute @workgroup_size(TILE, TILE)
fn dim(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    let passed = passed_density(view.eye.xyz, direction, surface_distance(at, pixels), POINTS);
    let share = exp(-colours(medium.extinction.rgb) * passed);
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] *= share[c];
    }
}
