// Reads the network's input, planar `[channels, image_height, image_width]`, continued at bottom and right by its last
// row and column up to the layer's frame.

@group(0) @binding(4) var<storage, read> input: array<f32>;

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let y = u32(clamp(at.y, 0, i32(layer.image_height) - 1));
    let x = u32(clamp(at.x, 0, i32(layer.image_width) - 1));
    let plane = layer.image_height * layer.image_width;
    let last = layer.channels - 1u;
    let pixel = y * layer.image_width + x;
    let channel = min(4u * block + vec4(0u, 1u, 2u, 3u), vec4(last));
    let value = vec4(
        input[channel.x * plane + pixel],
        input[channel.y * plane + pixel],
        input[channel.z * plane + pixel],
        input[channel.w * plane + pixel],
    );
    return select(vec4(0.0), value, inside(at));
}
