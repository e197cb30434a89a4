//! The shape of a network: one list of layers that drives burn's module, the WGSL passes, the ONNX writer and the
//! reference forward pass.
//!
//! The network is the U-net of the thesis (7.3.2): on the way down, level l has `u0 * 2^l` kernels in `2^l` groups, a
//! leaky ReLU and 2x2 mean pooling; on the way up, the coarser level is doubled bilinearly, joined with the same
//! level's way down, and convolved. The step upwards on level 0 makes the image itself, without an activation: with
//! it ambient occlusion has 71,089 weights, Table 7.1's 71 k. On a single level that step reads the way down alone.

use crate::{Filter, Reach};
use deepshade_shaders::{Attribute, AttributeKind, Effect};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Order of the channels after a concatenation, which decides what each group of the next convolution sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChannelOrder {
    /// All of the coarser level, then all of the skip connection, as in the paper's framework: the first groups see
    /// the coarser level only, the last ones the skip only.
    Contiguous,
    /// Group by group: a share of the coarser level, then the same share of the skip, so that every group sees both.
    Interleaved,
}

/// Which colour channels one run of a network makes (thesis 7.3.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colour {
    /// One: the network is trained on single channels, and runs once for each that the effect has. Of colours it
    /// reads the same channel.
    #[default]
    Mono,
    /// All of the effect's at once.
    Rgb,
}

/// Groups of the last convolution where a file of earlier versions does not say.
const fn one() -> usize {
    1
}

/// Most rows of the frames that a network is trained on.
const MOST_ROWS: usize = 8192;

/// A network, but for its weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetSpec {
    /// What the network computes.
    pub effect: Effect,
    /// What it reads, in this order.
    pub inputs: Vec<Attribute>,
    /// Number of kernels on level 0.
    pub u0: usize,
    /// Number of levels; 1 is no U at all.
    pub levels: usize,
    /// Width and height of every kernel; odd.
    pub kernel: usize,
    /// Factor of negative values in the leaky ReLU.
    pub leak: f32,
    /// Which colour channels a run makes.
    #[serde(default)]
    pub colour: Colour,
    /// Groups of the last convolution.
    #[serde(default = "one")]
    pub image_groups: usize,
    /// Where the last convolution makes the weights of a filter of the light that the network reads, in place of the
    /// image as in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter: Option<Filter>,
    /// Order of the channels after a concatenation.
    pub channel_order: ChannelOrder,
    /// What it was trained to reach.
    pub reach: Reach,
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
    /// A filter makes as many channels as it is given.
    #[error("the network filters {lights} channels of light, and makes an image of {channels}")]
    Light {
        /// Channels of light that a run reads.
        lights: usize,
        /// Channels that a run makes.
        channels: usize,
    },
}

/// Where a layer reads from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The network's input.
    Input,
    /// The layer of that index, as it is: in a network of one level.
    Plain(usize),
    /// The layer of that index, 2x2 mean pooled.
    Pooled(usize),
    /// The coarser layer, doubled bilinearly, joined with the skip connection's layer.
    Joined {
        /// Index of the layer one level below.
        coarse: usize,
        /// Index of the same level's layer on the way down.
        skip: usize,
    },
}

/// A convolution with what comes before and after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// `down0`, `down1`, ..., `up1`, `up0`: the name in files and messages.
    pub name: String,
    /// 0 is full resolution; each further level halves it.
    pub level: usize,
    /// Where it reads from.
    pub source: Source,
    /// Channels read.
    pub inputs: usize,
    /// Channels made.
    pub outputs: usize,
    /// Groups of the convolution; the weights are `[outputs, inputs / groups, kernel, kernel]`.
    pub groups: usize,
    /// Whether a leaky ReLU follows.
    pub activation: bool,
}

impl Layer {
    /// Number of weights and biases.
    pub const fn weight_count(&self, kernel: usize) -> usize {
        self.outputs * (self.inputs / self.groups) * kernel * kernel + self.outputs
    }

