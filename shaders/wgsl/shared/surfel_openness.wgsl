// What is not occluded is open.
fn meaning(sum: f32) -> f32 {
    return clamp(1.0 - sum, 0.0, 1.0);
}
