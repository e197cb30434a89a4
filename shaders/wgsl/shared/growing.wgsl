// A division of a length whose parts grow linearly.

// How large the first part is, as a share of what they are on average.
const FIRST_PART = 0.1;

// Which share of the length is passed after a share of the parts.
fn growing(share: f32) -> f32 {
    return share * (FIRST_PART + (1.0 - FIRST_PART) * share);
}

// How fast it grows there.
fn growth_at(share: f32) -> f32 {
    return FIRST_PART + 2.0 * (1.0 - FIRST_PART) * share;
}

// The share of the parts after which a share of the length is passed: the quadratic formula without a
// difference of almost equal numbers.
fn share_of_parts(passed: f32) -> f32 {
    let root = sqrt(FIRST_PART * FIRST_PART + 4.0 * (1.0 - FIRST_PART) * passed);
    return 2.0 * passed / (FIRST_PART + root);
}
