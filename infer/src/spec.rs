//! The shape of a network: one list of blocks that drives burn's module, the WGSL passes, the ONNX writer and
//! the reference forward pass; what it reads, and how its image follows from what the last block makes.

mod block;
mod head;
mod trained;
mod trunk;
mod u_net;

pub use block::{Block, BlockSource, Layer, joined_order};
pub use head::{Correction, HALF_GATE, Head, channels};
pub use trained::{Outside, Trained, TrainedUnder};
pub use u_net::{ChannelOrder, UNet};

use crate::Reach;
use deepshade_shaders::{Attribute, AttributeKind, Effect};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Which colour channels one run of a network makes (thesis 7.3.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colour {
    /// One: the network is trained on single channels, and runs once for each that the effect has. Of colours
    /// it reads the same channel.
    #[default]
    Mono,
    /// All of the effect's at once.
    Rgb,
}

/// Most rows of the frames that a network is trained on.
const MOST_ROWS: usize = 8192;
/// Most blocks of a network.
const MOST_BLOCKS: usize = 64;
/// Most channels that a block makes.
const MOST_CHANNELS: usize = 1 << 14;
/// The coarsest level of a network.
const MOST_LEVEL: usize = 7;

/// A network, but for its weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetSpec {
    /// What the network computes.
    pub effect: Effect,
    /// What it reads, in this order.
    pub inputs: Vec<Attribute>,
    /// Analytic methods that make some of the inputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub estimates: Vec<AnalyticEstimate>,
    /// Which colour channels a run makes.
    #[serde(default)]
    pub colour: Colour,
    /// Factor of negative values in the leaky ReLU.
    pub leak: f32,
    /// The convolutions, in the order of computation.
    pub blocks: Vec<Block>,
    /// How the image follows from what the last block makes.
    #[serde(default)]
    pub head: Head,
    /// What it was trained to reach.
    pub reach: Reach,
    /// What it was trained on, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trained: Option<Trained>,
    /// The environment that it knows by heart, of effects that are lit by one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub environment: Option<TrainedUnder>,
}

/// An analytic method whose image a network reads.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalyticEstimate {
    /// Its name.
    pub method: String,
    /// Its quality: `low`, `medium`, `high` or `ultra`.
    pub quality: String,
    /// The effect that it is a method of, where that is not the network's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<Effect>,
}

/// A spec that no network can have.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SpecError {
    /// A number is out of its range.
    #[error("`{name}` is {found}; it must be {allowed}")]
    Range {
        /// The field.
        name: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// A block reads what it cannot.
    #[error("block `{block}` {problem}")]
    Block {
        /// Its name.
        block: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// The channels of a layer cannot be dealt out evenly to its groups.
    #[error(
        "layer `{layer}` has {groups} groups, which do not divide its {inputs} inputs and {outputs} outputs"
    )]
    Groups {
        /// Name of the layer.
        layer: String,
        /// Its number of groups.
        groups: usize,
        /// Channels read.
        inputs: usize,
        /// Channels made.
        outputs: usize,
    },
    /// The last block makes another number of channels than the head needs.
    #[error("the last block makes {found} channels; its head needs {needed}")]
    Last {
        /// Channels made.
        found: usize,
        /// Channels needed.
        needed: usize,
    },
    /// A head makes as many channels as it is given.
    #[error("the network's head works on {lights} channels of its input, and makes an image of {channels}")]
    Light {
        /// Channels that it works on.
        lights: usize,
        /// Channels that a run makes.
        channels: usize,
    },
}

impl AnalyticEstimate {
    /// That of a method of the network's effect at a quality.
    pub fn new(method: &str, quality: &str) -> Self {
        Self { method: method.to_owned(), quality: quality.to_owned(), effect: None }
    }

    /// The effect that it is a method of, for a network that computes this one.
    pub fn effect(&self, network: Effect) -> Effect {
        self.effect.unwrap_or(network)
    }

    /// The same of another effect's method of that name.
    #[must_use]
    pub fn of(self, effect: Effect) -> Self {
        Self { effect: Some(effect), ..self }
    }
}

