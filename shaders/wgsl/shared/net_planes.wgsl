// The network's input as one buffer, planar `[channels, image_height, image_width]`.

@group(0) @binding(4) var<storage, read> input: array<f32>;

fn input_channels(block: u32, pixel: vec2<u32>) -> vec4<f32> {
    let plane = layer.image_height * layer.image_width;
    let at = pixel.y * layer.image_width + pixel.x;
    let channel = min(4u * block + vec4(0u, 1u, 2u, 3u), vec4(layer.channels - 1u));
    return vec4(
        input[channel.x * plane + at],
        input[channel.y * plane + at],
        input[channel.z * plane + at],
        input[channel.w * plane + at],
    );
}
