//! Visibility prefiltering (Baran et al. 2010, section 7): between a light ray and the next, light ends at
//! several depths, which are gathered into modes.

/// Samples of a light ray's depth.
pub const SAMPLES: usize = 4;

/// Where a part of a light ray's light ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// The mean of its samples.
    pub depth: f32,
    /// Its share of all samples.
    pub weight: f32,
}

/// The modes of some depths: those that follow each other by less than `apart` are one.
#[inline(always)]
pub fn modes(mut depths: [f32; SAMPLES], apart: f32, mut found: impl FnMut(Mode)) {
    // A sorting network.
    for [i, j] in [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]] {
        if depths[i] > depths[j] {
            depths.swap(i, j);
        }
    }
    let (mut sum, mut count) = (depths[0], 1.0);
    for i in 1..SAMPLES {
        if depths[i] - depths[i - 1] > apart {
            found(Mode { depth: sum / count, weight: count / SAMPLES as f32 });
            (sum, count) = (0.0, 0.0);
        }
        sum += depths[i];
        count += 1.0;
    }
    found(Mode { depth: sum / count, weight: count / SAMPLES as f32 });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(depths: [f32; 4]) -> Vec<[f32; 2]> {
        let mut all = Vec::new();
        modes(depths, 0.5, |mode| all.push([mode.depth, mode.weight]));
        all
    }

    #[test]
    fn near_depths_are_one_mode() {
        assert_eq!(of([1.0, 1.25, 1.5, 1.25]), [[1.25, 1.0]]);
        assert_eq!(of([9.0, 1.0, 9.25, 1.5]), [[1.25, 0.5], [9.125, 0.5]]);
        assert_eq!(of([4.0, 1.0, 3.0, 2.0]), [[1.0, 0.25], [2.0, 0.25], [3.0, 0.25], [4.0, 0.25]]);
        assert_eq!(of([7.0, 1.0, 1.0, 1.0]), [[1.0, 0.75], [7.0, 0.25]]);
    }
}
