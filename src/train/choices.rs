//! What the options of `deepshade train` may be.

use anyhow::{Context, Result};
use clap::ValueEnum;
use deepshade_infer::{ChannelOrder, NetSpec};
use deepshade_shaders::Effect;
use deepshade_train::{Loss, Optimiser};

/// Order of the channels after a concatenation.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Order {
    /// Every group sees both sources.
    Interleaved,
    /// As in the paper's framework: most groups see one source.
    Contiguous,
}

impl From<Order> for ChannelOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::Interleaved => Self::Interleaved,
            Order::Contiguous => Self::Contiguous,
        }
    }
}

/// The weight decay of networks that predict kernels.
pub const KERNELS_DECAY: f64 = 0.05;

/// What the last layer makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LastLayer {
    /// The image, as in the paper.
    Image,
    /// Weights of the light, which the image is the sum of: of 3x3 pixels at several resolutions, for aa 5x5
    /// at one, for multi of black too, for sss of each colour by itself.
    Kernels,
}

impl LastLayer {
    /// What came nearer to truth in equal steps. For anti-aliasing kernels do, too, but by little, with ten
    /// times the weights.
    pub const fn best(effect: Effect) -> Self {
        match effect.definition().filters_light && !matches!(effect, Effect::Aa) {
            true => Self::Kernels,
            false => Self::Image,
        }
    }

    /// The weight decay that it wants, if not the usual one. Without more of it what it makes grows until
    /// what half floats round away, which goes into exponents, shows.
    pub const fn weight_decay(self) -> Option<f64> {
        match self {
            Self::Image => None,
            Self::Kernels => Some(KERNELS_DECAY),
        }
    }

    /// The paper's network with that last layer.
    pub fn of(self, paper: NetSpec) -> Result<NetSpec> {
        match self {
            Self::Image => Ok(paper),
            Self::Kernels => paper.predicting_kernels().with_context(|| {
                format!("--last kernels: the network for `{}` reads no light", paper.effect)
            }),
        }
    }
}

/// What is made small.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum LossName {
    /// Structural dissimilarity, the paper's.
    Dssim,
    /// Dissimilarity plus mean squared difference.
    DssimL2,
    /// That plus the mean absolute difference of the means of 8x8 pixels.
    DssimL2Means,
}

impl From<LossName> for Loss {
    fn from(name: LossName) -> Self {
        match name {
            LossName::Dssim => Self::Dssim,
            LossName::DssimL2 => Self::DssimL2,
            LossName::DssimL2Means => Self::DssimL2Means,
        }
    }
}

/// How weights follow gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    #[value(help = format!("The practical default: {}", Optimiser::ADAMW))]
    Adamw,
    #[value(help = format!("As in the paper: {}", Optimiser::ADADELTA))]
    Adadelta,
}

impl Method {
    pub const fn defaults(self) -> Optimiser {
        match self {
            Self::Adamw => Optimiser::ADAMW,
            Self::Adadelta => Optimiser::ADADELTA,
        }
    }
}
