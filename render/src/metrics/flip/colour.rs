//! The colour spaces of FLIP: linear sRGB, the opponent space YCxCz (CIELab without its cube root), and
//! CIELab with Hunt's adjustment.

use deepshade_shaders::Planes;
use glam::{Mat3, Vec3};
use std::sync::LazyLock;

/// Linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Rgb(pub Vec3);

/// YCxCz: lightness, red against green, yellow against blue (Poynton and Funt's linear opponent space).
#[derive(Clone, Copy, Debug)]
pub struct Opponent(pub [f32; 3]);

/// CIELab whose chromas grow with lightness (Hunt 1952).
#[derive(Clone, Copy, Debug)]
pub struct Lab(Vec3);

/// From linear sRGB to XYZ with the white point D65 (IEC 61966-2-1 in fractions), columns.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols(
    Vec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    Vec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    Vec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

/// The way back.
static RGB_FROM_XYZ: LazyLock<Mat3> = LazyLock::new(|| XYZ_FROM_RGB.inverse());

/// XYZ of white.
fn white() -> Vec3 {
    XYZ_FROM_RGB * Vec3::ONE
}

impl Rgb {
    /// A pixel of an image of one or three channels.
    ///
    /// # Panics
    /// If the image has another number of channels.
    pub fn read(image: &Planes, pixel: usize) -> Self {
        let channel = |c: usize| image.plane(c)[pixel];
        match image.channels() {
            1 => Self(Vec3::splat(channel(0))),
            channels => {
                assert_eq!(channels, 3, "FLIP compares images of one or three channels");
                Self(Vec3::new(channel(0), channel(1), channel(2)))
            }
        }
    }

    /// Limited to [0, 1]; what is not a number stays so.
    pub fn clamped(self) -> Self {
        Self(Vec3::from_array(self.0.to_array().map(|value| value.clamp(0.0, 1.0))))
    }

    /// In YCxCz.
    pub fn to_opponent(self) -> Opponent {
        let relative = XYZ_FROM_RGB * self.0 / white();
        Opponent([
            116.0 * relative.y - 16.0,
            500.0 * (relative.x - relative.y),
            200.0 * (relative.y - relative.z),
        ])
    }

    /// In CIELab with Hunt's adjustment.
    pub fn to_lab(self) -> Lab {
        let [x, y, z] = (XYZ_FROM_RGB * self.0 / white()).to_array().map(cie_root);
        let lightness = 116.0 * y - 16.0;
        let hunt = 0.01 * lightness;
        Lab(Vec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)))
    }
}

impl Opponent {
    /// In linear sRGB, possibly outside of [0, 1].
    pub fn to_rgb(self) -> Rgb {
        let [y, cx, cz] = self.0;
        let y = (y + 16.0) / 116.0;
        Rgb(*RGB_FROM_XYZ * (Vec3::new(y + cx / 500.0, y, y - cz / 200.0) * white()))
    }

    /// Lightness scaled to [0, 1].
    pub fn lightness(self) -> f32 {
        (self.0[0] + 16.0) / 116.0
    }
}

impl Lab {
    /// HyAB, made for large differences: those of lightness and of chroma are added (Abasi, Amani Tehran and
    /// Fairchild 2020).
    pub fn difference(self, other: Self) -> f32 {
        let between = self.0 - other.0;
        between.x.abs() + between.y.hypot(between.z)
    }
}

/// The largest difference of two colours of sRGB: between its green and its blue.
pub fn largest_difference() -> f32 {
    Rgb(Vec3::Y).to_lab().difference(Rgb(Vec3::Z).to_lab())
}

/// The cube root of CIELab with its straight part near 0.
fn cie_root(value: f32) -> f32 {
    const KNEE: f32 = 6.0 / 29.0;
    if value > KNEE * KNEE * KNEE { value.cbrt() } else { value / (3.0 * KNEE * KNEE) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opponent_space_leads_back_to_rgb() {
        let colour = Vec3::new(0.2, 0.7, 0.4);
        let back = Rgb(colour).to_opponent().to_rgb().0;
        assert!((back - colour).abs().max_element() < 1e-5);
    }

    #[test]
    fn greys_have_no_chroma_and_white_has_lightness_100() {
        let Lab(white) = Rgb(Vec3::ONE).to_lab();
        assert!((white - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-3);
        let Lab(grey) = Rgb(Vec3::splat(0.18418652)).to_lab();
        assert!((grey - Vec3::new(50.0, 0.0, 0.0)).length() < 1e-3);
    }

    #[test]
    fn red_has_the_published_lab() {
        // L 53.24, a 80.09, b 67.20 under D65; Hunt's adjustment multiplies a and b by L / 100.
        let Lab(red) = Rgb(Vec3::X).to_lab();
        let expected = Vec3::new(53.24, 0.5324 * 80.09, 0.5324 * 67.20);
        assert!((red - expected).length() < 0.05, "{red}");
    }
}
