// Samples of a ray as 16-bit shares of its way through the medium.

#constant SAMPLES = 16

var<private> packed: array<u32, SAMPLES / 2u>;

// Keeps a sample that lies at a part of a step.
fn keep(sample: u32, step: u32, part: f32, march: March) {
    let share = (f32(step) + part) / f32(march.steps);
    packed[sample / 2u] |= u32(share * 65535.0 + 0.5) << (16u * (sample % 2u));
}

fn kept() -> array<u32, SAMPLES / 2u> {
    return packed;
}
