// A layer of a network (thesis 7.3.2) on a GPU: what every part of it shares.
//
// Channels go four by four: a map is `[channels / 4, height, width]` of vectors of four. A workgroup makes a
// block of OUTPUTS outputs of a tile of pixels, an invocation those of PIXELS_X x PIXELS_Y neighbours, so
// that it reads a weight once for all of them and has at hand what 2x2 pooling needs.

#import uniforms/net_layer

const RADIUS = i32(KERNEL / 2u);
const TAPS = KERNEL * KERNEL;
const INVOCATIONS = WORKGROUP * WORKGROUP;
// Vectors of weights that four inputs have in a block of outputs.
const WEIGHTS = TAPS * OUTPUTS;

// What a block of outputs reads: first block of four inputs and number of blocks, of the image that the layer
// reads and, where it joins two, of the second one; and what its sums begin with.
struct Reads {
    first: u32,
    count: u32,
    skip_first: u32,
    skip_count: u32,
    bias: array<vec4<f32>, 4>,
}

// Four inputs of a block of outputs.
struct Inputs {
    // Which four of the image, and of which image where there are two.
    block: u32,
    skip: bool,
    // Where their weights begin.
    weight: u32,
    // What the workgroup's first pixel sees first.
    corner: vec2<i32>,
}

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(1) var<storage, read> reads: array<Reads>;
@group(0) @binding(2) var<storage, read> packed: array<vec4<f32>>;

// Whether a pixel of the layer's frame lies in it; around it are zeros. No `&&`, which browsers make branches
// of: those of all that is inlined here take software adapters minutes to compile.
fn inside(at: vec2<i32>) -> bool {
    return all((at >= vec2(0)) & (at < vec2(i32(layer.width), i32(layer.height))));
}

fn leaky(value: vec4<f32>) -> vec4<f32> {
    return select(value, layer.leak * value, value < vec4(0.0));
}
