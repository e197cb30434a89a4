// A workgroup brings the four inputs that its tile of pixels sees, and their weights, into its own memory.

const STAGE_X = WORKGROUP * PIXELS_X + KERNEL - 1u;
const STAGE_Y = WORKGROUP * PIXELS_Y + KERNEL - 1u;
// Columns of the stage with the same remainder: they lie together, so that invocations side by side, which are PIXELS_X
// columns apart, read vectors side by side and no bank of the memory twice.
const PITCH = (STAGE_X + PIXELS_X - 1u) / PIXELS_X;

var<workgroup> staged: array<vec4<f32>, PITCH * PIXELS_X * STAGE_Y>;
var<workgroup> weights: array<vec4<f32>, WEIGHTS>;

fn slot(at: vec2<u32>) -> u32 {
    return (at.y * PIXELS_X + at.x % PIXELS_X) * PITCH + at.x / PIXELS_X;
}

fn stage(inputs: Inputs, index: u32) {
    workgroupBarrier();
    for (var i = index; i < WEIGHTS; i += INVOCATIONS) {
        weights[i] = packed[inputs.weight + i];
    }
    for (var i = index; i < STAGE_X * STAGE_Y; i += INVOCATIONS) {
        let at = vec2(i % STAGE_X, i / STAGE_X);
        staged[slot(at)] = texel_of(inputs, inputs.corner + vec2<i32>(at));
    }
    workgroupBarrier();
}

fn seen(inputs: Inputs, at: vec2<u32>) -> vec4<f32> {
    return staged[slot(at)];
}

fn weight_vector(inputs: Inputs, index: u32) -> vec4<f32> {
    return weights[index];
}
