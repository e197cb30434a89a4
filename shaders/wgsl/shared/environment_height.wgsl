// Rows of a map that is alone in `environment`: it has twice as many columns.
fn environment_height() -> u32 {
    return u32(round(sqrt(0.5 * f32(arrayLength(&environment)))));
}
