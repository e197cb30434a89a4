// Convolves the concatenation of two images that is never stored: the coarser level, doubled bilinearly on
// the way (pixel centres at halves, the edge continued outwards), and the same level's layer on the way down.
//
// A doubled pixel is 3/4 the coarse pixel in which it lies and 1/4 the next one on the side towards which it
// lies, so along an axis coarse pixels m0, m1, m2, ... become
//     3/4 m0 + 1/4 m1, 1/4 m0 + 3/4 m1, 3/4 m1 + 1/4 m2, 1/4 m1 + 3/4 m2, ...
// Where RADIUS is odd a kernel begins with the first of these, where it is even with the second.

#import shared/net_layer
#constant KERNEL = 3

@group(0) @binding(4) var coarse: texture_2d_array<f32>;
@group(0) @binding(5) var skip: texture_2d_array<f32>;

const ODD = RADIUS % 2 == 1;

// Coarse pixels of a row that the doubled rows of a kernel lie between: 3, or 5 where KERNEL is 5 or 7.
alias Columns = array<vec4<f32>, 5>;

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let last = vec2(i32(layer.width), i32(layer.height)) - 1;
    let value = textureLoad(skip, clamp(at, vec2(0), last), block, 0);
    return select(vec4(0.0), value, inside(at));
}

fn coarse_texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let last = vec2(i32(layer.width), i32(layer.height)) / 2 - 1;
    return textureLoad(coarse, clamp(at, vec2(0), last), block, 0);
}

fn columns_of(block: u32, at: vec2<i32>) -> Columns {
    var columns: Columns;
    columns[0] = coarse_texel(block, at);
    columns[1] = coarse_texel(block, at + vec2(1, 0));
    columns[2] = coarse_texel(block, at + vec2(2, 0));
    if (KERNEL > 3u) {
        columns[3] = coarse_texel(block, at + vec2(3, 0));
        columns[4] = coarse_texel(block, at + vec2(4, 0));
    }
    return columns;
}

fn mixed(near: vec4<f32>, far: vec4<f32>) -> vec4<f32> {
    return 0.75 * near + 0.25 * far;
}

// A doubled row from `at` on, zero outside the frame.
fn doubled(near: Columns, far: Columns, at: vec2<i32>) -> Row {
    let m0 = mixed(near[0], far[0]);
    let m1 = mixed(near[1], far[1]);
    let m2 = mixed(near[2], far[2]);
    let m3 = mixed(near[3], far[3]);
    let m4 = mixed(near[4], far[4]);
    var row = Row(
        mixed(m1, m0), mixed(m1, m2), mixed(m2, m1), mixed(m2, m3), mixed(m3, m2), mixed(m3, m4), m4, m4,
    );
    if (ODD) {
        row = Row(
            mixed(m0, m1), mixed(m1, m0), mixed(m1, m2), mixed(m2, m1),
            mixed(m2, m3), mixed(m3, m2), mixed(m3, m4), mixed(m4, m3),
        );
    }
    return Row(
        select(vec4(0.0), row[0], inside(at)),
        select(vec4(0.0), row[1], inside(at + vec2(1, 0))),
        select(vec4(0.0), row[2], inside(at + vec2(2, 0))),
        select(vec4(0.0), row[3], inside(at + vec2(3, 0))),
        select(vec4(0.0), row[4], inside(at + vec2(4, 0))),
        select(vec4(0.0), row[5], inside(at + vec2(5, 0))),
        select(vec4(0.0), row[6], inside(at + vec2(6, 0))),
        select(vec4(0.0), row[7], inside(at + vec2(7, 0))),
    );
}

// How far the convolution of a block has come downwards.
struct Progress {
    // The next coarse row, and the last one that was read.
    next: vec2<i32>,
    columns: Columns,
    // Where the next doubled row begins, and the last one.
    at: vec2<i32>,
    row: Row,
    // The next row of the kernel.
    weight: u32,
}

// Reads a coarse row, and adds two rows of the kernel: those that end with the two doubled rows above it.
fn add_pair(sums: ptr<function, Sums>, progress: ptr<function, Progress>, block: u32) {
    let upper = (*progress).columns;
    let lower = columns_of(block, (*progress).next);
    let first = doubled(upper, lower, (*progress).at);
    let second = doubled(lower, upper, (*progress).at + vec2(0, 1));
    add_row(sums, (*progress).weight, (*progress).row, first);
    add_row(sums, (*progress).weight + KERNEL, first, second);
    (*progress).next.y += 1;
    (*progress).columns = lower;
    (*progress).at.y += 2;
    (*progress).row = second;
    (*progress).weight += 2u * KERNEL;
}

// Adds a block of four inputs of the coarser level, whose rows are read once each.
fn add_coarse_block(sums: ptr<function, Sums>, first_weight: u32, block: u32, corner: vec2<i32>) {
    let origin = corner / 2 - (RADIUS + 2) / 2;
    let at = corner - RADIUS;
    let upper = columns_of(block, origin);
    let lower = columns_of(block, origin + vec2(0, 1));
    var progress = Progress(origin + vec2(0, 2), lower, at, Row(), first_weight);
    if (ODD) {
        let first = doubled(upper, lower, at);
        progress.row = doubled(lower, upper, at + vec2(0, 1));
        add_row(sums, first_weight, first, progress.row);
        progress.at.y += 2;
        progress.weight += KERNEL;
    } else {
        progress.row = doubled(lower, upper, at);
        progress.at.y += 1;
    }
    // The first pair is no turn of the loop: on lavapipe that makes the 3x3 kernel a third faster.
    if (KERNEL > 1u) {
        add_pair(sums, &progress, block);
    }
    if (KERNEL > 3u) {
        for (var pair = 1u; pair < (KERNEL - 1u) / 2u; pair++) {
            add_pair(sums, &progress, block);
        }
    }
    if (!ODD) {
        let beyond = columns_of(block, progress.next);
        add_row(sums, progress.weight, progress.row, doubled(progress.columns, beyond, progress.at));
    }
}

fn convolved(corner: vec2<i32>, output: u32) -> Sums {
    var sums = begin(output);
    let group = reads[output];
    let taps = KERNEL * KERNEL;
    let first_weight = output * layer.stride;
    for (var i = 0u; i < group.count; i++) {
        add_coarse_block(&sums, first_weight + i * taps, group.first + i, corner);
    }
    for (var i = 0u; i < group.skip_count; i++) {
        add_block(&sums, first_weight + (group.count + i) * taps, group.skip_first + i, corner);
    }
    return sums;
}
