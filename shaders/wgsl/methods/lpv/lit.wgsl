// Surfaces lit by the grid, irradiance over pi; that of a finer grid takes the place of what is there of the
// coarser one: nothing of it beside its border, all of it farther in (render/src/lpv/grid.rs). NESTED says
// whether the grid is in a coarser one.

#import shared/lpv_irradiance
#import shared/surface
#import shared/surface_valid
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid
#constant NESTED = 1

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(4) var<uniform> view: FrameView;
@group(0) @binding(5) var<storage, read> shown: array<vec4f>;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

const PI = 3.14159265;
const FADES = vec2f(2.0, 4.0);

// How much of a point's light is the finer grid's.
fn share_of(point: vec3f) -> f32 {
    let at = in_cells(point);
    let depths = min(at, grid.size.xyz - at);
    let depth = min(depths.x, min(depths.y, depths.z));
    return clamp((depth - FADES.x) / (FADES.y - FADES.x), 0.0, 1.0);
}

@compute @workgroup_size(TILE, TILE)
fn light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    var lit = vec3f(0.0);
    var share = 1.0;
    if surface_valid(at) {
        let point = view.eye.xyz + from_view(surface_position(at, pixels), view);
        lit = irradiance(point, from_view(surface_normal(at, pixels), view), 0u) / PI;
        if NESTED == 1u {
            share = share_of(point);
        }
    }
    for (var c = 0u; c < 3u; c++) {
        var all = lit[c];
        if NESTED == 1u {
            all = mix(image[at + c * pixels], all, share);
        }
        image[at + c * pixels] = all;
    }
}
