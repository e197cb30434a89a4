// Reads the network's input at half the resolution, the pixels of a square of four as channels: BLOCKS blocks
// of four channels of each. The input is continued at bottom and right by its last row and column up to the
// layer's frame.

#import convolution/layer
#import shared/net_window

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let square = i32(block / BLOCKS);
    let last = vec2(i32(layer.image_width), i32(layer.image_height)) - 1;
    let pixel = image_pixel(2 * at + vec2(square % 2, square / 2));
    let value = input_channels(block % BLOCKS, vec2<u32>(clamp(pixel, vec2(0), last)));
    return select(vec4(0.0), value, inside(at));
}
