//! Light that surfaces keep.

use super::{Shader, uniforms};

table! {
    /// The tree over tiles.
    PHOSPHOR_FIT: "phosphor.fit", file "methods/phosphor/fit", constants [FAN = 8, LEAVES = 1],
        uniforms [GlowLevel, GlowTile], shared ["glow_corners"];
    /// The tile of each pixel.
    PHOSPHOR_FIND: "phosphor.find", file "methods/phosphor/find", constants [FAN = 8, LEVELS = 1, TILES = 1],
        uniforms [FrameView, GlowTile], shared ["view", "glow_corners"];
    /// States after a stretch of time.
    PHOSPHOR_STEP: "phosphor.step", file "methods/phosphor/step",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, STATES = 1, PAINT_STATES = 1],
        uniforms [PaintState, GlowTile, FrameView, LightRecord],
        shared ["view", "lights", "shadow", "glow_tile", "glow_corners", "glow_place", "glow_time"];
    /// What states give back at each pixel.
    PHOSPHOR_SHOW: "phosphor.show", file "methods/phosphor/show", constants [STATES = 1, PAINT_STATES = 1],
        uniforms [PaintState, GlowTile], shared ["glow_tile"];
    /// The same as an integral over the past.
    PHOSPHOR_GLASSNER: "phosphor.glassner", file "methods/phosphor/glassner",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, STATES = 1, PAINT_STATES = 1],
        uniforms [GlowSamples, PaintState, GlowTile, FrameView, LightRecord],
        shared ["random", "bounded", "view", "lights", "shadow", "glow_corners", "glow_place", "glow_time"];
}
