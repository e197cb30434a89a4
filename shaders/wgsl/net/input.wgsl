// Channels of a network's input, planar `[channels, height, width]`: `write_channels`, which is generated,
// writes those that this pass is for.

#template
#import shared/net_frame
#import shared/surface_valid

@group(0) @binding(1) var<storage, read_write> input: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= frame.width || id.y >= frame.height) {
        return;
    }
    write_channels(id.xy, id.y * frame.width + id.x, frame.width * frame.height);
}
