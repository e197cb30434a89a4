//! How light in a cell is spread over directions, by its energy and its flux: as the square of what is above
//! 0 of a function of two spherical harmonic bands, `max(0, p + v . w)^2`. It is nowhere negative, however
//! directed the light, and needs as many numbers as two bands do. Its mean direction may be 3/4 long,
//! somewhat more than that of light from a matte surface; what is directed more is spread until it is. Sums
//! over the 26 neighbours of a cell give its energy, to which it is scaled; its flux they give exactly up to
//! half of the energy, as long as the function is nowhere below 0, and to 4 % beyond.

use super::lattice::{CLASSES, COUNTS, Neighbour, SHARES, neighbours};
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Length of the mean direction at which a lobe ends at a right angle.
const MOST_DIRECTED: f32 = 0.75;

/// Mean cosine of light that a matte surface sends.
pub const MATTE: f32 = 2.0 / 3.0;

/// How light is spread over directions.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Lobes {
    /// As above.
    #[default]
    Squared,
    /// Two bands by themselves, which may be negative, as in Billeter et al. 2012: what goes to a neighbour
    /// is their product with a transfer function, of a cone as wide as the neighbour's share of all
    /// directions in two bands, and is spread there as that function is. The shares add up to 1, so that
    /// energy is kept.
    TwoBands,
}

impl Lobes {
    /// What is kept of light of a flux and, last, an energy.
    pub(crate) fn begins(self, light: Vec4) -> Vec4 {
        match self {
            Self::Squared => lobe(light),
            Self::TwoBands => light,
        }
    }

    /// Flux and, last, energy of what is kept.
    pub(crate) fn light(self, kept: Vec4) -> Vec4 {
        match self {
            Self::Squared => moments(kept),
            Self::TwoBands => kept,
        }
    }

    /// Energy towards all neighbours of each kind together, in the sum over which the second band is
    /// nothing.
    pub(crate) fn by_class(self, kept: Vec4) -> [f32; CLASSES] {
        if self == Self::TwoBands {
            return std::array::from_fn(|class| COUNTS[class] * SHARES[class] * kept.w);
        }
        let mut sums = [0.0; CLASSES];
        if kept != Vec4::ZERO {
            neighbours().for_each(|n| sums[n.class] += SHARES[n.class] * self.towards(kept, &n));
        }
        sums
    }

    /// Energy towards a neighbour, over its share of all directions.
    pub(crate) fn towards(self, kept: Vec4, neighbour: &Neighbour) -> f32 {
        let way = neighbour.direction;
        match self {
            Self::Squared => towards(kept, way),
            Self::TwoBands => kept.w + 3.0 * self.kept_direction(neighbour.class) * kept.xyz().dot(way),
        }
    }

    /// Flux and, last, energy of light of an energy of 1 that has gone to a neighbour.
    pub(crate) fn gone(self, neighbour: &Neighbour) -> Vec4 {
        (neighbour.direction * self.kept_direction(neighbour.class)).extend(1.0)
    }

    /// Mean cosine, with the way to a neighbour, of light that has gone there; of bands it fills a cone that
    /// is so large a share of all directions.
    fn kept_direction(self, class: usize) -> f32 {
        match self {
            Self::Squared => 1.0,
            Self::TwoBands => 1.0 - SHARES[class],
        }
    }
}

/// `v` and, last, `p`, from flux and, last, energy.
pub fn lobe(moments: Vec4) -> Vec4 {
    let (flux, energy) = (moments.xyz(), moments.w);
    // Most cells of many volumes are dark.
    if energy <= 0.0 {
        return Vec4::ZERO;
    }
    let length = flux.length();
    let directed = (length / energy.max(1e-30)).min(MOST_DIRECTED);
    // Of such light of all directions, not of 26 alone, they follow from the integrals of (p + v x)^2 and x
    // (p + v x)^2.
    let (p, v) = if directed < 0.5 {
        (1.0 + (1.0 - 3.0 * directed * directed).sqrt(), 3.0 * directed)
    } else {
        (3.0 - 4.0 * directed, 1.0)
    };
    let shape = (flux * (v / length.max(1e-30))).extend(p);
    shape * (energy / self::moments(shape).w).sqrt()
}

/// Flux and, last, energy of a lobe.
pub fn moments(lobe: Vec4) -> Vec4 {
    if lobe == Vec4::ZERO {
        return Vec4::ZERO;
    }
    let sent = |n: Neighbour| n.direction.extend(1.0) * (SHARES[n.class] * towards(lobe, n.direction));
    neighbours().map(sent).sum()
}

/// Energy along a direction, over its share of all directions.
pub fn towards(lobe: Vec4, direction: Vec3) -> f32 {
    let root = (lobe.w + lobe.xyz().dot(direction)).max(0.0);
    root * root
}

