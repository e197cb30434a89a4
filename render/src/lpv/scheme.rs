//! How propagation may be done: as here, or, to be compared with it, as in Billeter, Sintorn and Assarsson
//! 2012.

use super::flight::Factors;
use super::lobe::Lobes;

/// Which cells light a surface.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Lookup {
    /// The eight around a point half a cell before it, but for those behind it: what is behind a wall does
    /// not light it.
    #[default]
    Before,
    /// The one that it is in, as the paper's section 4.3 has it.
    Within,
}

/// What can be done in two ways or more.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
pub struct Scheme {
    /// How collisions with the medium are counted: where they happen, or, as Billeter et al. 2012 have it, in
    /// the cell that light leaves.
    pub factors: Factors,
    /// How light in a cell is spread over directions: as the square of a function of two bands, or, as
    /// Billeter et al. 2012 have it, in two bands, which may be negative.
    pub lobes: Lobes,
    /// Which cells light a surface: those before it, or, as Billeter et al. 2012 have it, the one that it is
    /// within.
    pub lookup: Lookup,
}

impl Scheme {
    /// As here.
    pub const OURS: Self = Self { factors: Factors::Placed, lobes: Lobes::Squared, lookup: Lookup::Before };
    /// As in the paper: equation (3), two bands, a surface lit by the cell that it is in.
    pub const PAPER: Self = Self { factors: Factors::Linear, lobes: Lobes::TwoBands, lookup: Lookup::Within };

    /// As the passes have it.
    pub const fn constants(self) -> [(&'static str, u32); 2] {
        [("FACTORS", self.factors as u32), self.lobes_constant()]
    }

    /// How light is spread over directions, as the passes have it.
    pub const fn lobes_constant(self) -> (&'static str, u32) {
        ("LOBES", self.lobes as u32)
    }

    /// Which cells light a surface, as the passes have it.
    pub const fn lookup_constant(self) -> (&'static str, u32) {
        ("LOOKUP", self.lookup as u32)
    }
}
