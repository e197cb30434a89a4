// Adds a part to the image: what surfaces send, in their diffuse colour if it is REFLECTED, or what is
// between them and the eye.

#import uniforms/frame_view
#constant REFLECTED = 1

@group(0) @binding(0) var<uniform> view: FrameView;
// [3, height, width] each
@group(0) @binding(1) var<storage, read> part: array<f32>;
@group(0) @binding(2) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(3) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    for (var c = 0u; c < 3u; c++) {
        let at = id.y * view.width + id.x + c * pixels;
        // Where no surface is seen the diffuse colour is black.
        image[at] += part[at] * select(1.0, diffuse_planes[at], REFLECTED == 1u);
    }
}
