//! Light in participating media.

use super::{Shader, uniforms};

table! {
    /// The transmittance interval map.
    VOLUME_SHELL_INTERVALS: "volume-shell.intervals", file "methods/volume_shell/intervals",
        constants [SAMPLES = 16], uniforms [Intervals, FrameView, MediumRecord],
        shared ["random", "bounded", "view", "medium", "transmittance"];
}
