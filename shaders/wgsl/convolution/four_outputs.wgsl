// Of four inputs in four outputs: a column an input.
fn four(inputs: Inputs, first: u32) -> mat4x4<f32> {
    return mat4x4(
        weight_vector(inputs, first),
        weight_vector(inputs, first + 1u),
        weight_vector(inputs, first + 2u),
        weight_vector(inputs, first + 3u),
    );
}
