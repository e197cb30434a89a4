//! A division of a length whose parts grow linearly: `shared/growing.wgsl` in Rust.

/// How large the first part is, as a share of what they are on average.
const FIRST_PART: f32 = 0.1;

/// Which share of the length is passed after a share of the parts.
pub fn growing(share: f32) -> f32 {
    share * (FIRST_PART + (1.0 - FIRST_PART) * share)
}

/// How fast it grows there.
pub fn growth_at(share: f32) -> f32 {
    FIRST_PART + 2.0 * (1.0 - FIRST_PART) * share
}

/// The share of the parts after which a share of the length is passed.
pub fn share_of_parts(passed: f32) -> f32 {
    let root = (FIRST_PART * FIRST_PART + 4.0 * (1.0 - FIRST_PART) * passed).sqrt();
    2.0 * passed / (FIRST_PART + root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_found_again_and_grow_as_said() {
        for i in 0..1000 {
            let share = i as f32 / 1000.0;
            assert!((share_of_parts(growing(share)) - share).abs() < 1e-5, "{share}");
            let slope = (growing(share + 1e-3) - growing(share)) * 1e3;
            assert!((slope - growth_at(share + 5e-4)).abs() < 2e-3, "{share}: {slope}");
        }
        assert_eq!([growing(0.0), growing(1.0)], [0.0, 1.0]);
    }
}
