// Keeps the means of 2x2 pixels too, which the level below reads. An invocation has whole squares.

#import convolution/layer

@group(0) @binding(5) var<storage, read_write> means: array<Texel>;

fn store_mean_vector(at: vec2<i32>, block: u32, value: vec4<f32>) {
    if (inside(2 * at)) {
        let size = vec2(layer.width, layer.height) / 2u;
        means[(block * size.y + u32(at.y)) * size.x + u32(at.x)] = Texel(value);
    }
}

fn keep_means(sums: ptr<function, Sums>, corner: vec2<i32>, output: u32) {
    let first = 0.25 * ((*sums)[0] + (*sums)[1] + (*sums)[PIXELS_X] + (*sums)[PIXELS_X + 1u]);
    store_mean(corner / 2, output, first);
    if (PIXELS_X > 2u) {
        let second = 0.25 * ((*sums)[2] + (*sums)[3] + (*sums)[6] + (*sums)[7]);
        store_mean(corner / 2 + vec2(1, 0), output, second);
    }
}
