// Reads a single image, that of `texel`.

#import convolution/layer

fn texel_of(inputs: Inputs, at: vec2<i32>) -> vec4<f32> {
    return texel(inputs.block, at);
}
