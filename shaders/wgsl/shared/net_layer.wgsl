// One layer of a network (thesis 7.3.2): what every pass of it shares.
//
// Channels go four by four: a texel holds four channels of a pixel, an array layer of a texture four channels of all
// pixels. An invocation makes some outputs (a Sum) of a square of 2x2 pixels, so that it reads a weight once for four
// pixels, and has at hand what 2x2 pooling needs. Loops over rows of the kernel and over blocks of four inputs stay
// loops, so that a driver's compiler ends in time; only those along a row are short enough to be unrolled.

const RADIUS = i32(KERNEL / 2u);
// Texels that 2 pixels of a row see.
const ROW = KERNEL + 1u;

alias Row = array<vec4<f32>, ROW>;
// Upper left, upper right, lower left, lower right.
alias Sums = array<Sum, 4>;

// What a group of outputs reads: first block of four inputs and number of blocks, of the image that the layer reads
// and, where it joins two, of the second one; and what its sums begin with.
struct Reads {
    first: u32,
    count: u32,
    skip_first: u32,
    skip_count: u32,
    bias: array<vec4<f32>, 2>,
}

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(1) var<storage, read> reads: array<Reads>;
@group(0) @binding(2) var<uniform> weights: array<Weight, WEIGHTS>;

fn begin(output: u32) -> Sums {
    let bias = bias_sum(reads[output].bias);
    return Sums(bias, bias, bias, bias);
}

// Adds one row of the kernel: `upper` and `lower` are the rows that it covers of the upper and the lower pixels.
fn add_row(sums: ptr<function, Sums>, upper: Row, lower: Row, first_weight: u32) {
    var up = upper;
    var low = lower;
    for (var x = 0u; x < KERNEL; x++) {
        let weight = weights[first_weight + x];
        (*sums)[0] += weighted(weight, up[x]);
        (*sums)[1] += weighted(weight, up[x + 1u]);
        (*sums)[2] += weighted(weight, low[x]);
        (*sums)[3] += weighted(weight, low[x + 1u]);
    }
}

// Whether a pixel of the layer's frame lies in it; around it are zeros.
fn inside(at: vec2<i32>) -> bool {
    return all(at >= vec2(0)) && at.x < i32(layer.width) && at.y < i32(layer.height);
}
