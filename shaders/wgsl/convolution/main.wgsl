// The convolution. Pixels are written out, since a sum that a loop's counter chooses would lie in memory.

alias Sums = array<Sum, 8>;

fn pixel(index: u32) -> vec2<u32> {
    return vec2(index % PIXELS_X, index / PIXELS_X);
}

fn add_tap(sums: ptr<function, Sums>, inputs: Inputs, tap: u32, at: vec2<u32>) {
    let weight = weight_at(inputs, tap * OUTPUTS);
    (*sums)[0] += weighted(weight, seen(inputs, at));
    (*sums)[1] += weighted(weight, seen(inputs, at + pixel(1u)));
    if (PIXELS > 2u) {
        (*sums)[2] += weighted(weight, seen(inputs, at + pixel(2u)));
        (*sums)[3] += weighted(weight, seen(inputs, at + pixel(3u)));
    }
    if (PIXELS > 4u) {
        (*sums)[4] += weighted(weight, seen(inputs, at + pixel(4u)));
        (*sums)[5] += weighted(weight, seen(inputs, at + pixel(5u)));
        (*sums)[6] += weighted(weight, seen(inputs, at + pixel(6u)));
        (*sums)[7] += weighted(weight, seen(inputs, at + pixel(7u)));
    }
}

fn add_inputs(sums: ptr<function, Sums>, inputs: Inputs, at: vec2<u32>) {
    for (var y = 0u; y < KERNEL; y++) {
        for (var x = 0u; x < KERNEL; x++) {
            add_tap(sums, inputs, y * KERNEL + x, at + vec2(x, y));
        }
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
        var inputs: Inputs;
        inputs.skip = i >= coarse_count;
        inputs.block = select(
            reads[output].first + i, reads[output].skip_first + i - coarse_count, inputs.skip,
        );
        inputs.weight = output * layer.stride + i * WEIGHTS;
        inputs.corner = vec2<i32>(tile) - RADIUS;
        stage(inputs, index);
        add_inputs(&sums, inputs, at);
    }
    let corner = vec2<i32>(tile + at);
    activate(&sums);
    keep(&sums, corner, output);
    keep_means(&sums, corner, output);
}
