// Sixteen outputs at a time.

#import convolution/four_outputs
#import convolution/layer

alias Sum = mat4x4<f32>;

struct Weight {
    a: mat4x4<f32>,
    b: mat4x4<f32>,
    c: mat4x4<f32>,
    d: mat4x4<f32>,
}

fn weight_at(inputs: Inputs, tap: u32) -> Weight {
    return Weight(
        four(inputs, tap, 0u), four(inputs, tap, 4u), four(inputs, tap, 8u), four(inputs, tap, 12u),
    );
}

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return Sum(weight.a * value, weight.b * value, weight.c * value, weight.d * value);
}

fn bias_sum(output: u32) -> Sum {
    return Sum(reads[output].bias[0], reads[output].bias[1], reads[output].bias[2], reads[output].bias[3]);
}

fn activated(sum: Sum) -> Sum {
    return Sum(leaky(sum[0]), leaky(sum[1]), leaky(sum[2]), leaky(sum[3]));
}

fn store(at: vec2<i32>, output: u32, sum: Sum) {
    store_vector(at, 4u * output, sum[0]);
    store_vector(at, 4u * output + 1u, sum[1]);
    store_vector(at, 4u * output + 2u, sum[2]);
    store_vector(at, 4u * output + 3u, sum[3]);
}

fn store_mean(at: vec2<i32>, output: u32, sum: Sum) {
    store_mean_vector(at, 4u * output, sum[0]);
    store_mean_vector(at, 4u * output + 1u, sum[1]);
    store_mean_vector(at, 4u * output + 2u, sum[2]);
    store_mean_vector(at, 4u * output + 3u, sum[3]);
}
