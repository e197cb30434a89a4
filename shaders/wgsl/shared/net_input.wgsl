// Reads the network's input, continued at bottom and right by its last row and column up to the layer's
// frame.

#import shared/net_window

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let last = vec2(i32(layer.image_width), i32(layer.image_height)) - 1;
    let value = input_channels(block, vec2<u32>(clamp(image_pixel(at), vec2(0), last)));
    return select(vec4(0.0), value, inside(at));
}
