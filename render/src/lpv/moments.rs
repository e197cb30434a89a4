//! Light of one colour in a cell by its moments: energy, flux and, in three spherical harmonic bands, second
//! moments.

use super::lobe::MATTE;
use glam::{Vec3, Vec4, Vec4Swizzles};
use std::ops::{Add, AddAssign, Mul};

/// How many second moments there are.
pub const SECONDS: usize = 5;

/// xx, yy, xy, xz and yz of a symmetric matrix, the mean of `w w^T - 1/3` over the directions of light times
/// its energy; zz is what makes its trace 0.
pub type Second = [f32; SECONDS];

/// Mean of Legendre's second polynomial over light that a matte surface sends.
pub const MATTE_SECOND: f32 = 0.25;

/// What a cell has of light of one colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Flux and, last, energy, or what a lobe keeps in their place.
    pub light: Vec4,
    /// Second moments; 0 but in three bands.
    pub second: Second,
}

impl Moments {
    /// No light.
    pub const NONE: Self = Self { light: Vec4::ZERO, second: [0.0; SECONDS] };

    /// Light of an energy of 1 about a direction, of a mean cosine with it and a mean of Legendre's second
    /// polynomial.
    pub fn about(direction: Vec3, cosine: f32, second: f32) -> Self {
        let Vec3 { x, y, z } = direction;
        let products = [x * x - 1.0 / 3.0, y * y - 1.0 / 3.0, x * y, x * z, y * z];
        Self { light: (direction * cosine).extend(1.0), second: products.map(|product| second * product) }
    }

    /// Light of a flux and, last, an energy, whose second moments are not known: as if a matte surface had
    /// sent all that has a direction.
    pub fn as_of_matte(light: Vec4) -> Self {
        let length = light.xyz().length();
        let directed = (length / light.w.max(1e-30)).min(1.0);
        let second = MATTE_SECOND * (directed / MATTE) * (directed / MATTE) * light.w.max(0.0);
        Self { light, ..Self::about(light.xyz() / length.max(1e-30), 0.0, second) }
    }

    /// `w^T S w` of a direction `w` and the second moments `S`.
    pub fn second_along(&self, direction: Vec3) -> f32 {
        let ([xx, yy, xy, xz, yz], Vec3 { x, y, z }) = (self.second, direction);
        xx * (x * x - z * z) + yy * (y * y - z * z) + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    }
}

impl From<Vec4> for Moments {
    fn from(light: Vec4) -> Self {
        Self { light, ..Self::NONE }
    }
}

impl Add for Moments {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let second = std::array::from_fn(|i| self.second[i] + other.second[i]);
        Self { light: self.light + other.light, second }
    }
}

impl AddAssign for Moments {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f32> for Moments {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        Self { light: self.light * factor, second: self.second.map(|of| of * factor) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpv::lattice::{SHARES, neighbours};

    #[test]
    fn second_moments_are_sums_over_directions() {
        let light =
            |direction: Vec3| 1.0 + direction.x + 3.0 * direction.x * direction.y - direction.z * direction.z;
        let sums = neighbours().fold(Moments::NONE, |sums, n| {
            sums + Moments::about(n.direction, 1.0, 1.0) * (SHARES[n.class] * light(n.direction))
        });
        // The means of x^4 and x^2 y^2 are 1/5 and 1/15.
        let wanted = [2.0 / 45.0, 2.0 / 45.0, 0.2, 0.0, 0.0];
        assert!(sums.second.iter().zip(wanted).all(|(is, wanted)| (is - wanted).abs() < 1e-6), "{sums:?}");
        assert!(
            (sums.light - Vec4::new(1.0 / 3.0, 0.0, 0.0, 2.0 / 3.0)).abs().max_element() < 1e-6,
            "{sums:?}"
        );
        let way = Vec3::new(0.48, -0.6, 0.64);
        let wanted = 2.0 / 45.0 * (way.x * way.x + way.y * way.y - 2.0 * way.z * way.z) + 0.4 * way.x * way.y;
        assert!((sums.second_along(way) - wanted).abs() < 1e-6);
    }

    #[test]
    fn light_of_one_matte_surface_is_known_by_its_flux_and_energy() {
        let normal = Vec3::new(0.6, -0.64, 0.48);
        let sent = Moments::about(normal, MATTE, MATTE_SECOND) * 3.0;
        let known = Moments::as_of_matte(sent.light);
        let off = sent.second.iter().zip(known.second).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-6 && known.light == sent.light, "{known:?} for {sent:?}");
        assert_eq!(Moments::as_of_matte(Vec4::W), Moments::from(Vec4::W));
        for light in [Vec4::new(9.0, 0.0, 0.0, 1e-3), Vec4::new(1.0, 0.0, 0.0, -1.0), Vec4::ZERO] {
            let most = Moments::as_of_matte(light).second.into_iter().map(f32::abs).fold(0.0, f32::max);
            assert!(most <= light.w.max(0.0), "{light}: {most}");
        }
    }
}
