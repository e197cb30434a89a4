//! A line of the file that the tests write what they compare into: a flat JSON object.

use serde::{Deserialize, Serialize};

/// A measured value beside what it should be, or, for a control, beside what it must not be.
#[derive(Serialize, Deserialize)]
pub struct Comparison {
    /// Of the proof.
    pub name: String,
    pub value: f64,
    pub expected: f64,
    /// None of a probability or a ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Whether the value is what it is compared with.
    pub within: bool,
    /// Whether it must not be.
    pub control: bool,
}

impl Comparison {
    /// Whether it came out as it must.
    pub const fn holds(&self) -> bool {
        self.within != self.control
    }

    /// In standard errors.
    pub fn deviation(&self) -> Option<f64> {
        self.standard_error.map(|error| (self.value - self.expected) / error)
    }

    /// The effect whose error's slope it is.
    pub fn slope_of(&self) -> Option<&str> {
        self.name.strip_prefix("slope/")
    }
}
