//! What a network's last block makes the image of.

use super::NetSpec;
use crate::{Filter, SpecError, Tap};
use deepshade_shaders::{Attribute, Planes};
use serde::{Deserialize, Serialize};

/// How the image follows from what the last block makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Head {
    /// It is the image, as in the thesis.
    #[default]
    Image,
    /// It is the weights of a [`Filter`] of the light that the network reads.
    Filter(Filter),
    /// It corrects an estimate that the network reads.
    Correction(Correction),
}

/// An estimate E of the image, of which the last block makes a better one: of every colour channel
///
/// ```text
/// image = E + (bias or gain * E) + sum over taps t of w(t) * (S(t) - E)
/// ```
///
/// within the effect's range. Where it is gated, what is added counts by [`Correction::gate`]. S(t) are
/// pixels of a pyramid of `over`, laid out and read as those of a [`Filter`]. Weights that are 0 leave the
/// estimate as it is. The last block makes the bias of each channel, where there is one, then the weights and
/// the gain, which all channels share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correction {
    /// E: one of the network's inputs, of as many channels as the image.
    pub of: Attribute,
    /// What the pyramid is of: another such input, usually the estimate before its own blur.
    pub over: Attribute,
    /// Levels of the pyramid; 0 where there is a bias alone.
    pub levels: usize,
    /// Width and height of the kernel on every level; odd.
    pub kernel: usize,
    /// Whether there is a gain in place of the bias, for light: what hides a share of it hides that of bright
    /// and of dim light, and where there is none no network may add any.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub gain: bool,
    /// Whether nothing is corrected where the estimate is what the pyramid is of: a filter that leaves light
    /// as it is there knows that nothing moves, or that all is in focus.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub gated: bool,
}

/// Half of a correction counts where the estimate differs by this from what the pyramid is of: a step of a
/// picture of 8 bits.
pub const HALF_GATE: f32 = 1.0 / 256.0;

impl Correction {
    /// The taps, as those of a filter.
    pub const fn filter(&self) -> Filter {
        Filter { levels: self.levels, kernel: self.kernel, black: false }
    }

    /// Number of biases that a pixel of so many channels has.
    pub const fn bias_count(&self, channels: usize) -> usize {
        if self.gain { 0 } else { channels }
    }

    /// Number of weights that a pixel has: one a tap, and the gain.
    pub const fn weight_count(&self) -> usize {
        self.filter().tap_count() + self.gain as usize
    }

    /// The taps in the order of their weights.
    pub fn taps(&self) -> impl Iterator<Item = Tap> + use<> {
        self.filter().taps()
    }

    /// How much of a correction counts in a pixel, by the largest difference of a channel of the estimate
    /// from what the pyramid is of.
    pub fn gate(&self, difference: f32) -> f32 {
        if self.gated { difference / (difference + HALF_GATE) } else { 1.0 }
    }
}

impl NetSpec {
    /// The same network with another head; the last block makes as many channels as that needs.
    #[must_use]
    pub fn with_head(mut self, head: Head) -> Self {
        self.head = head;
        let channels = self.last_channels();
        if let Some(last) = self.blocks.last_mut() {
            last.outputs = channels;
        }
        self
    }

    /// The filter of the light, where the network predicts its weights.
    pub const fn filter(&self) -> Option<Filter> {
        match self.head {
            Head::Filter(filter) => Some(filter),
            Head::Image | Head::Correction(_) => None,
        }
    }

    /// Channels a pixel of the image that the head works on.
    pub fn head_channels(&self) -> usize {
        match self.head {
            Head::Image => self.output_channels(),
            Head::Filter(filter) => filter.weight_count(),
            Head::Correction(correction) => {
                correction.bias_count(self.output_channels()) + correction.weight_count()
            }
        }
    }

    /// What the pyramid of the head is of: which of the channels that a run reads; none without one.
    pub fn pyramid_channels(&self) -> Vec<usize> {
        match self.head {
            Head::Image => Vec::new(),
            Head::Filter(_) => self.channels_of(Attribute::Light),
            Head::Correction(correction) => self.channels_of(correction.over),
        }
    }

    /// Which of the channels that a run reads are those of an attribute, in their order.
    pub fn channels_of(&self, attribute: Attribute) -> Vec<usize> {
        let mut found = Vec::new();
        let mut read = 0;
        for input in &self.inputs {
            let width = self.width(*input);
            if *input == attribute {
                found.extend(read..read + width);
            }
            read += width;
        }
        found
    }

    /// Whether the network reads what its head works on, and has the levels.
    pub(super) fn validate_head(&self) -> Result<(), SpecError> {
        let (levels, kernel, least) = match self.head {
            Head::Image => return Ok(()),
            Head::Filter(Filter { levels, kernel, .. }) => (levels, kernel, 1),
            Head::Correction(Correction { levels, kernel, gated, .. }) => (levels, kernel, gated as usize),
        };
        let range =
            |name, found: usize, allowed| SpecError::Range { name, found: found.to_string(), allowed };
        if !(least..=self.levels()).contains(&levels) {
            return Err(range(
                "head.levels",
                levels,
                "at most as many as the network has, of a filter or a gated correction at least 1",
            ));
        }
        if !matches!(kernel, 1 | 3 | 5 | 7) {
            return Err(range("head.kernel", kernel, "1, 3, 5 or 7"));
        }
        let channels = self.output_channels();
        let counts = |lights: usize| {
            if lights == channels { Ok(()) } else { Err(SpecError::Light { lights, channels }) }
        };
        counts(self.pyramid_channels().len())?;
        match self.head {
            Head::Correction(correction) => counts(self.channels_of(correction.of).len()),
            _ => Ok(()),
        }
    }
}

/// Some channels of a run's input, `[channels, height, width]`.
pub fn channels(input: &Planes, wanted: &[usize]) -> Planes {
    let data = wanted.iter().flat_map(|channel| input.plane(*channel)).copied().collect();
    Planes::from_data(wanted.len(), input.height(), input.width(), data)
}
