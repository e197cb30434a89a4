// Eight outputs at a time, with a leaky ReLU, into two array layers of a texture.

const WEIGHTS = 512u;

// Outputs 0 to 3 and 4 to 7.
alias Sum = mat2x4<f32>;

// Of four inputs in eight outputs: a column an input.
struct Weight {
    low: mat4x4<f32>,
    high: mat4x4<f32>,
}

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return Sum(weight.low * value, weight.high * value);
}

fn bias_sum(bias: array<vec4<f32>, 4>) -> Sum {
    return Sum(bias[0], bias[1]);
}

fn leaky(value: vec4<f32>) -> vec4<f32> {
    return select(value, layer.leak * value, value < vec4(0.0));
}

fn activated(sum: Sum) -> Sum {
    return Sum(leaky(sum[0]), leaky(sum[1]));
}

fn activated_all(sums: Sums) -> Sums {
    return Sums(activated(sums[0]), activated(sums[1]), activated(sums[2]), activated(sums[3]));
}

@group(0) @binding(3) var made: texture_storage_2d_array<rgba32float, write>;

// Eight outputs of a pixel; a frame of odd width or height has no room for some of its last 2x2 pixels.
fn store_pixel(at: vec2<i32>, output: u32, sum: Sum) {
    if (inside(at)) {
        textureStore(made, at, 2u * output, sum[0]);
        textureStore(made, at, 2u * output + 1u, sum[1]);
    }
}

fn store(corner: vec2<i32>, output: u32, sums: Sums) {
    store_pixel(corner, output, sums[0]);
    store_pixel(corner + vec2(1, 0), output, sums[1]);
    store_pixel(corner + vec2(0, 1), output, sums[2]);
    store_pixel(corner + vec2(1, 1), output, sums[3]);
}
