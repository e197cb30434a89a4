// The convolution. Pixels and columns of the kernel are written out, and what the constants make superfluous
// falls away: an array indexed by a loop's counter would lie in memory. A row of what the pixels see is read
// once: the lower row of pixels sees in one row of the kernel what the upper one sees in the next.

#template
#import convolution/layer
#import shared/net_window

alias Sums = array<Sum, 8>;

// What PIXELS_X pixels of a row see: SEEN vectors, at most 4 + 7 - 1.
alias Row = array<vec4<f32>, 10>;
const SEEN = PIXELS_X + KERNEL - 1u;
// The last row that pixels see.
const LAST = PIXELS_Y + KERNEL - 2u;

// What the pixels of a row see through one column of the kernel.
alias Column = mat4x4<f32>;

fn pixel(index: u32) -> vec2<u32> {
    return vec2(index % PIXELS_X, index / PIXELS_X);
}

fn row_of(inputs: Inputs, invocation: u32, at: u32) -> Row {
    var row: Row;
    row[0] = seen(inputs, invocation, at, 0u);
    row[1] = seen(inputs, invocation, at, 1u);
    if (SEEN > 2u) {
        row[2] = seen(inputs, invocation, at, 2u);
        row[3] = seen(inputs, invocation, at, 3u);
    }
    if (SEEN > 4u) {
        row[4] = seen(inputs, invocation, at, 4u);
        row[5] = seen(inputs, invocation, at, 5u);
    }
    if (SEEN > 6u) {
        row[6] = seen(inputs, invocation, at, 6u);
        row[7] = seen(inputs, invocation, at, 7u);
    }
    if (SEEN > 8u) {
        row[8] = seen(inputs, invocation, at, 8u);
        row[9] = seen(inputs, invocation, at, 9u);
    }
    return row;
}

fn add_tap(sums: ptr<function, Sums>, weight: Weight, up: Column, low: Column) {
    (*sums)[0] += weighted(weight, up[0]);
    (*sums)[1] += weighted(weight, up[1]);
    if (PIXELS_X > 2u) {
        (*sums)[2] += weighted(weight, up[2]);
        (*sums)[3] += weighted(weight, up[3]);
    }
    if (PIXELS_Y > 1u) {
        (*sums)[PIXELS_X] += weighted(weight, low[0]);
        (*sums)[PIXELS_X + 1u] += weighted(weight, low[1]);
        if (PIXELS_X > 2u) {
            (*sums)[6] += weighted(weight, low[2]);
            (*sums)[7] += weighted(weight, low[3]);
        }
    }
}

// Adds one row of the kernel, the first of whose weights is that of index `tap`; `up` and `low` are what the
// upper and the lower pixels see of it.
fn add_row(sums: ptr<function, Sums>, inputs: Inputs, tap: u32, up: Row, low: Row) {
    add_tap(
        sums, weight_at(inputs, tap), Column(up[0], up[1], up[2], up[3]), Column(low[0], low[1], low[2], low[3]),
    );
    if (KERNEL > 1u) {
        add_tap(
            sums, weight_at(inputs, tap + 1u),
            Column(up[1], up[2], up[3], up[4]), Column(low[1], low[2], low[3], low[4]),
        );
        add_tap(
            sums, weight_at(inputs, tap + 2u),
            Column(up[2], up[3], up[4], up[5]), Column(low[2], low[3], low[4], low[5]),
        );
    }
    if (KERNEL > 3u) {
        add_tap(
            sums, weight_at(inputs, tap + 3u),
            Column(up[3], up[4], up[5], up[6]), Column(low[3], low[4], low[5], low[6]),
        );
        add_tap(
            sums, weight_at(inputs, tap + 4u),
            Column(up[4], up[5], up[6], up[7]), Column(low[4], low[5], low[6], low[7]),
        );
    }
    if (KERNEL > 5u) {
        add_tap(
            sums, weight_at(inputs, tap + 5u),
            Column(up[5], up[6], up[7], up[8]), Column(low[5], low[6], low[7], low[8]),
        );
        add_tap(
            sums, weight_at(inputs, tap + 6u),
            Column(up[6], up[7], up[8], up[9]), Column(low[6], low[7], low[8], low[9]),
        );
    }
}

fn add_inputs(sums: ptr<function, Sums>, inputs: Inputs, local: vec2<u32>) {
    let first = local.y * PIXELS_Y;
    var up = row_of(inputs, local.x, first);
    for (var y = 0u; y < KERNEL; y++) {
        // A single row of pixels sees no further row in the end.
        let low = row_of(inputs, local.x, first + min(y + 1u, LAST));
        add_row(sums, inputs, y * KERNEL, up, low);
        up = low;
    }
}

fn keep(sums: ptr<function, Sums>, corner: vec2<i32>, output: u32) {
    store(corner, output, (*sums)[0]);
    store(corner + vec2<i32>(pixel(1u)), output, (*sums)[1]);
    if (PIXELS > 2u) {
        store(corner + vec2<i32>(pixel(2u)), output, (*sums)[2]);
        store(corner + vec2<i32>(pixel(3u)), output, (*sums)[3]);
    }
    if (PIXELS > 4u) {
        store(corner + vec2<i32>(pixel(4u)), output, (*sums)[4]);
        store(corner + vec2<i32>(pixel(5u)), output, (*sums)[5]);
        store(corner + vec2<i32>(pixel(6u)), output, (*sums)[6]);
        store(corner + vec2<i32>(pixel(7u)), output, (*sums)[7]);
    }
}

@compute @workgroup_size(WORKGROUP, WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let tile = group.xy * WORKGROUP * vec2(PIXELS_X, PIXELS_Y);
    let at = local.xy * vec2(PIXELS_X, PIXELS_Y);
    let output = group.z;
    let coarse_count = reads[output].count;
    let count = coarse_count + reads[output].skip_count;
    let bias = bias_sum(output);
    var sums = Sums(bias, bias, bias, bias, bias, bias, bias, bias);
    for (var i = 0u; i < count; i++) {
        var inputs = Inputs();
        inputs.skip = i >= coarse_count;
        inputs.block = select(
            reads[output].first + i, reads[output].skip_first + i - coarse_count, inputs.skip,
        );
        inputs.weight = output * layer.stride + i * WEIGHTS;
        inputs.corner = vec2<i32>(tile) - RADIUS;
        stage(inputs, index);
        add_inputs(&sums, inputs, local.xy);
    }
    let corner = vec2<i32>(tile + at);
    activate(&sums);
    keep(&sums, corner, output);
    keep_means(&sums, corner, output);
}
