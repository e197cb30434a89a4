//! Textures: 8-bit texels, sampled as linear values.

use super::SceneError;
use super::decode::{Image, decode};
use super::file::read;
use deepshade_shaders::colour::{LINEAR_OF_SRGB, srgb_byte};
use glam::{Vec2, Vec4};
use std::path::Path;
use std::sync::Arc;

/// What the stored bytes mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Red, green and blue in sRGB, alpha linear.
    Srgb,
    /// All four linear.
    Linear,
}

/// What happens outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// Starts again.
    Repeat,
    /// Starts again mirrored.
    Mirror,
    /// Stays at the edge.
    Clamp,
}

/// What stands between the middles of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Filter {
    /// The bilinear mean of the four texels around.
    #[default]
    Linear,
    /// The texel that is nearest, for images whose texels are to be seen.
    Nearest,
}

/// An image that materials read, origin top left, `[height][width]` texels of four bytes, which copies share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Arc<[[u8; 4]]>,
    encoding: Encoding,
    wrap: [Wrap; 2],
    filter: Filter,
}

impl Texture {
    /// A bilinear texture around `texels`, row by row from the top left.
    ///
    /// # Panics
    /// If it has no texel or not `width * height` of them.
    pub fn new(
        width: usize,
        height: usize,
        texels: Vec<[u8; 4]>,
        encoding: Encoding,
        wrap: [Wrap; 2],
    ) -> Self {
        assert!(!texels.is_empty() && texels.len() == width * height, "{width} x {height} texels");
        Self { width, height, texels: texels.into(), encoding, wrap, filter: Filter::Linear }
    }

    /// An image, read bilinearly in one of several ways; all share its texels.
    pub(super) fn of(image: &Image, encoding: Encoding, wrap: [Wrap; 2]) -> Self {
        let Image { width, height, texels } = image.clone();
        Self { width, height, texels, encoding, wrap, filter: Filter::Linear }
    }

    /// The same texels with something else between their middles.
    #[must_use]
    pub fn with_filter(self, filter: Filter) -> Self {
        Self { filter, ..self }
    }

    /// Reads a PNG, JPEG, BMP, TGA or KTX2 image, whose colours are taken as sRGB, to be repeated.
    ///
    /// # Errors
    /// If the file is missing, damaged or no such image.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::load_as(path, Encoding::Srgb)
    }

    /// The same of an image whose bytes mean something else.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_as(path: &Path, encoding: Encoding) -> Result<Self, SceneError> {
        let image = decode(&read(path)?).map_err(|what| SceneError::invalid(path, what))?;
        Ok(Self::of(&image, encoding, [Wrap::Repeat; 2]))
    }

    /// Texels in a row and in a column.
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The texels as stored, row by row from the top left.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// Whether no texel has a colour.
    pub fn is_black(&self) -> bool {
        self.texels.iter().all(|[r, g, b, _]| [r, g, b] == [&0; 3])
    }

    /// What the stored bytes mean.
    pub const fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// What happens outside [0, 1] along u and v.
    pub const fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// What stands between the middles of texels.
    pub const fn filter(&self) -> Filter {
        self.filter
    }

    /// Half as large: means of two by two texels, of light where they are sRGB; the last column and row of
    /// odd sizes count twice.
    #[must_use]
    pub fn halved(&self) -> Self {
        let [width, height] = [self.width, self.height].map(|edge| edge.div_ceil(2));
        let mean = |index: usize| {
            let (x, y) = ((2 * (index % width)) as f32, (2 * (index / width)) as f32);
            let four = [(x, y), (x + 1.0, y), (x, y + 1.0), (x + 1.0, y + 1.0)];
            let mean = four.map(|(x, y)| self.texel(x, y, [Wrap::Clamp; 2])).into_iter().sum::<Vec4>() / 4.0;
            let byte = |value: f32| (value * 255.0).round() as u8;
            let [r, g, b] = [mean.x, mean.y, mean.z].map(|value| match self.encoding {
                Encoding::Srgb => srgb_byte(value),
                Encoding::Linear => byte(value),
            });
            [r, g, b, byte(mean.w)]
        };
        let texels = (0..width * height).map(mean).collect();
        Self { width, height, texels, ..self.clone() }
    }

    /// The linear value at `uv`, between texel middles as [`Texture::filter`] says. Coordinates that are not
    /// finite are taken as 0.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        self.sample_wrapped(uv, self.wrap)
    }

    /// [`Texture::sample`] where something else is to happen outside [0, 1].
    pub fn sample_wrapped(&self, uv: Vec2, wrap: [Wrap; 2]) -> Vec4 {
        let finite = |coordinate: f32| if coordinate.is_finite() { coordinate } else { 0.0 };
        let (x, y) = (finite(uv.x * self.width as f32), finite(uv.y * self.height as f32));
        if self.filter == Filter::Nearest {
            return self.texel(x.floor(), y.floor(), wrap);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let texel = |x: f32, y: f32| self.texel(x, y, wrap);
        let top = texel(x0, y0).lerp(texel(x0 + 1.0, y0), fx);
        let bottom = texel(x0, y0 + 1.0).lerp(texel(x0 + 1.0, y0 + 1.0), fx);
        top.lerp(bottom, fy)
    }

    /// The linear value of the texel at whole-numbered `x` and `y`, wrapped.
    fn texel(&self, x: f32, y: f32, wrap: [Wrap; 2]) -> Vec4 {
        let column = wrapped(x, self.width, wrap[0]);
        let row = wrapped(y, self.height, wrap[1]);
        let [r, g, b, a] = self.texels[row * self.width + column];
        let [r, g, b] = match self.encoding {
            Encoding::Srgb => [r, g, b].map(|byte| LINEAR_OF_SRGB[byte as usize]),
            Encoding::Linear => [r, g, b].map(|byte| f32::from(byte) / 255.0),
        };
        Vec4::new(r, g, b, f32::from(a) / 255.0)
    }
}

