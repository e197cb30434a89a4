//! A last layer that predicts kernels: the last convolution makes weights, and the image is the sum that they
//! weight of the light that the network reads (Bako et al. 2017, "Kernel-predicting convolutional networks
//! for denoising Monte Carlo renderings"; over several resolutions after Vogels et al. 2018, "Denoising with
//! kernel prediction and asymmetric loss functions").
//!
//! What every form of a network computes, for an image of any size:
//!
//! - Level 0 of the pyramid is the light, continued at bottom and right by its last row and column up to a
//!   multiple of [`NetSpec::alignment`], as the convolutions read it. Level l has the means of 2x2 pixels of
//!   level l - 1.
//! - A level is read bilinearly between the centres of its pixels, and beyond its edge as at the edge. Pixel
//!   x of the image lies at `(x + 0.5) / 2^l - 0.5` of level l, and the taps of a kernel are one pixel of the
//!   level apart.
//! - A pixel's weights are the softmax of what the last convolution makes there: level by level, each level's
//!   kernel row by row, and where [`Filter::black`] says so one more, of black. All colour channels that a
//!   run makes have the same weights.

use crate::{Colour, Head, NetSpec};
use serde::{Deserialize, Serialize};

/// Which pixels of the light an image is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Filter {
    /// Levels of the pyramid; at most those of the network.
    pub levels: usize,
    /// Width and height of the kernel on every level; odd.
    pub kernel: usize,
    /// Whether the last weight is that of black, for effects that take light away.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub black: bool,
}

/// A pixel of the pyramid that an image's pixel is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tap {
    /// Level of the pyramid.
    pub level: usize,
    /// Rows and columns of the level from where the image's pixel lies.
    pub offset: [isize; 2],
}

impl Filter {
    /// Number of pixels of the pyramid that an image's pixel is made of.
    pub const fn tap_count(&self) -> usize {
        self.levels * self.kernel * self.kernel
    }

    /// Number of weights that a pixel has: one a tap, and where there is one that of black.
    pub const fn weight_count(&self) -> usize {
        self.tap_count() + self.black as usize
    }

    /// The taps in the order of their weights.
    pub fn taps(&self) -> impl Iterator<Item = Tap> + use<> {
        let radius = (self.kernel / 2) as isize;
        let offsets = move || (-radius..=radius).flat_map(move |y| (-radius..=radius).map(move |x| [y, x]));
        (0..self.levels).flat_map(move |level| offsets().map(move |offset| Tap { level, offset }))
    }
}

impl NetSpec {
    /// The same network with a last layer that predicts kernels: of 3x3 pixels on every level, or of 5x5
    /// where there is one level only; with black where the effect hides light; for all colours at once, or
    /// where the effect parts colours for one of them a run. None where the network reads no light.
    pub fn predicting_kernels(&self) -> Option<Self> {
        let levels = self.levels();
        let kernel = if levels == 1 { 5 } else { 3 };
        let filter = Filter { levels, kernel, black: self.effect.definition().hides_light };
        let colour = if self.effect.definition().parts_colours { Colour::Mono } else { Colour::Rgb };
        let spec = Self { colour, ..self.clone() }.with_head(Head::Filter(filter));
        spec.validate().is_ok().then_some(spec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};
    use deepshade_shaders::{Attribute, Effect};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    fn published(effect: Effect) -> NetSpec {
        NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("the paper has one")
    }

    #[test]
    fn taps_go_level_by_level_and_row_by_row() {
        let filter = Filter { levels: 2, kernel: 3, black: false };
        let taps: Vec<Tap> = filter.taps().collect();
        assert_eq!(taps.len(), filter.tap_count());
        assert_eq!(taps[1], Tap { level: 0, offset: [-1, 0] });
        assert_eq!(taps[4], Tap { level: 0, offset: [0, 0] });
        assert_eq!(taps[9 + 5], Tap { level: 1, offset: [0, 1] });
    }

    #[test]
    fn the_light_is_what_the_image_is_of() {
        let channels = |effect| published(effect).channels_of(Attribute::Light);
        assert_eq!((channels(Effect::Dof), channels(Effect::Multi)), (vec![2], vec![8, 9, 10]));
        assert!(channels(Effect::Ao).is_empty());
    }

    #[test]
    fn the_last_layer_makes_a_weight_a_tap() {
        let dof = published(Effect::Dof);
        let filter = Filter { levels: 5, kernel: 3, black: false };
        let spec = dof.clone().with_head(Head::Filter(filter));
        assert_eq!(spec.validate(), Ok(()));
        assert_eq!(spec.weight_count() - dof.weight_count(), 44 * (48 * 9 + 1));
        assert_eq!((spec.output_channels(), spec.runs()), (1, 3));
    }

    #[test]
    fn networks_that_read_light_can_predict_kernels() {
        let taps = |effect| {
            published(effect).predicting_kernels().and_then(|spec| spec.filter()).map(|f| f.tap_count())
        };
        assert_eq!((taps(Effect::Dof), taps(Effect::Aa), taps(Effect::Gi)), (Some(45), Some(25), None));
        let dof = published(Effect::Dof).predicting_kernels().expect("it reads light");
        assert_eq!((dof.input_channels(), dof.last_channels(), dof.runs()), (5, 45, 1));
        let multi = published(Effect::Multi).predicting_kernels().expect("it reads light");
        assert_eq!((multi.input_channels(), multi.last_channels(), multi.runs()), (11, 46, 1));
        let sss = published(Effect::Sss).predicting_kernels().expect("it reads light");
        assert_eq!((sss.input_channels(), sss.last_channels(), sss.runs()), (5, 45, 3));
    }

    #[test]
    fn black_is_written_where_there_is_some() {
        let text = |black| serde_json::to_string(&Filter { levels: 5, kernel: 3, black }).expect("JSON");
        assert_eq!(text(false), r#"{"levels":5,"kernel":3}"#);
        assert_eq!(text(true), r#"{"levels":5,"kernel":3,"black":true}"#);
        let without = serde_json::from_str(r#"{"levels":5,"kernel":3}"#);
        assert_eq!(without.ok(), Some(Filter { levels: 5, kernel: 3, black: false }));
    }

    #[test]
    fn a_filter_of_what_is_not_there_is_named() {
        let filtered = |effect, levels, kernel| {
            let spec = published(effect).with_head(Head::Filter(Filter { levels, kernel, black: false }));
            spec.validate().expect_err("it cannot be").to_string()
        };
        assert!(filtered(Effect::Dof, 6, 1).starts_with("`head.levels` is 6"));
        assert!(filtered(Effect::Dof, 5, 2).starts_with("`head.kernel` is 2"));
        assert!(filtered(Effect::Ao, 5, 1).contains("works on 0 channels"));
    }
}
