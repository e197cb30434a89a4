// Surfaces lit by the grid, irradiance over pi; that of a finer grid is added to what is there of the coarser
// ones.

#import shared/lpv_irradiance
#import shared/lpv_nested
#import shared/surface
#import shared/surface_valid
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid
#constant NESTED = 1

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(4) var<uniform> view: FrameView;
@group(0) @binding(5) var<storage, read> shown: array<vec4f>;
@group(0) @binding(7) var<uniform> finer: LightGrid;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

const PI = 3.14159265;

@compute @workgroup_size(TILE, TILE)
fn light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    var sum = vec3f(0.0);
    if surface_valid(at) {
        let point = view.eye.xyz + from_view(surface_position(at, pixels), view);
        sum = share_here(point) * irradiance(point, from_view(surface_normal(at, pixels), view), 0u) / PI;
    }
    for (var c = 0u; c < 3u; c++) {
        if NESTED == 1u {
            sum[c] += image[at + c * pixels];
        }
        image[at + c * pixels] = sum[c];
    }
}
