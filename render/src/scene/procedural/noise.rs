//! Gradient noise (Perlin, "Improving Noise", 2002) and sums of it. Only whole-number arithmetic, products
//! and sums, so the same everywhere.

use glam::{IVec3, Vec3};

/// Smooth noise in about [-1, 1], 0 at whole-numbered points, with features one unit apart.
pub fn gradient(seed: u32, point: Vec3) -> f32 {
    let cell = floor(point);
    let inside = point - cell.as_vec3();
    let weight = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32, z: i32| {
        let corner = IVec3::new(x, y, z);
        slope(hash(seed, cell + corner), inside - corner.as_vec3())
    };
    let along_x = |y, z| mix(corner(0, y, z), corner(1, y, z), weight.x);
    let along_y = |z| mix(along_x(0, z), along_x(1, z), weight.y);
    mix(along_y(0), along_y(1), weight.z)
}

/// Octaves of noise, each twice as fine and half as strong as the one before, in about [-1, 1].
pub fn fbm(seed: u32, point: Vec3, octaves: u32) -> f32 {
    drifting_fbm(seed, point, octaves, 0.0)
}

/// Like [`fbm`], each octave moved by so many of its own features: along x, y, z and against them in turn, so
/// that they change what they make together.
pub fn drifting_fbm(seed: u32, point: Vec3, octaves: u32, drift: f32) -> f32 {
    octave_sum(seed, point, octaves, drift, |value| value)
}

/// Like [`fbm`], but with sharp crests: each octave is 1 - 2 |noise|.
pub fn ridged(seed: u32, point: Vec3, octaves: u32) -> f32 {
    octave_sum(seed, point, octaves, 0.0, |value| 1.0 - 2.0 * value.abs())
}

fn octave_sum(seed: u32, point: Vec3, octaves: u32, drift: f32, shape: impl Fn(f32) -> f32) -> f32 {
    let mut sum = 0.0;
    let (mut strength, mut total) = (1.0, 0.0);
    for octave in 0..octaves {
        // The shift keeps the zeros at whole numbers of the octaves from falling together.
        let at = point * (1 << octave) as f32 + Vec3::splat(0.37 * octave as f32);
        let way = Vec3::AXES[octave as usize % 3] * if octave % 2 == 0 { drift } else { -drift };
        sum += strength * shape(gradient(seed.wrapping_add(octave), at + way));
        total += strength;
        strength *= 0.5;
    }
    sum / total
}

/// A fixed random number in [0, 1) of a cell.
pub fn of_cell(seed: u32, cell: IVec3) -> f32 {
    (hash(seed, cell) >> 8) as f32 / (1 << 24) as f32
}

/// Rounded down, without the call into the C library that `f32::floor` is where SSE 4.1 is not taken for
/// granted.
fn floor(point: Vec3) -> IVec3 {
    let towards_zero = point.as_ivec3();
    let below = point.cmplt(towards_zero.as_vec3());
    towards_zero - IVec3::from(below)
}

fn mix(a: f32, b: f32, weight: f32) -> f32 {
    a + (b - a) * weight
}

/// Product of an offset and one of the twelve directions to the edges of a cube (Perlin 2002).
fn slope(hash: u32, offset: Vec3) -> f32 {
    let Vec3 { x, y, z } = offset;
    let (first, second) = match hash >> 30 {
        0 => (x, y),
        1 => (x, z),
        _ => (y, z),
    };
    let signed = |bit: u32, value: f32| if hash & bit == 0 { value } else { -value };
    signed(1, first) + signed(2, second)
}

/// Hash of a point of the lattice (finaliser of MurmurHash3, Appleby).
fn hash(seed: u32, cell: IVec3) -> u32 {
    let [x, y, z] = cell.to_array().map(|coordinate| coordinate as u32);
    let mut value =
        seed ^ x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
    value = (value ^ (value >> 16)).wrapping_mul(0x85eb_ca6b);
    value = (value ^ (value >> 13)).wrapping_mul(0xc2b2_ae35);
    value ^ (value >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_continuous_and_zero_on_the_lattice() {
        let mut spread = 0f32;
        for step in 0..4000 {
            let point = Vec3::new(0.031, 0.017, 0.023) * step as f32 - Vec3::splat(20.0);
            let value = gradient(7, point);
            assert!(value.abs() <= 1.1);
            assert!((gradient(7, point + Vec3::splat(1e-3)) - value).abs() < 0.02);
            spread = spread.max(value.abs());
        }
        assert!(spread > 0.5);
        assert_eq!(gradient(7, Vec3::new(3.0, -2.0, 5.0)), 0.0);
    }

    #[test]
    fn seeds_give_other_noise() {
        let point = Vec3::new(0.3, 0.6, 0.1);
        assert_ne!(fbm(1, point, 3), fbm(2, point, 3));
        assert_ne!(ridged(1, point, 3), fbm(1, point, 3));
    }
}
