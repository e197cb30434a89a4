//! How light in a cell is spread over directions, by its energy and its flux: as the square of a function of two
//! spherical harmonic bands, `(p + v . w)^2`. It is nowhere negative, however directed the light, has any mean
//! direction up to a length of `1 / sqrt(3)`, the most that a positive function of three bands may have, and needs as
//! many numbers as two bands do. What is directed more is spread until it has that length; its energy stays.

use glam::{Vec3, Vec4, Vec4Swizzles};

const ROOT: f32 = 1.732_050_8;

/// `v` and, last, `p`, from flux and, last, energy.
pub fn lobe(moments: Vec4) -> Vec4 {
    let (flux, energy) = (moments.xyz(), moments.w.max(0.0));
    let length = flux.length();
    let directed = (ROOT * length).min(energy);
    let p = 0.5 * ((energy + directed).sqrt() + (energy - directed).sqrt());
    // p v = 3/2 flux; where there is no energy both are 0.
    let kept = directed / (ROOT * length).max(1e-30);
    (flux * (1.5 * kept / p.max(1e-30))).extend(p)
}

/// Energy of a lobe.
pub fn energy(lobe: Vec4) -> f32 {
    lobe.w * lobe.w + lobe.xyz().length_squared() / 3.0
}

/// Flux of a lobe.
pub fn flux(lobe: Vec4) -> Vec3 {
    lobe.xyz() * (lobe.w * (2.0 / 3.0))
}

/// Energy along a direction, over its share of all directions.
pub fn towards(lobe: Vec4, direction: Vec3) -> f32 {
    let root = lobe.w + lobe.xyz().dot(direction);
    root * root
}

/// Irradiance of a lobe on the front of a surface: with the cosine the means of 1, `w` and `w w^T` over the sphere are
/// 1/4, `-n / 6` and `(1 + n n^T) / 16`.
pub fn irradiance(lobe: Vec4, normal: Vec3) -> f32 {
    let (v, along) = (lobe.xyz(), lobe.xyz().dot(normal));
    0.25 * lobe.w * lobe.w - lobe.w * along / 3.0 + (v.length_squared() + along * along) / 16.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpv::lattice::{SHARES, neighbours};

    #[test]
    fn energy_and_flux_are_kept_and_are_what_neighbours_get() {
        let direction = Vec3::new(0.2, -0.7, 0.4).normalize();
        for directed in [0.0, 1e-4, 0.2, 0.5, 0.577] {
            let moments = (3.0 * directed * direction).extend(3.0);
            let lobe = lobe(moments);
            assert!((energy(lobe) - 3.0).abs() < 1e-5 && (flux(lobe) - moments.xyz()).length() < 1e-5);
            let sent = |n: crate::lpv::lattice::Neighbour| SHARES[n.class] * towards(lobe, n.direction);
            let all: f32 = neighbours().map(sent).sum();
            let way: Vec3 = neighbours().map(|n| n.direction * sent(n)).sum();
            assert!((all - 3.0).abs() < 1e-5 && (way - moments.xyz()).length() < 1e-5, "{all} {way}");
        }
    }

    #[test]
    fn irradiance_is_the_integral_over_the_hemisphere() {
        let (lobe, normal) = (Vec4::new(0.7, -0.2, 0.5, 0.8), Vec3::new(0.6, 0.0, 0.8));
        let (rings, segments) = (400u16, 400u16);
        let mut sum = 0.0;
        for i in 0..u32::from(rings) * u32::from(segments) {
            let z = 1.0 - 2.0 * ((i / u32::from(segments)) as f32 + 0.5) / f32::from(rings);
            let (sin, cos) =
                (std::f32::consts::TAU * (i % u32::from(segments)) as f32 / f32::from(segments)).sin_cos();
            let direction = Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
            sum += f64::from(towards(lobe, direction) * (-direction.dot(normal)).max(0.0));
        }
        let mean = sum / f64::from(u32::from(rings) * u32::from(segments));
        assert!((mean / f64::from(irradiance(lobe, normal)) - 1.0).abs() < 1e-3, "{mean}");
    }

    #[test]
    fn what_is_directed_too_much_keeps_its_energy_and_direction() {
        for moments in [Vec4::new(0.0, 2.0, 0.0, 2.0), Vec4::new(9.0, 0.0, 0.0, 2.0)] {
            let lobe = lobe(moments);
            assert!((energy(lobe) - 2.0).abs() < 1e-5);
            assert!((flux(lobe) - moments.xyz().normalize() * 2.0 / ROOT).length() < 1e-5);
        }
        assert_eq!(lobe(Vec4::ZERO), Vec4::ZERO);
        assert_eq!(lobe(Vec4::new(0.0, 0.0, 0.0, -1.0)), Vec4::ZERO);
    }
}
