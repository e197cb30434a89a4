// Directional occlusion from the light that is blocked: what arrives at an open surface less that.

#import shared/environment
#import shared/environment_height
#import shared/view
#import uniforms/frame_view
#import uniforms/level_sum

@group(0) @binding(0) var<uniform> image_size: LevelSum;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> normal_planes: array<f32>;
@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;
// Each direction's texel irradiance over pi of a surface that faces it.
@group(0) @binding(4) var<storage, read> environment: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn open(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let pixels = image_size.width * image_size.height;
    let at = id.y * image_size.width + id.x;
    var light = vec3f(image_size.background);
    if valid_plane[at] > 0.5 {
        let normal = vec3f(normal_planes[at], normal_planes[at + pixels], normal_planes[at + 2u * pixels]);
        let blocked = vec3f(image[at], image[at + pixels], image[at + 2u * pixels]);
        light = max(environment_radiance(0u, environment_height(), from_view(normal, view)) - blocked, vec3f(0.0));
    }
    image[at] = light.x;
    image[at + pixels] = light.y;
    image[at + 2u * pixels] = light.z;
}
