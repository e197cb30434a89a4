// Convolves a single image, that of `texel`.

fn row_of(block: u32, at: vec2<i32>) -> Row {
    var row: Row;
    for (var x = 0u; x < ROW; x++) {
        row[x] = texel(block, at + vec2(i32(x), 0));
    }
    return row;
}

fn convolved(corner: vec2<i32>, output: u32) -> Sums {
    var sums = begin(output);
    let first = reads[output].first;
    let count = reads[output].count;
    var weight = output * layer.stride;
    for (var block = first; block < first + count; block++) {
        let at = corner - RADIUS;
        var upper = row_of(block, at);
        for (var y = 0u; y < KERNEL; y++) {
            let lower = row_of(block, at + vec2(0, i32(y) + 1));
            add_row(&sums, upper, lower, weight);
            upper = lower;
            weight += KERNEL;
        }
    }
    return sums;
}
