//! The one list of effects. An effect is a quantity at a pixel; a method is one way to compute it.

use serde::{Deserialize, Serialize};

/// A quantity at a pixel that methods compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Ambient occlusion: the cosine-weighted share of directions of the upper hemisphere that nothing blocks within
    /// a radius; 1 is open (thesis 7.4).
    Ao,
}

impl Effect {
    /// Every effect.
    pub const ALL: [Self; 1] = [Self::Ao];

    /// Its name on the command line, in recipes and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ao => "ao",
        }
    }

    /// Number of channels of its image.
    pub const fn channels(self) -> usize {
        match self {
            Self::Ao => 1,
        }
    }

    /// Its value where no surface is seen; every method's image has it there.
    pub const fn background(self) -> f32 {
        match self {
            Self::Ao => 1.0,
        }
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Effect {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|effect| effect.name() == name).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|effect| effect.name()).collect();
            format!("no effect `{name}`; there are {}", known.join(", "))
        })
    }
}
