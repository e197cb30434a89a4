// One layer of a network (thesis 7.3.2): what every pass of it shares.
//
// Channels go four by four: a texel holds four channels of a pixel, an array layer of a texture four channels
// of all pixels. An invocation makes some outputs (a Sum) of a square of 2x2 pixels, so that it reads a
// weight once for four pixels, and has at hand what 2x2 pooling needs.
//
// Loops go over blocks of four inputs and over rows of the kernel, so that a driver's compiler ends in time.
// A row is written out for the largest kernel, and what KERNEL makes superfluous falls away: an array indexed
// by a loop's counter would lie in memory instead of registers, which takes twice the time on lavapipe.

#import uniforms/net_layer
#constant KERNEL = 3

const RADIUS = i32(KERNEL / 2u);

// What 2 pixels of a row see: KERNEL + 1 texels.
alias Row = array<vec4<f32>, 8>;
// Upper left, upper right, lower left, lower right.
alias Sums = array<Sum, 4>;

// What a group of outputs reads: first block of four inputs and number of blocks, of the image that the layer
// reads and, where it joins two, of the second one; and what its sums begin with.
struct Reads {
    first: u32,
    count: u32,
    skip_first: u32,
    skip_count: u32,
    bias: array<vec4<f32>, 4>,
}

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(1) var<storage, read> reads: array<Reads>;
@group(0) @binding(2) var<uniform> weights: array<Weight, WEIGHTS>;

// Whether a pixel of the layer's frame lies in it; around it are zeros. No `&&`, which browsers make branches
// of: those of all that is inlined here take software adapters minutes to compile.
fn inside(at: vec2<i32>) -> bool {
    return all((at >= vec2(0)) & (at < vec2(i32(layer.width), i32(layer.height))));
}

fn begin(output: u32) -> Sums {
    let bias = bias_sum(reads[output].bias);
    return Sums(bias, bias, bias, bias);
}

// Adds one weight's share of the four pixels.
fn add_tap(sums: ptr<function, Sums>, weight_at: u32, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) {
    let weight = weights[weight_at];
    (*sums)[0] += weighted(weight, a);
    (*sums)[1] += weighted(weight, b);
    (*sums)[2] += weighted(weight, c);
    (*sums)[3] += weighted(weight, d);
}

// Adds one row of the kernel; `up` and `low` are the rows that it covers of the upper and of the lower
// pixels.
fn add_row(sums: ptr<function, Sums>, weight: u32, up: Row, low: Row) {
    add_tap(sums, weight, up[0], up[1], low[0], low[1]);
    if (KERNEL > 1u) {
        add_tap(sums, weight + 1u, up[1], up[2], low[1], low[2]);
        add_tap(sums, weight + 2u, up[2], up[3], low[2], low[3]);
    }
    if (KERNEL > 3u) {
        add_tap(sums, weight + 3u, up[3], up[4], low[3], low[4]);
        add_tap(sums, weight + 4u, up[4], up[5], low[4], low[5]);
    }
    if (KERNEL > 5u) {
        add_tap(sums, weight + 5u, up[5], up[6], low[5], low[6]);
        add_tap(sums, weight + 6u, up[6], up[7], low[6], low[7]);
    }
}

// A row of the image that `texel` reads, from `at` on.
fn row_of(block: u32, at: vec2<i32>) -> Row {
    var row: Row;
    row[0] = texel(block, at);
    row[1] = texel(block, at + vec2(1, 0));
    if (KERNEL > 1u) {
        row[2] = texel(block, at + vec2(2, 0));
        row[3] = texel(block, at + vec2(3, 0));
    }
    if (KERNEL > 3u) {
        row[4] = texel(block, at + vec2(4, 0));
        row[5] = texel(block, at + vec2(5, 0));
    }
    if (KERNEL > 5u) {
        row[6] = texel(block, at + vec2(6, 0));
        row[7] = texel(block, at + vec2(7, 0));
    }
    return row;
}

// Adds a block of four inputs of the image that `texel` reads.
fn add_block(sums: ptr<function, Sums>, first_weight: u32, block: u32, corner: vec2<i32>) {
    let at = corner - RADIUS;
    var weight = first_weight;
    var up = row_of(block, at);
    for (var y = 1; y <= i32(KERNEL); y++) {
        let low = row_of(block, at + vec2(0, y));
        add_row(sums, weight, up, low);
        up = low;
        weight += KERNEL;
    }
}
