// Light of the environment, from what is seen of it in some directions and all that there is in them: the
// same share of what arrives at an open surface. It is added to what is in the image already if there is
// OTHER light.

#import shared/environment
#import shared/environment_height
#import shared/view
#import uniforms/frame_view
#constant OTHER = 0

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> normal_planes: array<f32>;
@group(0) @binding(2) var<storage, read> valid_plane: array<f32>;
// Each direction's texel irradiance over pi of a surface that faces it.
@group(0) @binding(3) var<storage, read> environment: array<vec4f>;
// [3, height, width] each
@group(0) @binding(4) var<storage, read> seen: array<f32>;
@group(0) @binding(5) var<storage, read> whole: array<f32>;
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

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
        let plane = at + c * pixels;
        let light = open[c] * seen[plane] / max(whole[plane], LEAST);
        image[plane] = light + select(0.0, image[plane], OTHER == 1u);
    }
}
