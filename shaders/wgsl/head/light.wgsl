// The finest level of the pyramid that a head reads, and before it the estimate where there is one: channels
// of the network's input, continued at bottom and right by their last row and column up to the frame.

#template
#import uniforms/net_layer

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(3) var<storage, read_write> pyramid: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let pixel = min(id.xy, vec2(layer.image_width, layer.image_height) - 1u);
    for (var plane = 0u; plane < PLANES; plane++) {
        // Estimates come first.
        let is_level = PLANES == CHANNELS || plane >= CHANNELS;
        let channel = select(ESTIMATE, FIRST, is_level) + plane % CHANNELS;
        let value = input_channels(channel / 4u, pixel)[channel % 4u];
        pyramid[(plane * layer.height + id.y) * layer.width + id.x] = value;
    }
}
