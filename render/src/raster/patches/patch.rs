//! A part of a triangle, in 24 bytes, since a scene has millions: which part of which triangle, and what its
//! material says of it.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A part of a triangle, as `shared/surfel_patch_record.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Patch {
    /// Vertices of the triangle, among those of all meshes on the GPU.
    pub corners: [u32; 3],
    /// Halvings in the upper four bits; [`OPEN`]; nine bits of coverage; in the lower eighteen, two a
    /// halving: which quarter.
    part: u32,
    /// Diffuse reflectance: eleven, eleven and ten bits of the root of red, green and blue.
    colour: u32,
    /// The mesh that it is part of, as [`Attribute::ObjectId`](deepshade_shaders::Attribute::ObjectId) counts
    /// them.
    pub object: u32,
}

/// Edges are halved no more often.
pub const MOST_HALVINGS: u32 = 9;
/// The bit of a part that is set where the surface is no closed one.
const OPEN: u32 = 1 << 27;
/// Bits that say which quarters a part is of.
const QUARTER_BITS: u32 = 2 * MOST_HALVINGS;
/// The number that stands for a whole part.
const MOST_COVERED: u32 = 511;

impl Patch {
    /// One that is nowhere.
    pub const NOWHERE: Self = Self { corners: [0; 3], part: 0, colour: 0, object: 0 };

    /// A part of a triangle of a mesh, of which nothing is there until it is [`painted`](Self::painted), and
    /// whose edges are halved so many times: two bits of `quarters` a halving say which quarter.
    pub const fn new(corners: [u32; 3], object: u32, halvings: u32, quarters: u32) -> Self {
        Self { corners, part: halvings << 28 | quarters, colour: 0, object }
    }

    /// It as part of no closed surface, so that its back is seen too.
    #[must_use]
    pub const fn opened(self) -> Self {
        Self { part: self.part | OPEN, ..self }
    }

    /// It with what a material says of it: reflectance and coverage, from 0 to 1.
    #[must_use]
    pub fn painted(self, colour: Vec3, coverage: f32) -> Self {
        let bits = |value: f32, largest: u32| (value.clamp(0.0, 1.0) * largest as f32 + 0.5) as u32;
        let [red, green, blue] = colour.to_array().map(f32::sqrt);
        Self {
            part: self.part | bits(coverage, MOST_COVERED) << QUARTER_BITS,
            colour: bits(red, 2047) | bits(green, 2047) << 11 | bits(blue, 1023) << 22,
            ..self
        }
    }

    /// Share of the part that is there: alpha, from 0 to 1.
    pub fn coverage(&self) -> f32 {
        (self.part >> QUARTER_BITS & MOST_COVERED) as f32 / MOST_COVERED as f32
    }

    /// Diffuse reflectance, linear, the mean over the part.
    pub fn colour(&self) -> Vec3 {
        let part =
            |shift: u32, largest: u32| ((self.colour >> shift & largest) as f32 / largest as f32).powi(2);
        Vec3::new(part(0, 2047), part(11, 2047), part(22, 1023))
    }

    /// Whether its back is seen too, since its surface is no closed one.
    pub const fn is_open(&self) -> bool {
        self.part & OPEN != 0
    }

    /// How often the triangle's edges were halved.
    pub const fn halvings(&self) -> u32 {
        self.part >> 28
    }

    /// How its corners are mixed of the triangle's.
    pub fn weights(&self) -> [Vec3; 3] {
        let mut corners = [Vec3::X, Vec3::Y, Vec3::Z];
        for halving in (0..self.halvings()).rev() {
            let [a, b, c] = corners;
            let middles = [0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)];
            corners = match self.part >> (2 * halving) & 3 {
                0 => [a, middles[2], middles[1]],
                1 => [middles[2], b, middles[0]],
                2 => [middles[1], middles[0], c],
                _ => middles,
            };
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The point of a triangle with these weights of its corners.
    fn mixed(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
        corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
    }

    fn area([a, b, c]: [Vec3; 3]) -> f32 {
        0.5 * (b - a).cross(c - a).length()
    }

    #[test]
    fn quarters_tile_a_triangle() {
        let triangle = [Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0), Vec3::new(0.5, 2.0, 1.0)];
        let laid =
            |part: u32| Patch { part, ..Patch::NOWHERE }.weights().map(|corner| mixed(triangle, corner));
        for halvings in 0..5u32 {
            let parts: Vec<_> =
                (0..1 << (2 * halvings)).map(|quarters| laid(halvings << 28 | quarters)).collect();
            let wanted = area(triangle) / parts.len() as f32;
            assert!(parts.iter().all(|part| (area(*part) - wanted).abs() < 1e-5 * wanted));
            let normal = |part: [Vec3; 3]| (part[1] - part[0]).cross(part[2] - part[0]).normalize();
            assert!(parts.iter().all(|part| normal(*part).dot(normal(triangle)) > 0.999), "turned over");
            let mean =
                parts.iter().map(|part| part.iter().sum::<Vec3>() / 3.0).sum::<Vec3>() / parts.len() as f32;
            assert!(mean.distance(triangle.iter().sum::<Vec3>() / 3.0) < 1e-5);
        }
    }

    #[test]
    fn colour_and_coverage_are_kept() {
        let part = Patch { part: 9 << 28 | 0x2_71c9, ..Patch::NOWHERE };
        for (colour, coverage) in
            [(Vec3::ZERO, 0.0), (Vec3::ONE, 1.0), (Vec3::new(0.8, 0.02, 0.3), 0.25), (Vec3::splat(0.5), 0.7)]
        {
            let painted = part.painted(colour, coverage);
            assert!((painted.colour() - colour).abs().max_element() < 1e-3, "{colour}");
            assert!((painted.coverage() - coverage).abs() < 1e-3, "{coverage}");
            assert_eq!((painted.halvings(), painted.weights()), (9, part.weights()));
        }
    }
}
