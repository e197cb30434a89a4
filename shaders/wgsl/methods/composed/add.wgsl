// Adds a part to the image: what is between surfaces and the eye, or what surfaces send; if it is REFLECTED,
// as much of it as they reflect.

#import uniforms/frame_view
#constant REFLECTED = 1

@group(0) @binding(0) var<uniform> view: FrameView;
// [3, height, width] each
@group(0) @binding(1) var<storage, read> part: array<f32>;
@group(0) @binding(2) var<storage, read> reflectances: array<f32>;
@group(0) @binding(3) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    for (var c = 0u; c < 3u; c++) {
        let at = id.y * view.width + id.x + c * pixels;
        image[at] += part[at] * select(1.0, reflectances[at], REFLECTED == 1u);
    }
}
