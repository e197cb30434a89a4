// What reprojection reads: planes [4, height, width] of how far each pixel's surface moved in the image since
// the frame before, x to the right and y up, pixels; of its depth, metres, and of the depth that it had then.
// All 0 where nothing is seen; what was behind the eye had a depth of 0 and moved by 0.

#import shared/seen
#import shared/view
#import uniforms/frame_view

// From where the frame before was seen.
@group(0) @binding(6) var<uniform> before: FrameView;
@group(0) @binding(7) var<storage, read_write> since_before: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn write_since(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let seen = seen_at(id.xy);
    var values = vec4f(0.0);
    if seen.valid {
        let was = seen.offset - seen.way + view.eye.xyz - before.eye.xyz;
        let depth_then = max(-to_view(was, before).z, 0.0);
        let movement = in_image(seen.offset, view) - in_image(was, before);
        values = vec4f(select(vec2f(0.0), movement, depth_then > 0.0), seen.depth, depth_then);
    }
    let pixels = view.width * view.height;
    let index = id.y * view.width + id.x;
    for (var c = 0u; c < 4u; c++) {
        since_before[index + c * pixels] = values[c];
    }
}