/// The texel index that a whole-numbered coordinate stands for.
fn wrapped(coordinate: f32, size: usize, wrap: Wrap) -> usize {
    let size = size as i64;
    let at = coordinate as i64;
    let index = match wrap {
        Wrap::Repeat => at.rem_euclid(size),
        Wrap::Clamp => at.clamp(0, size - 1),
        Wrap::Mirror => {
            let folded = at.rem_euclid(2 * size);
            if folded < size { folded } else { 2 * size - 1 - folded }
        }
    };
    index as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wrap: Wrap) -> Texture {
        let texels = (0..4).map(|x| [x * 10, 0, 0, 255]).collect();
        Texture::new(4, 1, texels, Encoding::Linear, [wrap; 2])
    }

    #[test]
    fn texel_middles_are_exact_and_halfway_is_the_mean() {
        let texture = ramp(Wrap::Clamp);
        assert!((texture.sample(Vec2::new(0.375, 0.5)).x * 255.0 - 10.0).abs() < 1e-3);
        assert!((texture.sample(Vec2::new(0.5, 0.5)).x * 255.0 - 15.0).abs() < 1e-3);
    }

    #[test]
    fn the_nearest_texel_reaches_half_way_to_the_next() {
        let nearest = ramp(Wrap::Repeat).with_filter(Filter::Nearest);
        let at = |u: f32| (nearest.sample(Vec2::new(u, 0.5)).x * 255.0).round();
        assert_eq!([0.01, 0.24, 0.26, 0.49, 0.51, 0.99].map(at), [0.0, 0.0, 10.0, 10.0, 20.0, 30.0]);
        assert_eq!([-0.01, 1.01, 1.3].map(at), [30.0, 0.0, 10.0]);
        // Bilinear, that would be almost the mean of two.
        assert!((ramp(Wrap::Repeat).sample(Vec2::new(0.26, 0.5)).x * 255.0 - 5.4).abs() < 1e-3);
    }

    #[test]
    fn wrapping_outside() {
        let at = |wrap, u| (ramp(wrap).sample(Vec2::new(u, 0.5)).x * 255.0).round();
        assert_eq!(at(Wrap::Repeat, 1.125), 0.0);
        assert_eq!(at(Wrap::Clamp, 1.125), 30.0);
        assert_eq!(at(Wrap::Mirror, 1.125), 30.0);
        assert_eq!(at(Wrap::Mirror, -0.375), 10.0);
    }

    #[test]
    fn coordinates_that_are_not_finite_are_zero() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let texture = ramp(wrap);
            for bad in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX] {
                let at = texture.sample(Vec2::new(bad, 0.5));
                assert_eq!(at, texture.sample(Vec2::new(0.0, 0.5)), "{wrap:?} at {bad}");
                assert_eq!(texture.sample(Vec2::new(0.5, bad)), texture.sample(Vec2::new(0.5, 0.0)));
            }
        }
    }

    #[test]
    fn halving_keeps_the_mean_of_light() {
        let halved = |width: usize, height: usize, texels: Vec<[u8; 4]>, encoding: Encoding| {
            Texture::new(width, height, texels, encoding, [Wrap::Repeat; 2]).halved().texels().to_vec()
        };
        let black_and_white = vec![[0, 0, 0, 0], [255; 4], [255; 4], [0, 0, 0, 0]];
        assert_eq!(halved(2, 2, black_and_white.clone(), Encoding::Linear), [[128; 4]]);
        // Half the light is 188 in sRGB; alpha is linear.
        assert_eq!(halved(2, 2, black_and_white, Encoding::Srgb), [[188, 188, 188, 128]]);
        let row: Vec<[u8; 4]> = (0..5).map(|x| [x * 10; 4]).collect();
        assert_eq!(halved(5, 1, row, Encoding::Linear), [[5; 4], [25; 4], [40; 4]]);
    }

    #[test]
    fn srgb_is_decoded() {
        let texture = Texture::new(1, 1, vec![[188, 0, 0, 128]], Encoding::Srgb, [Wrap::Repeat; 2]);
        let value = texture.sample(Vec2::ZERO);
        assert!((value.x - 0.5029).abs() < 1e-3 && (value.w - 128.0 / 255.0).abs() < 1e-6);
    }
}
