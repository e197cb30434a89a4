// Samples of a ray as the paper keeps them: 8 bits each for the steps since the one before, and as many for
// density there over the ray's largest, which takes the place of the first sample's, over the medium's.

#constant SAMPLES = 16

var<private> packed: array<u32, SAMPLES / 2u>;
var<private> found: array<f32, SAMPLES>;
// Steps in front of the sample before, as whoever adds them up finds it.
var<private> counted: u32;

// Keeps a sample: the first lies before a step, the others at its end.
fn keep(sample: u32, step: u32, part: f32, march: March) {
    let passed = min(step + min(sample, 1u) - counted, 255u);
    counted += passed;
    packed[sample / 4u] |= passed << (8u * (sample % 4u));
    found[sample] = density_at(max(counted, 1u) - 1u, march);
}

fn kept() -> array<u32, SAMPLES / 2u> {
    var most = 0.0;
    for (var i = 1u; i < SAMPLES; i++) {
        most = max(most, found[i]);
    }
    // Rounded up, so that no density is above it.
    let largest = ceil(255.0 * most / max(medium.low.w, 1e-30));
    let unit = largest * medium.low.w / 255.0;
    packed[SAMPLES / 4u] |= min(u32(largest), 255u);
    for (var i = 1u; i < SAMPLES; i++) {
        let share = u32(255.0 * found[i] / max(unit, 1e-30) + 0.5);
        packed[(SAMPLES + i) / 4u] |= min(share, 255u) << (8u * (i % 4u));
    }
    return packed;
}
