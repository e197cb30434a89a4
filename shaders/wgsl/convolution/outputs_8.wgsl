// Eight outputs at a time.

#import convolution/four_outputs
#import convolution/layer

alias Sum = mat2x4<f32>;

struct Weight {
    low: mat4x4<f32>,
    high: mat4x4<f32>,
}

fn weight_at(inputs: Inputs, tap: u32) -> Weight {
    return Weight(four(inputs, tap, 0u), four(inputs, tap, 4u));
}

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return Sum(weight.low * value, weight.high * value);
}

fn bias_sum(output: u32) -> Sum {
    return Sum(reads[output].bias[0], reads[output].bias[1]);
}

fn activated(sum: Sum) -> Sum {
    return Sum(leaky(sum[0]), leaky(sum[1]));
}

fn store(at: vec2<i32>, output: u32, sum: Sum) {
    store_vector(at, 2u * output, sum[0]);
    store_vector(at, 2u * output + 1u, sum[1]);
}

fn store_mean(at: vec2<i32>, output: u32, sum: Sum) {
    store_mean_vector(at, 2u * output, sum[0]);
    store_mean_vector(at, 2u * output + 1u, sum[1]);
}
