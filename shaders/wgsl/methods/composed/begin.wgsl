// What sends light to the eye by itself or of the lamps' light: surfaces, and behind them the sky. Later
// passes add to it.

#import shared/environment
#import shared/view
#import uniforms/frame_view
#constant HEIGHT = 1

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
// [3, height, width] each, radiance
@group(0) @binding(2) var<storage, read> light_planes: array<f32>;
@group(0) @binding(3) var<storage, read> emission_planes: array<f32>;
// [HEIGHT, 2 HEIGHT]
@group(0) @binding(4) var<storage, read> environment: array<vec4f>;
// [3, height, width]
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    var radiance = environment_radiance(0u, HEIGHT, direction);
    if valid_plane[at] > 0.5 {
        for (var c = 0u; c < 3u; c++) {
            radiance[c] = light_planes[at + c * pixels] + emission_planes[at + c * pixels];
        }
    }
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] = radiance[c];
    }
}
