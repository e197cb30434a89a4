//! Light propagation volumes.

use super::{Shader, uniforms};

table! {
    /// Sums of the frame before are forgotten.
    LPV_CLEAR: "lpv.clear", file "methods/lpv/clear", constants [], uniforms [], shared [];
    /// Surfels as light and as blockers.
    LPV_INJECT: "lpv.inject", file "methods/lpv/inject", constants [HEIGHT = 8], uniforms [LightGrid, FrameView],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_patch_record", "surfel_order",
                "lpv_grid", "lpv_send"];
    /// Light that surfels emit.
    LPV_SHINE: "lpv.shine", file "methods/lpv/shine", constants [HEIGHT = 8], uniforms [LightGrid, FrameView],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_order", "lpv_grid", "lpv_send",
                "lpv_emits"];
    /// Light that surfels give back of what they kept.
    LPV_SHINE_KEPT: "lpv.shine_kept", file "methods/lpv/shine", constants [HEIGHT = 8, UNIT = 128],
        uniforms [LightGrid, FrameView],
        shared ["view", "packing", "surfel", "surfel_record", "lpv_grid", "lpv_send", "lpv_gives_back"];
    /// Light that a medium gives back of what it kept.
    LPV_SHINE_MEDIUM: "lpv.shine_medium", file "methods/lpv/shine_medium",
        constants [STATES = 1, PAINT_STATES = 1, PAINT = 0, MEDIUM = 2],
        uniforms [LightGrid, PaintState, GlowCells, MediumRecord],
        shared ["lpv_grid", "lpv_send", "medium_span", "medium", "lpv_part", "glow_cells"];
    /// Light that surfels reflect of it.
    LPV_REFLECT: "lpv.reflect", file "methods/lpv/reflect", constants [HEIGHT = 8, LOOKUP = 0, NESTED = 1],
        uniforms [LightGrid, FrameView],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_patch_record", "surfel_order",
                "lpv_grid", "lpv_irradiance", "lpv_send"];
    /// What passes between cells.
    LPV_LINKS: "lpv.links", file "methods/lpv/links", constants [], uniforms [LightGrid],
        shared ["lpv_grid", "lpv_fixed", "lpv_lattice"];
    /// What the medium in cells does to light.
    LPV_MEDIA: "lpv.media", file "methods/lpv/media", constants [MEDIUM = 2, FACTORS = 0, LOBES = 0, SIMILAR = 1],
        uniforms [LightGrid, MediumRecord],
        shared ["lpv_grid", "lpv_lattice", "lpv_lobe", "lpv_flight", "medium_span", "medium", "lpv_medium", "lpv_part"];
    /// Light that surfaces send.
    LPV_FRESH: "lpv.fresh", file "methods/lpv/fresh",
        constants [UNSCATTERED = 2, SCATTERED = 1, STEADY = 1, FACTORS = 0, LOBES = 0, FIRST = 1, SIMILAR = 1],
        uniforms [LightGrid, MediumRecord],
        shared ["lpv_grid", "lpv_kinds", "lpv_lattice", "lpv_fixed", "lpv_lobe", "lpv_second", "lpv_flight", "lpv_medium"];
    /// Light of the lamps that the medium in cells scatters.
    LPV_BEGIN: "lpv.begin", file "methods/lpv/begin",
        constants [LIGHTS = 1, MEDIUM = 2, GREY = 0, UNSCATTERED = 2, SCATTERED = 1, FACTORS = 0, LOBES = 0, SIMILAR = 1],
        uniforms [LightGrid, FrameView, LightRecord, MediumRecord],
        shared ["lpv_grid", "lpv_kinds", "lpv_lattice", "lpv_lobe", "lpv_second", "lpv_flight", "view", "lights", "shadow",
                "medium_span", "medium", "colours", "light_dimmed", "lpv_medium", "lpv_lamps_only",
                "lpv_reflectance", "lpv_part"];
    /// Light of the lamps and of surfaces that the medium in cells scatters.
    LPV_BEGIN_EMITTED: "lpv.begin_emitted", file "methods/lpv/begin",
        constants [LIGHTS = 1, MEDIUM = 2, GREY = 0, UNSCATTERED = 2, SCATTERED = 1, FACTORS = 0, LOBES = 0, SIMILAR = 1],
        uniforms [LightGrid, FrameView, LightRecord, MediumRecord],
        shared ["lpv_grid", "lpv_kinds", "lpv_lattice", "lpv_lobe", "lpv_second", "lpv_flight", "view", "lights", "shadow",
                "medium_span", "medium", "colours", "light_dimmed", "lpv_medium", "lpv_emitted",
                "lpv_reflectance", "lpv_part"];
    /// One iteration.
    LPV_PROPAGATE: "lpv.propagate", file "methods/lpv/propagate",
        constants [UNSCATTERED = 2, SCATTERED = 1, STEADY = 1, SHOWS = 1, FACTORS = 0, LOBES = 0, BORDERS = 1, FIRST = 1,
                   NESTED = 1, SIMILAR = 1],
        uniforms [LightGrid, MediumRecord, Iteration, Propagation],
        shared ["lpv_grid", "lpv_kinds", "lpv_lattice", "lpv_lobe", "lpv_second", "lpv_flight", "lpv_medium",
                "lpv_reflectance"];
    /// Where a finer grid lies.
    LPV_NEST: "lpv.nest", file "methods/lpv/nest", constants [], uniforms [LightGrid, FrameView], shared [];
    /// Light that a coarser grid hands to it.
    LPV_BORDER: "lpv.border", file "methods/lpv/border",
        constants [UNSCATTERED = 2, SCATTERED = 1, STEADY = 1, FACTORS = 0, LOBES = 0, SIMILAR = 1],
        uniforms [LightGrid, MediumRecord],
        shared ["lpv_grid", "lpv_kinds", "lpv_lattice", "lpv_lobe", "lpv_second", "lpv_flight", "lpv_medium"];
    /// Surfaces lit by the grid.
    LPV_LIT: "lpv.lit", file "methods/lpv/lit", constants [LOOKUP = 0, NESTED = 1, FINER = 1],
        uniforms [LightGrid, FrameView],
        shared ["surface", "surface_valid", "view", "lpv_grid", "lpv_nested", "lpv_irradiance"];
    /// The medium, lit by the grid, in an image of fewer pixels.
    LPV_MARCH: "lpv.march", file "methods/lpv/march", constants [MEDIUM = 2, SCALE = 1, LOOKUP = 0, NESTED = 1, FINER = 1],
        uniforms [LightGrid, Marching, FrameView, MediumRecord],
        shared ["surface_distance", "random", "bounded", "view", "medium_span", "medium", "mean_decay", "lpv_grid",
                "lpv_nested", "lpv_irradiance"];
    /// The medium in front of each pixel and the surface behind it.
    LPV_APPLY: "lpv.apply", file "methods/lpv/apply",
        constants [MEDIUM = 2, SCALE = 1, LOOKUP = 0, SCATTERS = 1, LIT = 1, SCATTERED = 1, NESTED = 1, FINER = 1],
        uniforms [LightGrid, Marching, FrameView, MediumRecord],
        shared ["surface", "surface_valid", "view", "medium_span", "medium", "lpv_grid", "lpv_nested",
                "lpv_irradiance"];
}
