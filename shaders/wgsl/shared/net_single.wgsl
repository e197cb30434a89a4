// Convolves a single image, that of `texel`.

#import shared/net_layer
#constant KERNEL = 3

fn convolved(corner: vec2<i32>, output: u32) -> Sums {
    var sums = begin(output);
    let first = reads[output].first;
    let count = reads[output].count;
    for (var i = 0u; i < count; i++) {
        add_block(&sums, output * layer.stride + i * KERNEL * KERNEL, first + i, corner);
    }
    return sums;
}
