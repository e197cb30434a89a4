// Of four inputs in four outputs: a column an input.
#import convolution/layer

fn four(inputs: Inputs, tap: u32, first: u32) -> mat4x4<f32> {
    return mat4x4(
        weight_vector(inputs, tap, first),
        weight_vector(inputs, tap, first + 1u),
        weight_vector(inputs, tap, first + 2u),
        weight_vector(inputs, tap, first + 3u),
    );
}