impl NetSpec {
    /// The network that corrects what a method estimates of an effect, in the form of [`trunk`] with so many
    /// channels at half the resolution; none where no method does. Those of indirect light, of skies and of
    /// all light read openness beside the light that they correct: surfels of `gi` hide nothing, and the few
    /// directions of `do` miss much. Filters of light weigh that light itself beside the estimate.
    pub fn corrected(
        effect: Effect,
        channels: usize,
        estimates: Vec<AnalyticEstimate>,
        reach: Reach,
    ) -> Option<Self> {
        use Attribute::{
            Border, Diffuse, DiffuseLight, Estimate, FreePathPixels, Light, Movement, Normal, Openness,
            PixelRadius, RawOpenness, Relief, SignedCircle,
        };
        let local = [Normal, Relief, PixelRadius, Border];
        let filter = |of: &[Attribute]| [of, &[Light, Estimate]].concat();
        let (inputs, of, over, levels) = match effect {
            Effect::Ao => ([&local[..], &[Openness, RawOpenness]].concat(), Openness, RawOpenness, 2),
            Effect::Gi => ([&local[..], &[DiffuseLight, Estimate, Openness]].concat(), Estimate, Estimate, 2),
            Effect::Path => {
                ([&local[..], &[Light, Diffuse, Estimate, Openness]].concat(), Estimate, Estimate, 2)
            }
            Effect::Do | Effect::PhosphorGi => {
                ([&local[..], &[Estimate, Openness]].concat(), Estimate, Estimate, 2)
            }
            Effect::Dof => (filter(&[SignedCircle]), Estimate, Light, 3),
            Effect::Multi => (filter(&[Normal, Relief, PixelRadius, SignedCircle]), Estimate, Light, 3),
            Effect::MotionBlur => (filter(&[Movement, Relief]), Estimate, Light, 3),
            Effect::Sss => (filter(&[Normal, Relief, FreePathPixels]), Estimate, Light, 3),
            Effect::Aa => (filter(&[Normal, Relief]), Estimate, Light, 1),
            _ => return None,
        };
        // Where nothing moves the method's image is right: measured, the network's was not.
        let gated = effect == Effect::MotionBlur;
        let correction = Correction { of, over, levels, kernel: 3, gain: effect != Effect::Ao, gated };
        let spec = Self::correcting(effect, inputs, estimates, correction, channels, reach);
        // Light goes farther below a surface in one colour than in another.
        Some(if effect == Effect::Sss { Self { colour: Colour::Mono, ..spec } } else { spec })
    }

    /// A network of the form of [`trunk`], with so many channels at half the resolution, that corrects an
    /// estimate.
    pub fn correcting(
        effect: Effect,
        inputs: Vec<Attribute>,
        estimates: Vec<AnalyticEstimate>,
        correction: Correction,
        channels: usize,
        reach: Reach,
    ) -> Self {
        let mut spec = Self {
            effect,
            inputs,
            estimates,
            colour: Colour::Rgb,
            leak: 0.01,
            blocks: trunk::blocks(channels, 1),
            head: Head::Correction(correction),
            reach,
            trained: None,
            environment: None,
        };
        spec.blocks = trunk::blocks(channels, spec.last_channels());
        spec
    }

    /// Checks what a file or a recipe may get wrong, before anything is computed from it.
    ///
    /// # Errors
    /// If a number is out of its range, a block reads what is not there, a layer's groups do not divide its
    /// channels, or the last block does not make what the head needs.
    pub fn validate(&self) -> Result<(), SpecError> {
        let range = |name, fits: bool, found: &dyn std::fmt::Display, allowed| match fits {
            true => Ok(()),
            false => Err(SpecError::Range { name, found: found.to_string(), allowed }),
        };
        let reach = &self.reach;
        let positive = |value: f32| value.is_finite() && value > 0.0;
        range("inputs", (1..=64).contains(&self.inputs.len()), &self.inputs.len(), "1 to 64 attributes")?;
        let blocks = self.blocks.len();
        range("blocks", (2..=MOST_BLOCKS).contains(&blocks), &blocks, "2 to 64")?;
        range("estimates", self.estimates.len() <= 8, &self.estimates.len(), "at most 8")?;
        range("leak", (0.0..=1.0).contains(&self.leak), &self.leak, "0 to 1")?;
        range("reach.radius", positive(reach.radius), &reach.radius, "positive")?;
        range("reach.diagonal_share", positive(reach.diagonal_share), &reach.diagonal_share, "positive")?;
        range("reach.height", (1..=MOST_ROWS).contains(&reach.height), &reach.height, "1 to 8192")?;
        self.validate_blocks()?;
        self.validate_head()?;
        let (found, needed) = (self.blocks[blocks - 1].outputs, self.last_channels());
        if found == needed { Ok(()) } else { Err(SpecError::Last { found, needed }) }
    }

