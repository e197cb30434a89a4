// An invocation reads what it needs by itself and leaves it to the caches to bring it once.

#import convolution/layer

fn stage(inputs: Inputs, index: u32) {}

fn seen(inputs: Inputs, invocation: u32, row: u32, column: u32) -> vec4<f32> {
    return texel_of(inputs, inputs.corner + vec2<i32>(vec2(invocation * PIXELS_X + column, row)));
}

fn weight_vector(inputs: Inputs, tap: u32, index: u32) -> vec4<f32> {
    return packed[inputs.weight + tap * OUTPUTS + index];
}
