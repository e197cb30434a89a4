//! The parts of a frame's work, in order, as they are recorded and timed.

/// A part of a frame's work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameStage {
    /// Vertices are moved.
    Pose,
    /// Depths are drawn from the lights.
    Shadows,
    /// The nearest surfaces are drawn.
    Surface,
    /// The g-buffer is written.
    Attributes,
    /// Direct light is gathered.
    Light,
}

impl FrameStage {
    /// All, in order.
    pub const ALL: [Self; 5] = [Self::Pose, Self::Shadows, Self::Surface, Self::Attributes, Self::Light];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose",
            Self::Shadows => "shadows",
            Self::Surface => "surface",
            Self::Attributes => "attributes",
            Self::Light => "light",
        }
    }
}
