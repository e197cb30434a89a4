// Four outputs at a time.

#import convolution/four_outputs
#import convolution/layer

alias Sum = vec4<f32>;
alias Weight = mat4x4<f32>;

fn weight_at(inputs: Inputs, tap: u32) -> Weight {
    return four(inputs, tap, 0u);
}

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return weight * value;
}

fn bias_sum(output: u32) -> Sum {
    return reads[output].bias[0];
}

fn activated(sum: Sum) -> Sum {
    return leaky(sum);
}

fn store(at: vec2<i32>, output: u32, sum: Sum) {
    store_vector(at, output, sum);
}

fn store_mean(at: vec2<i32>, output: u32, sum: Sum) {
    store_mean_vector(at, output, sum);
}
