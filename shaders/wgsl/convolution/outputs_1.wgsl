// One output at a time: of an image of one channel.

#import convolution/layer

alias Sum = f32;
alias Weight = vec4<f32>;

fn weight_at(inputs: Inputs, tap: u32) -> Weight {
    return weight_vector(inputs, tap, 0u);
}

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return dot(weight, value);
}

fn bias_sum(output: u32) -> Sum {
    return reads[output].bias[0].x;
}

fn store(at: vec2<i32>, output: u32, sum: Sum) {
    store_vector(at, output, vec4(sum, 0.0, 0.0, 0.0));
}
