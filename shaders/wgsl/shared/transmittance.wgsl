// How transmittance to the eye is divided into intervals.

#constant SAMPLES = 16

// What passes so much density times length by the mean extinction of the colours.
fn mean_transmittance(passed: f32) -> f32 {
    return exp(-dot(medium.extinction.rgb, vec3f(1.0 / 3.0)) * passed);
}

// The transmittance down to which a sample is: 1 for the first, the least for the last, evenly between, moved
// by a random part of an interval. (The paper counts from 1 and divides i, not i - 1, by n - 1, so that the
// first would not be at 1.)
fn threshold(sample: u32, least: f32, offset: f32) -> f32 {
    let inner = 1.0 - (f32(sample) - offset) * (1.0 - least) / f32(SAMPLES - 1u);
    return select(select(inner, least, sample == SAMPLES - 1u), 1.0, sample == 0u);
}

// The density times length in front of a sample, of a ray with so much in all.
fn passed_before(sample: u32, whole: f32, offset: f32) -> f32 {
    let extinction = dot(medium.extinction.rgb, vec3f(1.0 / 3.0));
    let least = mean_transmittance(whole);
    return select(-log(threshold(sample, least, offset)) / max(extinction, 1e-30), whole, sample == SAMPLES - 1u);
}
