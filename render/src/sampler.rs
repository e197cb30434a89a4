//! Counter-based random numbers: a value is a function of pixel, sample, dimension and seed, so that images
//! do not depend on threads or order. Within a pixel, samples are an Owen-scrambled Sobol sequence (Burley
//! 2020).

use glam::{Mat3, Vec2, Vec3};
use sobol_burley::NUM_DIMENSION_SETS_4D;

/// The most samples of a pixel; the length of the Sobol sequence.
pub const MAX_SAMPLES: u32 = 1 << 16;

/// A well mixed 32-bit hash (Wellons' lowbias32).
pub const fn hash(mut value: u32) -> u32 {
    value ^= value >> 16;
    value = value.wrapping_mul(0x7feb_352d);
    value ^= value >> 15;
    value = value.wrapping_mul(0x846c_a68b);
    value ^ (value >> 16)
}

/// The samples of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    seed: u32,
    /// Where in the sequence sample 0 is.
    first: u32,
}

impl PixelSampler {
    /// The sequence of pixel (`x`, `y`); sequences of different pixels and seeds are independent scramblings.
    pub const fn new(x: usize, y: usize, seed: u32) -> Self {
        Self { seed: hash(x as u32 ^ hash(y as u32 ^ hash(seed))), first: 0 }
    }

    /// The same pixel's sequence under another scrambling; scrambling 0 is this one.
    #[must_use]
    pub const fn scrambled(self, scrambling: u32) -> Self {
        if scrambling == 0 { self } else { Self { seed: hash(self.seed ^ hash(scrambling)), ..self } }
    }

    /// The same sequence from its sample `first` on, for more samples after others.
    #[must_use]
    pub const fn starting_at(self, first: u32) -> Self {
        Self { first, ..self }
    }

    /// Dimensions `4 * set` to `4 * set + 3` of a sample, each in [0, 1).
    pub fn sample_4d(&self, sample: u32, set: u32) -> [f32; 4] {
        sobol_burley::sample_4d(self.first + sample, set, self.seed)
    }
}

/// The random numbers of one sample of a pixel, one after the other. The first 256 are dimensions of the
/// pixel's Sobol sequence, those after them independent hashes, since what happens so late on a path hardly
/// varies together.
#[derive(Clone, Debug)]
pub struct Stream {
    pixel: PixelSampler,
    sample: u32,
    /// How many numbers were taken.
    taken: u32,
    /// The set of four dimensions that the last number was from.
    set: [f32; 4],
}

impl Stream {
    /// The numbers of a sample, from the first on.
    pub const fn new(pixel: PixelSampler, sample: u32) -> Self {
        Self { pixel, sample, taken: 0, set: [0.0; 4] }
    }

    /// The next number, in [0, 1).
    pub fn next_1d(&mut self) -> f32 {
        let (set, within) = (self.taken / 4, self.taken % 4);
        self.taken += 1;
        if set >= NUM_DIMENSION_SETS_4D {
            let mixed = hash(self.pixel.seed ^ hash((self.pixel.first + self.sample) ^ hash(self.taken)));
            return (mixed >> 8) as f32 / 16_777_216.0;
        }
        if within == 0 {
            self.set = self.pixel.sample_4d(self.sample, set);
        }
        self.set[within as usize]
    }

    /// The next two numbers, stratified together: never of two different sets of four dimensions.
    pub fn next_2d(&mut self) -> Vec2 {
        self.taken += self.taken % 2;
        // A number passed over starts a set that was not read.
        if self.taken % 4 == 2 && self.taken / 4 < NUM_DIMENSION_SETS_4D {
            self.set = self.pixel.sample_4d(self.sample, self.taken / 4);
        }
        Vec2::new(self.next_1d(), self.next_1d())
    }
}

/// A direction of the upper hemisphere (z up) with density cosine / pi, by Malley's method over a concentric
/// disk.
pub fn cosine_hemisphere(u: f32, v: f32) -> Vec3 {
    let (radius, angle) = concentric(u, v);
    let (sin, cos) = angle.sin_cos();
    Vec3::new(radius * cos, radius * sin, (1.0 - radius * radius).max(0.0).sqrt())
}

/// A point of the unit disk with uniform density, by the concentric map.
pub fn concentric_disk(u: f32, v: f32) -> Vec2 {
    let (radius, angle) = concentric(u, v);
    Vec2::from_angle(angle) * radius
}

/// Signed radius and angle of a point of the unit disk (Shirley and Chiu 1997).
fn concentric(u: f32, v: f32) -> (f32, f32) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let quarter = std::f32::consts::FRAC_PI_4;
    if a.abs() > b.abs() { (a, quarter * (b / a)) } else { (b, 2.0 * quarter - quarter * (a / b)) }
}

/// Columns: two tangents and the unit `normal` (Duff et al. 2017).
pub fn frame(normal: Vec3) -> Mat3 {
    let (x, y) = normal.any_orthonormal_pair();
    Mat3::from_cols(x, y, normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_hemisphere_has_the_moments_of_its_density() {
        let count = 4096;
        let sampler = PixelSampler::new(3, 5, 7);
        let directions = (0..count).map(|i| {
            let [u, v, ..] = sampler.sample_4d(i, 0);
            cosine_hemisphere(u, v)
        });
        let (mut z, mut zz, mut x, mut xx) = (0.0, 0.0, 0.0, 0.0);
        for d in directions {
            assert!((d.length() - 1.0).abs() < 1e-4 && d.z >= 0.0);
            (z, zz, x, xx) = (z + d.z, zz + d.z * d.z, x + d.x, xx + d.x * d.x);
        }
        let n = count as f32;
        // E z = 2/3, E z^2 = 1/2, E x = 0, E x^2 = 1/4.
        for (mean, expected) in [(z / n, 2.0 / 3.0), (zz / n, 0.5), (x / n, 0.0), (xx / n, 0.25)] {
            assert!((mean - expected).abs() < 2e-3, "{mean} is not {expected}");
        }
    }

    #[test]
    fn pixels_and_seeds_have_sequences_of_their_own() {
        let first = |x, y, seed| PixelSampler::new(x, y, seed).sample_4d(0, 0);
        assert_ne!(first(1, 2, 0), first(2, 1, 0));
        assert_ne!(first(1, 2, 0), first(1, 2, 1));
        assert_eq!(first(1, 2, 0), first(1, 2, 0));
    }

    #[test]
    fn a_sequence_goes_on_where_it_was_left() {
        let sequence = PixelSampler::new(1, 2, 3).scrambled(4);
        let numbers = |sampler, sample| {
            let mut stream = Stream::new(sampler, sample);
            (0..1100).map(|_| stream.next_1d()).collect::<Vec<f32>>()
        };
        assert_eq!(numbers(sequence, 13), numbers(sequence.starting_at(8), 5));
        assert_ne!(numbers(sequence, 5), numbers(sequence.starting_at(8), 5));
    }

    #[test]
    fn a_frame_is_a_rotation_to_the_normal() {
        for normal in [Vec3::Z, Vec3::NEG_Z, Vec3::new(0.36, -0.48, 0.8)] {
            let frame = frame(normal);
            assert!((frame * Vec3::Z - normal).length() < 1e-6);
            assert!((frame.determinant() - 1.0).abs() < 1e-5);
        }
    }
}
