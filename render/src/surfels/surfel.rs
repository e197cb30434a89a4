//! A surfel in 16 bytes, since a frame may have a million of them: the same in Rust as
//! `shared/surfel_record.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A disk in camera space.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Surfel {
    /// Where its middle is, metres.
    pub place: [f32; 3],
    /// From the lowest bit on: its unit normal, octahedral, ten bits and ten; 1 where the surface is open;
    /// the bits of its radius.
    disk: u32,
}

/// Radii have five bits of exponent and six of mantissa, those of an f32 from 2^-20 to 2^12 m: between them
/// is what a camera sees of a coin and of a landscape of hundreds of kilometres; less is 0.
const LEAST_RADIUS: u32 = 107 << 23;
const MOST_RADIUS_BITS: u32 = 2047;
const RADIUS_AT: u32 = 21;
const OPEN: u32 = 1 << 20;
const LARGEST_COORDINATE: f32 = 511.0;

impl Surfel {
    /// One at a place with a unit normal. Of the two nearest radii that it may have it gets one, so that over
    /// all thresholds from 0 to 1 the mean area is right.
    pub fn new(place: Vec3, normal: Vec3, open: bool, radius: f32, threshold: f32) -> Self {
        let open = if open { OPEN } else { 0 };
        let radius = bits_of_radius(radius, threshold) << RADIUS_AT;
        Self { place: place.to_array(), disk: octahedral(normal) | open | radius }
    }

    /// Metres.
    pub fn radius(&self) -> f32 {
        radius_of_bits(self.disk >> RADIUS_AT)
    }

    /// Unit vector (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit
    /// Vectors").
    pub fn normal(&self) -> Vec3 {
        let coordinate = |shift: u32| ((self.disk << shift) as i32 >> 22) as f32 / LARGEST_COORDINATE;
        let [x, y] = [coordinate(22), coordinate(12)];
        let z = 1.0 - x.abs() - y.abs();
        if z < 0.0 { Vec3::new(folded(y, x), folded(x, y), z) } else { Vec3::new(x, y, z) }.normalize()
    }

    /// Whether its back is seen too, since its surface is no closed one.
    pub const fn is_open(&self) -> bool {
        self.disk & OPEN != 0
    }
}

/// What a coordinate of the octahedron's lower half is, by the other one and its own sign.
fn folded(other: f32, own: f32) -> f32 {
    (1.0 - other.abs()) * if own < 0.0 { -1.0 } else { 1.0 }
}

fn octahedral(normal: Vec3) -> u32 {
    let Vec3 { x, y, z } = normal / normal.abs().element_sum();
    let [x, y] = if z < 0.0 { [folded(y, x), folded(x, y)] } else { [x, y] };
    let [x, y] = [x, y].map(|at| (at * LARGEST_COORDINATE + 0.5).floor() as i32 as u32 & 1023);
    x | y << 10
}

fn radius_of_bits(bits: u32) -> f32 {
    if bits == 0 { 0.0 } else { f32::from_bits(LEAST_RADIUS + (bits << 17)) }
}

fn bits_of_radius(radius: f32, threshold: f32) -> u32 {
    let below = ((radius.to_bits().max(LEAST_RADIUS) - LEAST_RADIUS) >> 17).min(MOST_RADIUS_BITS - 1);
    let [low, high] = [below, below + 1].map(|bits| radius_of_bits(bits) * radius_of_bits(bits));
    below + u32::from(radius * radius - low > threshold * (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(normal: Vec3, open: bool, radius: f32, threshold: f32) -> Surfel {
        Surfel::new(Vec3::ZERO, normal, open, radius, threshold)
    }

    #[test]
    fn radii_are_near_and_their_areas_right_in_the_mean() {
        let steps = 1000u16;
        for radius in [1.0001 / 1024.0, 0.003_7, 0.02, 1.0, 1.234, 77.7] {
            let all = (0..steps).map(|i| (f32::from(i) + 0.5) / f32::from(steps));
            let radii: Vec<f32> =
                all.map(|threshold| of(Vec3::Z, false, radius, threshold).radius()).collect();
            assert!(
                radii.iter().all(|found| (found / radius - 1.0).abs() < 1.0 / 64.0),
                "{radius}: {radii:?}"
            );
            let area = radii.iter().map(|radius| radius * radius).sum::<f32>() / f32::from(steps);
            assert!((area / (radius * radius) - 1.0).abs() < 1e-4, "{radius}: {area}");
        }
    }

    #[test]
    fn radii_beyond_the_range_are_its_ends() {
        let least = f32::exp2(-20.0) * 65.0 / 64.0;
        for (radius, of_low, of_high) in
            [(0.0, 0.0, 0.0), (5e-7, least, 0.0), (1e9, 4064.0, 4064.0), (f32::INFINITY, 4064.0, 4064.0)]
        {
            let radius_at = |threshold| of(Vec3::Z, true, radius, threshold).radius();
            assert_eq!([radius_at(0.0), radius_at(0.999)], [of_low, of_high], "{radius}");
        }
    }

    #[test]
    fn normals_and_open_surfaces_are_kept() {
        let mut farthest = 0.0f32;
        for i in 0..40_000u16 {
            // A spiral over the sphere.
            let z = 1.0 - (2.0 * f32::from(i) + 1.0) / 40_000.0;
            let (sin, cos) = (2.4 * f32::from(i)).sin_cos();
            let normal = Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
            let found = of(normal, i % 2 == 0, 1.0, 0.5);
            farthest = farthest.max(found.normal().angle_between(normal));
            assert_eq!((found.is_open(), found.radius()), (i % 2 == 0, 1.0));
        }
        assert!(farthest < 0.0042, "{farthest} rad");
        for normal in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert_eq!(of(normal, false, 1.0, 0.5).normal(), normal);
        }
    }
}
