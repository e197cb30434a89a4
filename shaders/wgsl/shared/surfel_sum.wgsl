// The sum is what is wanted.
fn meaning(sum: f32) -> f32 {
    return sum;
}