/// Irradiance of light of a flux and, last, an energy on the front of a surface: of a lobe of these the bands
/// of the clamped cosine up to the second. The next that it has is the fourth, of which a lobe has none or
/// little.
pub fn irradiance(light: Vec4, normal: Vec3) -> f32 {
    let (flux, energy) = (light.xyz(), light.w.max(1e-30));
    let length = flux.length();
    let directed = (length / energy).min(1.0);
    let (root, rest) = ((1.0 - 3.0 * directed * directed).max(0.0).sqrt(), 4.0 * (1.0 - directed));
    // The mean of (3 x^2 - 1) / 2.
    let second = if directed < 0.5 {
        0.6 * directed * directed / (1.0 + root)
    } else {
        1.0 - 0.75 * rest + 0.15 * rest * rest
    };
    let along = flux.dot(normal) / length.max(1e-30);
    (0.25 - 0.5 * directed * along + 0.156_25 * second * (3.0 * along * along - 1.0)).max(0.0)
        * light.w.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(directed: f32) -> Vec4 {
        (3.0 * directed * Vec3::new(0.2, -0.7, 0.4).normalize()).extend(3.0)
    }

    #[test]
    fn energy_and_flux_are_kept() {
        for (directed, off) in
            [(0.0, 1e-5), (1e-4, 1e-5), (0.2, 1e-5), (0.5, 1e-5), (0.6, 0.04), (0.75, 0.04)]
        {
            let light = light(directed);
            let sent = moments(lobe(light));
            assert!((sent.w - 3.0).abs() < 1e-5, "{directed}: {sent}");
            assert!((sent.xyz() - light.xyz()).length() < off * 3.0, "{directed}: {sent} of {light}");
        }
    }

    /// The mean over the sphere.
    fn mean(of: impl Fn(Vec3) -> f32) -> f32 {
        let (rings, segments) = (400u16, 400u16);
        let mut sum = 0.0;
        for i in 0..u32::from(rings) * u32::from(segments) {
            let z = 1.0 - 2.0 * ((i / u32::from(segments)) as f32 + 0.5) / f32::from(rings);
            let (sin, cos) =
                (std::f32::consts::TAU * (i % u32::from(segments)) as f32 / f32::from(segments)).sin_cos();
            sum += f64::from(of(Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)));
        }
        (sum / f64::from(u32::from(rings) * u32::from(segments))) as f32
    }

    #[test]
    fn irradiance_is_the_integral_over_the_hemisphere() {
        for (directed, off) in [(0.3, 1e-3), (0.5, 1e-3), (0.6, 5e-3), (0.75, 5e-3)] {
            let light = light(directed);
            let lobe = lobe(light);
            let energy = mean(|direction| towards(lobe, direction));
            for normal in [Vec3::new(0.6, 0.0, 0.8), Vec3::Y, Vec3::NEG_Y] {
                let arrives = mean(|direction| towards(lobe, direction) * (-direction.dot(normal)).max(0.0));
                // Without what sums over 26 directions are off integrals.
                let wanted = arrives * light.w / energy;
                let is = irradiance(light, normal);
                assert!((is - wanted).abs() < off * light.w, "{directed}, {normal}: {is} for {wanted}");
            }
        }
    }

    #[test]
    fn what_is_directed_too_much_keeps_its_energy_and_direction() {
        for light in [Vec4::new(0.0, 2.0, 0.0, 2.0), Vec4::new(9.0, 0.0, 0.0, 2.0)] {
            let sent = moments(lobe(light));
            assert!((sent.w - 2.0).abs() < 1e-5);
            let along = sent.xyz().dot(light.xyz().normalize()) / 2.0;
            assert!(
                (along - MOST_DIRECTED).abs() < 0.04
                    && sent.xyz().normalize().dot(light.xyz().normalize()) > 0.999
            );
        }
        for light in [Vec4::ZERO, Vec4::new(0.0, 0.0, 0.0, -1.0)] {
            assert_eq!(lobe(light), Vec4::ZERO);
            assert_eq!(irradiance(light, Vec3::Y), 0.0);
        }
    }

    #[test]
    fn bands_keep_energy_and_may_be_negative() {
        let light = light(0.9);
        let kept = Lobes::TwoBands.begins(light);
        let sent = |n: Neighbour| SHARES[n.class] * Lobes::TwoBands.towards(kept, &n);
        assert!((neighbours().map(sent).sum::<f32>() - 3.0).abs() < 1e-5);
        for (class, energy) in Lobes::TwoBands.by_class(kept).into_iter().enumerate() {
            let sum: f32 = neighbours().filter(|n| n.class == class).map(sent).sum();
            assert!((sum - energy).abs() < 1e-5, "{class}: {sum} for {energy}");
        }
        assert!(neighbours().map(sent).fold(0.0, f32::min) < -0.1 * SHARES[0]);
        assert!(lobe(light).w >= 0.0);
    }
}
