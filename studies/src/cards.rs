//! What the papers' graphics cards can do at best, by their maker's data sheets: a time on one of them and a
//! time here are compared by what each device could have done meanwhile.

use deepshade_shaders::gpu::Ceilings;

/// NVIDIA's GeForce GTX 480 (2010): 177.4 GB/s; 480 lanes at 1.401 GHz.
pub const GTX_480: Ceilings = Ceilings { copy: 177.4e9, multiply_add: 2.0 * 480.0 * 1.401e9 };
/// NVIDIA's GeForce GTX 770 (2013): 224.3 GB/s; 1536 lanes at 1.046 GHz.
pub const GTX_770: Ceilings = Ceilings { copy: 224.3e9, multiply_add: 2.0 * 1536.0 * 1.046e9 };

/// A time on a device.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Milliseconds.
    pub milliseconds: f64,
    /// What the device can do at best.
    pub at_best: Ceilings,
}

impl Timed {
    /// So many bytes, read and written, over those that the device could have copied meanwhile.
    pub fn share_of_copy(self, bytes: f64) -> f64 {
        bytes / (1e-3 * self.milliseconds * self.at_best.copy)
    }

    /// What the device could have done meanwhile over what another could have in its time: bytes copied, and
    /// multiplications with additions. Below 1 this one's work is the better use of a device.
    pub fn over(self, other: Self) -> [f64; 2] {
        let done = |of: fn(Ceilings) -> f64| {
            self.milliseconds * of(self.at_best) / (other.milliseconds * of(other.at_best))
        };
        [done(|best| best.copy), done(|best| best.multiply_add)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_is_twice_as_fast_and_takes_half_as_long_does_as_much() {
        let paper = Timed { milliseconds: 20.0, at_best: GTX_770 };
        let at_best = Ceilings { copy: 2.0 * GTX_770.copy, multiply_add: 8.0 * GTX_770.multiply_add };
        let here = Timed { milliseconds: 10.0, at_best };
        let [copied, multiplied] = here.over(paper);
        assert!((copied - 1.0).abs() < 1e-12 && (multiplied - 4.0).abs() < 1e-12, "{copied} {multiplied}");
        // 224.3 GB in a second.
        assert!((paper.share_of_copy(0.5 * 4.486e9) - 0.5).abs() < 1e-12);
        assert!(
            (GTX_480.multiply_add - 1.345e12).abs() < 1e9 && (GTX_770.multiply_add - 3.213e12).abs() < 1e9
        );
    }
}