    /// Shape of the weights, `[outputs, inputs / groups, kernel, kernel]`.
    pub const fn weight_shape(&self, kernel: usize) -> [usize; 4] {
        [self.outputs, self.inputs / self.groups, kernel, kernel]
    }
}

impl NetSpec {
    /// The paper's network for an effect (Table 7.1); none where the paper has none.
    pub fn published(effect: Effect, channel_order: ChannelOrder, reach: Reach) -> Option<Self> {
        use Attribute::{
            Blurriness, Depth, Diffuse, DiffuseLight, Glossiness, Light, MeanFreePath, Motion, Normal,
            Position, Specular, ToCamera, WorldNormal,
        };
        let (inputs, u0, levels, kernel, colour): (&[Attribute], _, _, _, _) = match effect {
            Effect::Ao => (&[Normal, Position], 8, 6, 3, Colour::Mono),
            Effect::Gi => (&[Normal, Position, DiffuseLight], 16, 5, 3, Colour::Mono),
            Effect::Dof => (&[Blurriness, Depth, Light], 16, 5, 3, Colour::Mono),
            Effect::MotionBlur => (&[Motion, Light, Depth], 16, 5, 3, Colour::Mono),
            Effect::Sss => (&[Position, MeanFreePath, Light], 16, 5, 3, Colour::Mono),
            Effect::Aa => (&[Depth, Light], 8, 1, 5, Colour::Mono),
            Effect::Multi => (&[Normal, Position, Blurriness, Depth, Light], 16, 5, 3, Colour::Rgb),
            Effect::Ibl => (&[WorldNormal, ToCamera, Diffuse, Specular, Glossiness], 300, 1, 1, Colour::Rgb),
            Effect::Do => (&[WorldNormal, Normal, Position], 16, 5, 3, Colour::Rgb),
            Effect::Real => (&[Normal], 16, 5, 5, Colour::Rgb),
            Effect::Glossy
            | Effect::Subsurface
            | Effect::FogDirect
            | Effect::FogIndirect
            | Effect::FogMultiple
            | Effect::Phosphor
            | Effect::PhosphorGi
            | Effect::Path => return None,
        };
        let image_groups = if effect == Effect::Ibl { 3 } else { 1 };
        let inputs = inputs.to_vec();
        Some(Self {
            effect,
            inputs,
            u0,
            levels,
            kernel,
            leak: 0.01,
            colour,
            image_groups,
            filter: None,
            channel_order,
            reach,
        })
    }

    /// The paper's network for ambient occlusion.
    pub fn ao(channel_order: ChannelOrder, reach: Reach) -> Self {
        Self::published(Effect::Ao, channel_order, reach).expect("it has one")
    }

