// Sums of colours.

#constant CHANNELS = 3

fn nothing() -> vec3f {
    return vec3f(0.0);
}

fn write_sum(sum: vec3f, at: u32, pixels: u32) {
    for (var c = 0u; c < CHANNELS; c++) {
        sums[at + c * pixels] = sum[c];
    }
}
