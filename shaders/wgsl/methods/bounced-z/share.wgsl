// Light of the environment, from what is seen of it in some directions and all that there is in them: the
// same share of what arrives at an open surface.

#import shared/environment
#import shared/environment_height
#import shared/view
#import uniforms/frame_view

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> normal_planes: array<f32>;
@group(0) @binding(2) var<storage, read> valid_plane: array<f32>;
// Each direction's texel irradiance over pi of a surface that faces it.
@group(0) @binding(3) var<storage, read> environment: array<vec4f>;
@group(0) @binding(4) var<storage, read> all: array<f32>;
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

// Less light is none.
const LEAST = 1e-30;

@compute @workgroup_size(TILE, TILE)
fn share(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    var open = vec3f(0.0);
    if valid_plane[at] > 0.5 {
        let normal = vec3f(normal_planes[at], normal_planes[at + pixels], normal_planes[at + 2u * pixels]);
        open = environment_radiance(0u, environment_height(), from_view(normal, view));
    }
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] *= open[c] / max(all[at + c * pixels], LEAST);
    }
}
