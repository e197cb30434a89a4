// The 2x2 mean of the pixels, which the level below reads.

#import shared/net_layer

@group(0) @binding(5) var pool: texture_storage_2d_array<rgba32float, write>;

fn store_mean(corner: vec2<i32>, output: u32, sums: Sums) {
    let mean = 0.25 * (sums[0] + sums[1] + sums[2] + sums[3]);
    textureStore(pool, corner / 2, 2u * output, mean[0]);
    textureStore(pool, corner / 2, 2u * output + 1u, mean[1]);
}