    /// Whether every block reads earlier ones, of levels that go together, in groups that divide its
    /// channels.
    fn validate_blocks(&self) -> Result<(), SpecError> {
        let range =
            |name, found: usize, allowed| SpecError::Range { name, found: found.to_string(), allowed };
        for (index, block) in self.blocks.iter().enumerate() {
            let wrong = |problem| SpecError::Block { block: block.name.clone(), problem };
            if !is_name(&block.name) {
                return Err(wrong("has a name that is not of up to 64 small letters, digits, - and _"));
            }
            if self.blocks[..index].iter().any(|other| other.name == block.name) {
                return Err(wrong("has no name of its own"));
            }
            if !matches!(block.kernel, 1 | 3 | 5 | 7) {
                return Err(range("kernel", block.kernel, "1, 3, 5 or 7"));
            }
            if !(1..=MOST_CHANNELS).contains(&block.outputs) {
                return Err(range("outputs", block.outputs, "1 to 16384"));
            }
            if !(1..=MOST_CHANNELS).contains(&block.groups) {
                return Err(range("groups", block.groups, "1 to 16384"));
            }
            if block.reads.blocks().any(|from| from >= index) {
                return Err(wrong("reads a block that comes after it"));
            }
            if index == 0 && !block.reads.is_input() {
                return Err(wrong("is the first and does not read the input"));
            }
            if index + 1 == self.blocks.len() && block.reads.is_input() {
                return Err(wrong("is the last and reads the input"));
            }
        }
        let layers = self.layers();
        for layer in &layers {
            let wrong = |problem| SpecError::Block { block: layer.name.clone(), problem };
            if layer.level > MOST_LEVEL {
                return Err(wrong("is on a level below the seventh"));
            }
            if let BlockSource::Pooled(from) = layer.source
                && matches!(layers[from].source, BlockSource::Joined { .. })
            {
                return Err(wrong("pools a block that joins two"));
            }
            let Layer { groups, inputs, outputs, .. } = *layer;
            let mut divides = inputs % groups == 0 && outputs % groups == 0;
            if let BlockSource::Joined { coarse, skip, groups } = layer.source {
                if layers[coarse].level != layers[skip].level + 1 {
                    return Err(wrong("joins blocks that are not one level apart"));
                }
                divides &= groups > 0
                    && layers[coarse].outputs.is_multiple_of(groups)
                    && layers[skip].outputs.is_multiple_of(groups);
            }
            if !divides {
                return Err(SpecError::Groups { layer: layer.name.clone(), groups, inputs, outputs });
            }
        }
        Ok(())
    }

    /// Number of channels that a run reads.
    pub fn input_channels(&self) -> usize {
        self.inputs.iter().map(|attribute| self.width(*attribute)).sum()
    }

    /// Number of channels of an attribute that a run reads.
    pub const fn width(&self, attribute: Attribute) -> usize {
        match (self.colour, attribute.kind()) {
            (Colour::Mono, AttributeKind::Colour) => 1,
            _ => attribute.width(),
        }
    }

    /// Number of channels that a run makes.
    pub const fn output_channels(&self) -> usize {
        match self.colour {
            Colour::Mono => 1,
            Colour::Rgb => self.effect.channels(),
        }
    }

    /// Number of channels that the last block makes: those of the head for each pixel of a square of its
    /// level.
    pub fn last_channels(&self) -> usize {
        self.head_channels() << (2 * self.last_level())
    }

    /// The level of the last block. Its channels are those of the pixels of a square, `1 << level` along an
    /// axis: channel `c` of the pixel `(x, y)` of the square is channel `((y << level) + x) C + c`, where the
    /// head works on `C`.
    pub fn last_level(&self) -> usize {
        self.layers().last().map_or(0, |layer| layer.level)
    }

    /// Number of runs that make the effect's image.
    pub const fn runs(&self) -> usize {
        self.effect.channels() / self.output_channels()
    }

    /// Number of levels, the finest and the coarsest counted.
    pub fn levels(&self) -> usize {
        self.layers().iter().map(|layer| layer.level + 1).max().unwrap_or(1)
    }

    /// The size that heights and widths are padded to a multiple of, so that every pooling is whole.
    pub fn alignment(&self) -> usize {
        1 << (self.levels() - 1)
    }

    /// The blocks with what follows from those that they read, in the order of computation.
    pub fn layers(&self) -> Vec<Layer> {
        Layer::of_blocks(&self.blocks, self.input_channels())
    }

    /// Number of weights and biases of all layers.
    pub fn weight_count(&self) -> usize {
        self.layers().iter().map(Layer::weight_count).sum()
    }
}

/// Whether a block may be called that: names go into file names and sources of shaders.
fn is_name(text: &str) -> bool {
    let known =
        |letter: u8| letter.is_ascii_lowercase() || letter.is_ascii_digit() || b"-_".contains(&letter);
    (1..=64).contains(&text.len()) && text.bytes().all(known)
}

#[cfg(test)]
mod tests;
