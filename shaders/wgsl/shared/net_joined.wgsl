// Convolves the concatenation of two images that is never stored: the coarser level, doubled bilinearly on the way
// (pixel centres at halves, the edge continued outwards), and the same level's layer on the way down.

@group(0) @binding(4) var coarse: texture_2d_array<f32>;
@group(0) @binding(5) var skip: texture_2d_array<f32>;

// Coarse pixels on either side of the one in which the 2x2 pixels lie that a row needs, and how many that makes.
const SPAN = (RADIUS + 2) / 2;
const COLUMNS = 2 * SPAN + 1;

// A pixel of the coarser level between two rows of it.
fn between(block: u32, x: i32, rows: vec2<i32>) -> vec4<f32> {
    let column = clamp(x, 0, i32(layer.width / 2u) - 1);
    let near = textureLoad(coarse, vec2(column, rows.x), block, 0);
    let far = textureLoad(coarse, vec2(column, rows.y), block, 0);
    return 0.75 * near + 0.25 * far;
}

fn coarse_row(block: u32, at: vec2<i32>) -> Row {
    // A new pixel is 3/4 the old one in which it lies and 1/4 the next one on the side towards which it lies.
    let near = at.y >> 1u;
    let far = near + select(-1, 1, (at.y & 1) == 1);
    let rows = clamp(vec2(near, far), vec2(0), vec2(i32(layer.height / 2u) - 1));
    let middle = (at.x + RADIUS) / 2;
    var columns: array<vec4<f32>, COLUMNS>;
    for (var x = 0; x < COLUMNS; x++) {
        columns[x] = between(block, middle - SPAN + x, rows);
    }
    var row: Row;
    for (var x = 0; x < i32(ROW); x++) {
        let offset = x - RADIUS;
        let column = (offset >> 1u) + SPAN;
        let other = column + select(-1, 1, (offset & 1) == 1);
        let value = 0.75 * columns[column] + 0.25 * columns[other];
        row[x] = select(vec4(0.0), value, inside(at + vec2(x, 0)));
    }
    return row;
}

fn skip_row(block: u32, at: vec2<i32>) -> Row {
    let last = vec2(i32(layer.width), i32(layer.height)) - 1;
    var row: Row;
    for (var x = 0; x < i32(ROW); x++) {
        let pixel = at + vec2(x, 0);
        let value = textureLoad(skip, clamp(pixel, vec2(0), last), block, 0);
        row[x] = select(vec4(0.0), value, inside(pixel));
    }
    return row;
}

fn convolved(corner: vec2<i32>, output: u32) -> Sums {
    var sums = begin(output);
    let group = reads[output];
    let at = corner - RADIUS;
    var weight = output * layer.stride;
    for (var block = group.first; block < group.first + group.count; block++) {
        var upper = coarse_row(block, at);
        for (var y = 0u; y < KERNEL; y++) {
            let lower = coarse_row(block, at + vec2(0, i32(y) + 1));
            add_row(&sums, upper, lower, weight);
            upper = lower;
            weight += KERNEL;
        }
    }
    for (var block = group.skip_first; block < group.skip_first + group.skip_count; block++) {
        var upper = skip_row(block, at);
        for (var y = 0u; y < KERNEL; y++) {
            let lower = skip_row(block, at + vec2(0, i32(y) + 1));
            add_row(&sums, upper, lower, weight);
            upper = lower;
            weight += KERNEL;
        }
    }
    return sums;
}
