// A workgroup brings the four inputs that its tile of pixels sees, and their weights, into its own memory.

#import convolution/layer

const STAGE_X = WORKGROUP * PIXELS_X + KERNEL - 1u;
const STAGE_Y = WORKGROUP * PIXELS_Y + KERNEL - 1u;
// Columns of the stage with the same remainder lie together, so that invocations side by side, which are
// PIXELS_X columns apart, read vectors side by side and no bank of the memory twice.
const PITCH = (STAGE_X + PIXELS_X - 1u) / PIXELS_X;

var<workgroup> staged: array<array<array<vec4<f32>, PITCH>, PIXELS_X>, STAGE_Y>;
var<workgroup> weights: array<array<vec4<f32>, OUTPUTS>, TAPS>;

fn stage(inputs: Inputs, index: u32) {
    workgroupBarrier();
    for (var i = index; i < WEIGHTS; i += INVOCATIONS) {
        weights[i / OUTPUTS][i % OUTPUTS] = packed[inputs.weight + i];
    }
    for (var i = index; i < STAGE_X * STAGE_Y; i += INVOCATIONS) {
        let at = vec2(i % STAGE_X, i / STAGE_X);
        staged[at.y][at.x % PIXELS_X][at.x / PIXELS_X] = texel_of(inputs, inputs.corner + vec2<i32>(at));
    }
    workgroupBarrier();
}

// What a pixel sees that lies `column` columns to the right of an invocation's first one in the stage's row
// `row`.
fn seen(inputs: Inputs, invocation: u32, row: u32, column: u32) -> vec4<f32> {
    return staged[row][column % PIXELS_X][invocation + column / PIXELS_X];
}

fn weight_vector(inputs: Inputs, tap: u32, index: u32) -> vec4<f32> {
    return weights[tap][index];
}
