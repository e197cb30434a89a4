//! Light in participating media.

use super::{Shader, uniforms};

table! {
    /// The transmittance interval map.
    VOLUME_SHELL_INTERVALS: "volume-shell.intervals", file "methods/volume_shell/intervals",
        constants [SAMPLES = 16], uniforms [Intervals, FrameView, MediumRecord],
        shared ["random", "bounded", "view", "medium", "transmittance"];
    /// Light that surfels scatter into the intervals of rays, of a level.
    VOLUME_SHELL_SPLAT: "volume-shell.splat", file "methods/volume_shell/splat",
        constants [SAMPLES = 16, HEIGHT = 8], uniforms [SplatLevel, VolumeShell, FrameView, MediumRecord],
        shared ["random", "bounded", "view", "packing", "interleaved", "surfel", "surfel_record", "surfel_tree",
                "surfel_walk", "surfel_facing", "surfel_sent", "medium", "phase", "transmittance"];
    /// A coarser level of a Gaussian pyramid.
    VOLUME_SHELL_REDUCE: "volume-shell.reduce", file "methods/volume_shell/reduce", constants [], uniforms [Pyramid],
        shared [];
    /// A coarser level of a Gaussian pyramid in the size of a finer one.
    VOLUME_SHELL_EXPAND: "volume-shell.expand", file "methods/volume_shell/expand", constants [], uniforms [Pyramid],
        shared [];
    /// The sum of all levels.
    VOLUME_SHELL_ADD: "volume-shell.add", file "methods/volume_shell/add", constants [], uniforms [LevelSum],
        shared [];
}
