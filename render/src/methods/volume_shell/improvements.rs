//! What the method does in another way than the paper, each by itself, so that it can be measured.

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Improvement {
    /// Coefficients of three colours in place of their mean.
    Colours,
    /// The medium dims light on its way from a surfel to an interval.
    Attenuation,
    /// Only the intervals are visited that a shell touches.
    TouchedOnly,
    /// Light below the threshold is not left out: the coarsest level's shells have no end.
    FarLight,
    /// What is blurred is light over how much the ray scatters, so that a medium's edges and silhouettes
    /// before it stay sharp.
    Silhouettes,
    /// Distances of 16 bits, and the transmittance that an interval takes in place of density looked up at
    /// its end.
    WideEncoding,
}

/// Those that are in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Improvements(u32);

impl Improvement {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Colours,
        Self::Attenuation,
        Self::TouchedOnly,
        Self::FarLight,
        Self::Silhouettes,
        Self::WideEncoding,
    ];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Colours => "colours",
            Self::Attenuation => "attenuation",
            Self::TouchedOnly => "touched_only",
            Self::FarLight => "far_light",
            Self::Silhouettes => "silhouettes",
            Self::WideEncoding => "wide_encoding",
        }
    }
}

impl Improvements {
    /// As in the paper.
    pub const NONE: Self = Self(0);
    /// All of them, which is how the method runs but for studies.
    pub const ALL: Self = Self((1 << Improvement::ALL.len()) - 1);

    /// All but one of these.
    #[must_use]
    pub const fn without(self, improvement: Improvement) -> Self {
        Self(self.0 & !(1 << improvement as u32))
    }

    /// Whether one is in use.
    pub const fn has(self, improvement: Improvement) -> bool {
        self.0 >> improvement as u32 & 1 == 1
    }

    /// 1 where one is in use, as shaders have it.
    pub(super) const fn flag(self, improvement: Improvement) -> u32 {
        self.0 >> improvement as u32 & 1
    }
}
