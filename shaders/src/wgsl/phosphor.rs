//! Light that surfaces keep.

use super::{Shader, uniforms};

table! {
    /// The tree over tiles.
    PHOSPHOR_FIT: "phosphor.fit", file "methods/phosphor/fit", constants [FAN = 8, LEAVES = 1],
        uniforms [GlowLevel, GlowTile], shared ["glow_tile", "glow_corners"];
    /// The tile of each pixel.
    PHOSPHOR_FIND: "phosphor.find", file "methods/phosphor/find", constants [FAN = 8, LEVELS = 1, TILES = 1],
        uniforms [FrameView, GlowTile], shared ["view", "glow_tile", "glow_corners"];
    /// States after a stretch of time.
    PHOSPHOR_STEP: "phosphor.step", file "methods/phosphor/step",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, FIRST_PIECE = 0, PIECES_AT_ONCE = 1, STATES = 1,
            PAINT_STATES = 1, EULER = 0],
        uniforms [PaintState, GlowTile, FrameView, LightRecord],
        shared ["view", "lights", "shadow", "light_clear", "glow_tile", "glow_corners", "glow_place", "glow_time", "glow_change"];
    /// The same where the medium dims the lamps' light.
    PHOSPHOR_STEP_DIMMED: "phosphor.step_dimmed", file "methods/phosphor/step",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, FIRST_PIECE = 0, PIECES_AT_ONCE = 1, STATES = 1,
            PAINT_STATES = 1, EULER = 0, MEDIUM = 2, GREY = 0],
        uniforms [PaintState, GlowTile, FrameView, LightRecord, MediumRecord],
        shared ["view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "glow_tile",
                "glow_corners", "glow_place", "glow_time", "glow_change"];
    /// States of a medium's cells after a stretch of time.
    PHOSPHOR_CELLS: "phosphor.cells", file "methods/phosphor/cells",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, FIRST_PIECE = 0, PIECES_AT_ONCE = 1, STATES = 1,
            PAINT_STATES = 1, EULER = 0, PAINT = 0, MEDIUM = 2, GREY = 0],
        uniforms [PaintState, GlowCells, FrameView, LightRecord, MediumRecord],
        shared ["view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "glow_time", "glow_change"];
    /// What they give back at each pixel.
    PHOSPHOR_SHINE: "phosphor.shine", file "methods/phosphor/shine",
        constants [STATES = 1, PAINT_STATES = 1, PAINT = 0, MEDIUM = 2],
        uniforms [PaintState, GlowCells, FrameView, MediumRecord],
        shared ["surface_distance", "view", "medium_span", "medium", "mean_decay", "glow_cells"];
    /// What states give back at each pixel.
    PHOSPHOR_SHOW: "phosphor.show", file "methods/phosphor/show", constants [STATES = 1, PAINT_STATES = 1],
        uniforms [PaintState, GlowTile], shared ["glow_tile"];
    /// The same as an integral over the past.
    PHOSPHOR_GLASSNER: "phosphor.glassner", file "methods/phosphor/glassner",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, STATES = 1, PAINT_STATES = 1],
        uniforms [GlowSamples, GlowStretch, PaintState, GlowTile, FrameView, LightRecord],
        shared ["random", "bounded", "view", "lights", "shadow", "light_clear", "glow_tile", "glow_corners", "glow_place",
                "glow_time"];
    /// The same where the medium dims the lamps' light.
    PHOSPHOR_GLASSNER_DIMMED: "phosphor.glassner_dimmed", file "methods/phosphor/glassner",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, STATES = 1, PAINT_STATES = 1, MEDIUM = 2, GREY = 0],
        uniforms [GlowSamples, GlowStretch, PaintState, GlowTile, FrameView, LightRecord, MediumRecord],
        shared ["random", "bounded", "view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed",
                "glow_tile", "glow_corners", "glow_place", "glow_time"];
}
