// One output at a time, without an activation, cropped to the network's image: planar
// `[outputs, image_height, image_width]`.

const WEIGHTS = 4096u;

alias Sum = f32;

// Of four inputs.
alias Weight = vec4<f32>;

fn weighted(weight: Weight, value: vec4<f32>) -> Sum {
    return dot(weight, value);
}

fn bias_sum(bias: array<vec4<f32>, 4>) -> Sum {
    return bias[0].x;
}

@group(0) @binding(3) var<storage, read_write> made: array<f32>;

fn store_pixel(at: vec2<i32>, output: u32, sum: Sum) {
    let pixel = image_pixel(at);
    if (kept(pixel)) {
        let row = output * layer.image_height + u32(pixel.y);
        made[row * layer.image_width + u32(pixel.x)] = sum;
    }
}

fn store(corner: vec2<i32>, output: u32, sums: Sums) {
    store_pixel(corner, output, sums[0]);
    store_pixel(corner + vec2(1, 0), output, sums[1]);
    store_pixel(corner + vec2(0, 1), output, sums[2]);
    store_pixel(corner + vec2(1, 1), output, sums[3]);
}