    /// Checks what a file or a recipe may get wrong, before anything is computed from it.
    ///
    /// # Errors
    /// If a number is out of its range, or a layer's groups do not divide its channels.
    pub fn validate(&self) -> Result<(), SpecError> {
        let range = |name, fits: bool, found: &dyn std::fmt::Display, allowed| match fits {
            true => Ok(()),
            false => Err(SpecError::Range { name, found: found.to_string(), allowed }),
        };
        let reach = &self.reach;
        let positive = |value: f32| value.is_finite() && value > 0.0;
        range("inputs", (1..=64).contains(&self.inputs.len()), &self.inputs.len(), "1 to 64 attributes")?;
        range("u0", (1..=512).contains(&self.u0), &self.u0, "1 to 512")?;
        range("levels", (1..=8).contains(&self.levels), &self.levels, "1 to 8")?;
        range("kernel", matches!(self.kernel, 1 | 3 | 5 | 7), &self.kernel, "1, 3, 5 or 7")?;
        range("image_groups", (1..=64).contains(&self.image_groups), &self.image_groups, "1 to 64")?;
        range("leak", (0.0..=1.0).contains(&self.leak), &self.leak, "0 to 1")?;
        range("reach.radius", positive(reach.radius), &reach.radius, "positive")?;
        range("reach.diagonal_share", positive(reach.diagonal_share), &reach.diagonal_share, "positive")?;
        range("reach.height", (1..=MOST_ROWS).contains(&reach.height), &reach.height, "1 to 8192")?;
        self.validate_filter()?;
        for Layer { name: layer, level, groups, inputs, outputs, source, .. } in self.layers() {
            let joins_evenly =
                !matches!(source, Source::Joined { .. }) || (self.u0 << level).is_multiple_of(groups);
            if inputs % groups != 0 || outputs % groups != 0 || !joins_evenly {
                return Err(SpecError::Groups { layer, groups, inputs, outputs });
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

    /// Number of channels that the last convolution makes: the image's, or the filter's weights.
    pub fn last_channels(&self) -> usize {
        self.filter.map_or(self.output_channels(), |filter| filter.weight_count())
    }

    /// Number of runs that make the effect's image.
    pub const fn runs(&self) -> usize {
        self.effect.channels() / self.output_channels()
    }

    /// The size that heights and widths are padded to a multiple of, so that every pooling is whole.
    pub const fn alignment(&self) -> usize {
        1 << (self.levels - 1)
    }

    /// All layers in the order of computation: down, then up.
    pub fn layers(&self) -> Vec<Layer> {
        let width = |level: usize| self.u0 << level;
        let mut layers = Vec::new();
        for level in 0..self.levels {
            let first = level == 0;
            layers.push(Layer {
                name: format!("down{level}"),
                level,
                source: if first { Source::Input } else { Source::Pooled(level - 1) },
                inputs: if first { self.input_channels() } else { width(level - 1) },
                outputs: width(level),
                groups: 1 << level,
                activation: true,
            });
        }
        for level in (1..self.levels - 1).rev() {
            let coarse = layers.len() - 1;
            layers.push(Layer {
                name: format!("up{level}"),
                level,
                source: Source::Joined { coarse, skip: level },
                inputs: width(level + 1) + width(level),
                outputs: width(level),
                groups: 1 << level,
                activation: true,
            });
        }
        let coarse = layers.len() - 1;
        let alone = self.levels == 1;
        layers.push(Layer {
            name: "up0".to_owned(),
            level: 0,
            source: if alone { Source::Plain(coarse) } else { Source::Joined { coarse, skip: 0 } },
            inputs: if alone { width(0) } else { width(1) + width(0) },
            outputs: self.last_channels(),
            groups: self.image_groups,
            activation: false,
        });
        layers
    }

    /// Number of weights and biases of all layers.
    pub fn weight_count(&self) -> usize {
        self.layers().iter().map(|layer| layer.weight_count(self.kernel)).sum()
    }

    /// For each channel that a [`Source::Joined`] layer's convolution reads, in order: which channel of the plain
    /// concatenation (coarse, then skip) it is.
    pub fn joined_order(&self, coarse: usize, skip: usize, groups: usize) -> Vec<usize> {
        joined_order(coarse, skip, self.join_groups(groups))
    }

    /// The groups in which a concatenation goes that a convolution in `groups` reads.
    pub const fn join_groups(&self, groups: usize) -> usize {
        match self.channel_order {
            ChannelOrder::Contiguous => 1,
            ChannelOrder::Interleaved => groups,
        }
    }
}

/// For each channel of two images concatenated group by group: which channel of the plain concatenation it is.
pub fn joined_order(coarse: usize, skip: usize, groups: usize) -> Vec<usize> {
    let (a, b) = (coarse / groups, skip / groups);
    let group = |group| (group * a..(group + 1) * a).chain(coarse + group * b..coarse + (group + 1) * b);
    (0..groups).flat_map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn networks_have_the_papers_numbers_of_weights() {
        // Table 7.1 says 71 k, 134 k, 133 k, 133 k, 133 k, 135 k, 135 k, 370 k; for aa it says 1.2 k and for ibl
        // 3.9 k, which what the text says of them does not give.
        let weights = [
            (Effect::Ao, 71_089),
            (Effect::Gi, 133_489),
            (Effect::Dof, 132_913),
            (Effect::MotionBlur, 133_057),
            (Effect::Sss, 133_201),
            (Effect::Aa, 609),
            (Effect::Multi, 134_931),
            (Effect::Ibl, 4_503),
            (Effect::Do, 134_643),
            (Effect::Real, 370_323),
        ];
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            for (effect, weights) in weights {
                let spec = NetSpec::published(effect, order, REACH).expect("the paper has one");
                assert_eq!((effect, spec.weight_count(), spec.validate()), (effect, weights, Ok(())));
            }
        }
        assert_eq!(NetSpec::published(Effect::Path, ChannelOrder::Contiguous, REACH), None);
    }

    #[test]
    fn a_mono_network_runs_once_a_colour_channel() {
        let spec = |effect| NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("has one");
        let channels = |spec: NetSpec| (spec.input_channels(), spec.output_channels(), spec.runs());
        assert_eq!(channels(spec(Effect::Ao)), (6, 1, 1));
        assert_eq!(channels(spec(Effect::Sss)), (5, 1, 3));
        assert_eq!(channels(spec(Effect::Multi)), (11, 3, 1));
    }

    #[test]
    fn a_network_of_one_level_makes_the_image_of_its_way_down() {
        let aa = NetSpec::published(Effect::Aa, ChannelOrder::Interleaved, REACH).expect("has one");
        let layers: Vec<_> =
            aa.layers().into_iter().map(|l| (l.source, l.inputs, l.outputs, l.activation)).collect();
        assert_eq!(layers, [(Source::Input, 2, 8, true), (Source::Plain(0), 8, 1, false)]);
    }

    #[test]
    fn the_last_layer_makes_the_image() {
        let layers = NetSpec::ao(ChannelOrder::Contiguous, REACH).layers();
        let last = &layers[10];
        assert_eq!(layers.len(), 11);
        assert_eq!((last.inputs, last.outputs, last.activation), (24, 1, false));
        assert_eq!(last.source, Source::Joined { coarse: 9, skip: 0 });
    }

    #[test]
    fn interleaving_gives_every_group_both_sources() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        assert_eq!(spec.joined_order(4, 2, 2), vec![0, 1, 4, 2, 3, 5]);
        let contiguous = NetSpec::ao(ChannelOrder::Contiguous, REACH);
        assert_eq!(contiguous.joined_order(4, 2, 2), vec![0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn the_papers_network_is_valid_and_absurd_ones_are_named() {
        let ao = NetSpec::ao(ChannelOrder::Contiguous, REACH);
        assert_eq!(ao.validate(), Ok(()));
        let absurd = [
            (NetSpec { levels: 0, ..ao.clone() }, "`levels` is 0"),
            (NetSpec { levels: 60, ..ao.clone() }, "`levels` is 60"),
            (NetSpec { u0: usize::MAX, ..ao.clone() }, "`u0` is"),
            (NetSpec { kernel: 4, ..ao.clone() }, "`kernel` is 4"),
            (NetSpec { image_groups: 0, ..ao.clone() }, "`image_groups` is 0"),
            (NetSpec { image_groups: 5, ..ao.clone() }, "layer `up0` has 5 groups"),
            (NetSpec { leak: f32::NAN, ..ao.clone() }, "`leak` is NaN"),
            (NetSpec { inputs: Vec::new(), ..ao.clone() }, "`inputs` is 0"),
            (NetSpec { reach: Reach { radius: 0.0, ..REACH }, ..ao.clone() }, "`reach.radius` is 0"),
            (NetSpec { reach: Reach { height: 0, ..REACH }, ..ao.clone() }, "`reach.height` is 0"),
            (NetSpec { reach: Reach { height: 1 << 40, ..REACH }, ..ao.clone() }, "`reach.height` is 1099"),
            (NetSpec { u0: 5, ..ao }, "layer `down1` has 2 groups"),
        ];
        for (spec, message) in absurd {
            let error = spec.validate().expect_err(message).to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
