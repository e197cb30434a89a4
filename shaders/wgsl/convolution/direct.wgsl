// An invocation reads what it needs by itself and leaves it to the caches to bring it once.

fn stage(inputs: Inputs, index: u32) {}

fn seen(inputs: Inputs, at: vec2<u32>) -> vec4<f32> {
    return texel_of(inputs, inputs.corner + vec2<i32>(at));
}

fn weight_vector(inputs: Inputs, index: u32) -> vec4<f32> {
    return packed[inputs.weight + index];
}
