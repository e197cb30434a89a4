//! What of a view a recipe may draw by the view's seed, as people have it: the size of the image, the
//! camera's field of view, and how far the effect reaches.

use super::{FieldOfView, Radius, Recipe};
use crate::random::uniform;
use crate::vary::purpose;

/// Heights and widths of drawn sizes are multiples of it, pixels: of a tile of structural similarity, and of
/// what networks halve three times.
pub const SIZE_STEP: usize = 8;

impl Recipe {
    /// Height and width of the image of a view with this seed, pixels: `resolution`, or with `smallest` each
    /// of them log-uniform between the two, a multiple of [`SIZE_STEP`].
    pub fn size(&self, seed: u32) -> [usize; 2] {
        let most = [self.resolution.height, self.resolution.width];
        let Some(smallest) = self.smallest else { return most };
        let least = [smallest.height, smallest.width];
        std::array::from_fn(|edge| {
            let range = [least[edge] as f32, most[edge] as f32];
            let drawn = log_uniform(range, uniform(&[u64::from(seed), purpose::SIZE, edge as u64]));
            (drawn / SIZE_STEP as f32).round() as usize * SIZE_STEP
        })
    }

    /// Vertical field of view of a view with this seed, degrees; `None` where the recipe states none.
    pub(crate) fn degrees(&self, seed: u32) -> Option<f32> {
        self.field_of_view.map(|field_of_view| match field_of_view {
            FieldOfView::Fixed(degrees) => degrees,
            FieldOfView::Drawn([low, high]) => {
                low + (high - low) * uniform(&[u64::from(seed), purpose::FIELD_OF_VIEW])
            }
        })
    }

    /// Whether images, cameras or radii are drawn, so that they differ from view to view; by the key that
    /// says so.
    pub(super) fn drawn_key(&self) -> Option<&'static str> {
        let drawn = [
            ("smallest", self.smallest.is_some()),
            ("field_of_view", matches!(self.field_of_view, Some(FieldOfView::Drawn(_)))),
            ("radius", matches!(self.radius, Radius::Pixels(_) | Radius::MetresBetween(_))),
        ];
        drawn.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }
}

impl Radius {
    /// The radius in metres in a scene with this diagonal; `None` where it is drawn for each view.
    pub fn metres(self, diagonal: f32) -> Option<f32> {
        match self {
            Self::Diagonal(share) => Some(share * diagonal),
            Self::Metres(metres) => Some(metres),
            Self::Pixels(_) | Self::MetresBetween(_) => None,
        }
    }

    /// The radius in metres of a view with this seed, in a scene with this diagonal; `pixel` is what a pixel
    /// spans at the view's median depth, metres.
    pub(crate) fn of_view(self, seed: u32, diagonal: f32, pixel: impl FnOnce() -> f32) -> f32 {
        let share = uniform(&[u64::from(seed), purpose::RADIUS]);
        match self {
            Self::Diagonal(part) => part * diagonal,
            Self::Metres(metres) => metres,
            Self::Pixels(range) => (log_uniform(range, share) * pixel()).min(MOST_OF_DIAGONAL * diagonal),
            Self::MetresBetween(range) => log_uniform(range, share),
        }
    }

    /// The radius times a factor, however it is stated.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        match self {
            Self::Diagonal(share) => Self::Diagonal(factor * share),
            Self::Metres(metres) => Self::Metres(factor * metres),
            Self::Pixels(range) => Self::Pixels(range.map(|pixels| factor * pixels)),
            Self::MetresBetween(range) => Self::MetresBetween(range.map(|metres| factor * metres)),
        }
    }
}

/// A radius of so many pixels is at most this share of the scene's diagonal.
const MOST_OF_DIAGONAL: f32 = 0.5;

/// The number of a range, which lies above 0, at a share of the way between the logarithms of its ends.
fn log_uniform([low, high]: [f32; 2], share: f32) -> f32 {
    (low * (high / low).powf(share)).clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Resolution;

    #[test]
    fn sizes_are_log_uniform_multiples_of_eight_within_their_limits() {
        let mut recipe = crate::shipped::shrunk("ao-tiny.toml");
        recipe.resolution = Resolution { height: 768, width: 512 };
        assert_eq!(recipe.size(7), [768, 512], "all alike without `smallest`");
        recipe.smallest = Some(Resolution { height: 192, width: 512 });
        let sizes: Vec<[usize; 2]> = (0..4000).map(|seed| recipe.size(seed)).collect();
        assert!(sizes.iter().all(|[height, width]| height % 8 == 0 && *width == 512));
        assert!(sizes.iter().all(|[height, _]| (192..=768).contains(height)));
        // The geometric mean of the ends is the median: four standard deviations of the share below it.
        let below = sizes.iter().filter(|[height, _]| *height < 384).count() as f32 / 4000.0;
        assert!((below - 0.5).abs() < 0.05, "{below}");
    }

    #[test]
    fn fields_of_view_are_uniform() {
        let mut recipe = crate::shipped::shrunk("ao-tiny.toml");
        assert_eq!(recipe.degrees(1), None);
        recipe.field_of_view = Some(FieldOfView::Drawn([35.0, 90.0]));
        let degrees: Vec<f32> = (0..4000).filter_map(|seed| recipe.degrees(seed)).collect();
        assert!(degrees.iter().all(|degrees| (35.0..90.0).contains(degrees)));
        let mean = degrees.iter().sum::<f32>() / degrees.len() as f32;
        // The standard deviation of the mean is 55 / sqrt(12 * 4000).
        assert!((mean - 62.5).abs() < 1.0, "{mean}");
    }

    #[test]
    fn radii_of_pixels_grow_with_depth_up_to_half_the_diagonal() {
        let radius = Radius::Pixels([8.0, 160.0]);
        let of_view = |seed, pixel| radius.of_view(seed, 10.0, || pixel);
        for seed in 0..100 {
            let pixels = of_view(seed, 0.01) / 0.01;
            assert!((7.99..160.1).contains(&pixels), "{pixels}");
            assert!((of_view(seed, 0.02) / of_view(seed, 0.01) - 2.0).abs() < 1e-4);
            assert!(of_view(seed, 10.0) <= 5.0);
        }
        assert_eq!(Radius::Pixels([40.0, 40.0]).of_view(3, 10.0, || 0.01), 40.0 * 0.01);
        assert_eq!(Radius::Diagonal(0.1).of_view(3, 10.0, || 0.01), 1.0);
        let metres = Radius::MetresBetween([0.2, 2.0]);
        let below = (0..4000).filter(|seed| metres.of_view(*seed, 1.0, || 1.0) < 0.4f32.sqrt()).count();
        assert!((below as f32 / 4000.0 - 0.5).abs() < 0.05, "{below}");
        assert_eq!((metres.metres(1.0), radius.metres(1.0)), (None, None));
    }
}
