// No layer reads the means of 2x2 pixels.

fn store_mean_vector(at: vec2<i32>, block: u32, value: vec4<f32>) {}

fn keep_means(sums: ptr<function, Sums>, corner: vec2<i32>, output: u32) {}
