//! Surfels: making them, and shading by them.

use super::{Shader, uniforms};

table! {
    /// Where vertices are in camera space.
    SURFELS_VERTICES: "surfels.vertices", file "surfels/vertices", constants [], uniforms [FrameView], shared ["view"];
    /// How many surfels each patch gets.
    SURFELS_MEASURE: "surfels.measure", file "surfels/measure", constants [HEIGHT = 8], uniforms [Surfels, FrameView],
        shared ["surfel", "surfel_patch_record", "patch_corners", "surfel_patch"];
    /// Sums of 64 numbers each.
    SURFELS_SUM: "surfels.sum", file "surfels/sum", constants [], uniforms [], shared [];
    /// Where each of a few sums begins, and how many surfels there are.
    SURFELS_TOTAL: "surfels.total", file "surfels/total", constants [HEIGHT = 8], uniforms [], shared ["surfel"];
    /// Where each of 64 begins.
    SURFELS_BEGIN: "surfels.begin", file "surfels/begin", constants [], uniforms [], shared [];
    /// Where surfels are.
    SURFELS_PLACE: "surfels.place", file "surfels/place", constants [HEIGHT = 8], uniforms [Surfels],
        shared ["random", "packing", "surfel", "surfel_record", "surfel_patch_record", "patch_corners", "surfel_patch",
                "surfel_order"];
    /// The lowest nodes of the tree, of surfels that reach as far as they are large.
    SURFELS_LEAVES: "surfels.leaves", file "surfels/leaves", constants [HEIGHT = 8], uniforms [],
        shared ["packing", "surfel", "surfel_record", "surfel_tree", "surfel_reach_by_radius"];
    /// The nodes above.
    SURFELS_PARENTS: "surfels.parents", file "surfels/parents", constants [HEIGHT = 8], uniforms [TreeLevel],
        shared ["surfel", "surfel_tree"];
    /// Ambient occlusion of a level.
    SURFEL_OCCLUSION: "surfel.occlusion", file "methods/surfel/splat",
        constants [CHANNELS = 1, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "surface_valid", "bounded", "packing", "interleaved", "surfel", "surfel_record",
                "surfel_tree", "surfel_walk", "surfel_facing", "surfel_form_factor", "surfel_receiver",
                "surfel_occlusion"];
    /// The sum of all levels of ambient occlusion.
    SURFEL_OPENNESS: "surfel.openness", file "methods/surfel/add", constants [CHANNELS = 1], uniforms [LevelSum],
        shared ["surfel_openness"];
    /// Direct light that surfels reflect.
    SURFELS_REFLECTED: "surfels.reflected", file "surfels/light", constants [LIGHTS = 1, HEIGHT = 8],
        uniforms [FrameView, LightRecord],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_patch_record", "surfel_order", "lights",
                "shadow", "light_clear", "surfel_reflected"];
    /// Direct light that surfels reflect, dimmed by the medium between them and the lamps.
    SURFELS_DIMMED: "surfels.dimmed", file "surfels/light", constants [LIGHTS = 1, HEIGHT = 8, MEDIUM = 2, GREY = 0],
        uniforms [FrameView, LightRecord, MediumRecord],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_patch_record", "surfel_order", "lights",
                "shadow", "medium_span", "medium", "colours", "light_dimmed", "surfel_reflected"];
    /// Direct light that falls on surfels.
    SURFELS_RECEIVED: "surfels.received", file "surfels/light", constants [LIGHTS = 1, HEIGHT = 8],
        uniforms [FrameView, LightRecord],
        shared ["random", "view", "packing", "surfel", "surfel_record", "surfel_patch_record", "surfel_order", "lights",
                "shadow", "light_clear", "surfel_received"];
    /// States of patches after a stretch of time.
    SURFELS_KEEP: "surfels.keep", file "surfels/keep",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, FIRST_PIECE = 0, PIECES_AT_ONCE = 1, STATES = 1,
            PAINT_STATES = 1, EULER = 0],
        uniforms [PaintState, FrameView, LightRecord],
        shared ["view", "lights", "shadow", "light_clear", "surfel_patch_record", "glow_corners", "glow_place", "glow_time",
                "glow_change"];
    /// The same where the medium dims the lamps' light.
    SURFELS_KEEP_DIMMED: "surfels.keep_dimmed", file "surfels/keep",
        constants [LIGHTS = 1, SCHEDULES = 1, PIECES = 1, FIRST_PIECE = 0, PIECES_AT_ONCE = 1, STATES = 1,
            PAINT_STATES = 1, EULER = 0, MEDIUM = 2, GREY = 0],
        uniforms [PaintState, FrameView, LightRecord, MediumRecord],
        shared ["view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "surfel_patch_record",
                "glow_corners", "glow_place", "glow_time", "glow_change"];
    /// Light that surfels give back.
    SURFELS_GIVE_BACK: "surfels.give_back", file "surfels/give_back",
        constants [HEIGHT = 8, STATES = 1, PAINT_STATES = 1, UNIT = 128], uniforms [PaintState],
        shared ["random", "packing", "surfel", "surfel_record", "surfel_order"];
    /// An image of that light, in W/m²/sr.
    SURFELS_IN_WATTS: "surfels.in_watts", file "surfels/in_watts", constants [UNIT = 128], uniforms [], shared [];
    /// The lowest nodes of the tree, of surfels that send light.
    SURFELS_LIT_LEAVES: "surfels.lit_leaves", file "surfels/leaves", constants [HEIGHT = 8], uniforms [],
        shared ["packing", "surfel", "surfel_record", "surfel_tree", "surfel_reach_if_lit"];
    /// Indirect light of a level.
    SURFEL_LIGHT: "surfel.light", file "methods/surfel/splat",
        constants [CHANNELS = 3, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "surface_valid", "bounded", "packing", "interleaved", "surfel", "surfel_record",
                "surfel_tree", "surfel_walk", "surfel_facing", "surfel_sent", "surfel_form_factor", "surfel_receiver",
                "surfel_colour", "surfel_light"];
    /// What glossy receivers read of each pixel.
    GLOSS: "gloss", file "methods/gloss", constants [], uniforms [], shared [];
    /// Light of a level that glossy surfaces reflect.
    SURFEL_GLOSSY: "surfel.glossy", file "methods/surfel/splat",
        constants [CHANNELS = 3, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "gloss", "bounded", "packing", "interleaved", "surfel", "surfel_record",
                "surfel_tree", "surfel_walk", "surfel_facing", "surfel_sent", "lobe", "surfel_colour", "surfel_glossy"];
    /// That light in the colour of what reflects it.
    SURFEL_REFLECT: "surfel.reflect", file "methods/surfel/reflect", constants [], uniforms [LevelSum],
        shared ["surface", "gloss", "lobe"];
    /// The sum of all levels of indirect light.
    SURFEL_INDIRECT: "surfel.indirect", file "methods/surfel/add", constants [CHANNELS = 3], uniforms [LevelSum],
        shared ["surfel_sum"];
    /// Light of the environment that a level blocks.
    SURFEL_BLOCKED: "surfel.blocked", file "methods/surfel/splat",
        constants [CHANNELS = 3, HEIGHT = 8], uniforms [SplatLevel, FrameView],
        shared ["view", "random", "surface", "surface_valid", "bounded", "packing", "interleaved", "environment",
                "environment_height", "surfel", "surfel_record", "surfel_tree", "surfel_walk", "surfel_facing",
                "surfel_form_factor", "surfel_receiver", "surfel_colour", "surfel_blocked"];
    /// Light of the environment less what is blocked.
    SURFEL_OPEN: "surfel.open", file "methods/surfel/open", constants [],
        uniforms [LevelSum, FrameView], shared ["view", "environment", "environment_height"];
    /// What scatters below each pixel.
    SURFEL_BODIES: "surfel.bodies", file "methods/surfel/bodies", constants [], uniforms [LevelSum],
        shared ["diffusion_length"];
    /// Light that objects on a level give through themselves.
    SURFEL_GIVEN: "surfel.given", file "methods/surfel/splat",
        constants [CHANNELS = 12, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "bounded", "packing", "interleaved", "surfel", "surfel_record", "surfel_tree",
                "surfel_walk", "surfel_scattering"];
    /// Scattered light.
    SURFEL_SCATTER: "surfel.scatter", file "methods/surfel/scatter", constants [], uniforms [LevelSum], shared [];
    /// What a pixel's rays meet.
    BOUNCED_TRACE: "bounced-z.trace", file "methods/bounced_z/trace", constants [HEIGHT = 8], uniforms [Bounces],
        shared ["random", "surface", "surface_valid", "bounded", "packing", "interleaved", "surfel", "surfel_record",
                "surfel_tree", "surfel_walk", "tangents", "bounced_none", "bounced_directions", "bounced_matte"];
    /// The same along directions that glossy surfaces reflect to the eye.
    BOUNCED_GLOSSY_TRACE: "bounced-z.glossy_trace", file "methods/bounced_z/trace",
        constants [HEIGHT = 8], uniforms [Bounces],
        shared ["random", "surface", "gloss", "bounded", "packing", "interleaved", "surfel", "surfel_record",
                "surfel_tree", "surfel_walk", "tangents", "bounced_none", "bounced_directions", "lobe",
                "bounced_glossy"];
    /// What of a white sky a pixel's rays see past surfels.
    BOUNCED_SKY: "bounced-z.sky", file "methods/bounced_z/arrive", constants [], uniforms [],
        shared ["packing", "bounced_none", "bounced_sky"];
    /// What light surfels send along a pixel's rays.
    BOUNCED_LIGHT: "bounced-z.light", file "methods/bounced_z/arrive", constants [], uniforms [],
        shared ["packing", "bounced_none", "bounced_light"];
    /// What neighbouring pixels' rays say of a pixel.
    BOUNCED_FILTER: "bounced-z.filter", file "methods/bounced_z/filter",
        constants [CHANNELS = 1], uniforms [BounceWindow],
        shared ["surface", "surface_valid", "bounded", "packing", "tangents", "bounced_matte"];
    /// The same of glossy surfaces.
    BOUNCED_GLOSSY_FILTER: "bounced-z.glossy_filter", file "methods/bounced_z/filter", constants [CHANNELS = 3],
        uniforms [BounceWindow],
        shared ["surface", "gloss", "bounded", "packing", "tangents", "lobe", "bounced_glossy"];
    /// Facets, and the lowest nodes of the tree over them.
    AOV_FACETS: "aov.facets", file "methods/aov/facets", constants [HEIGHT = 10], uniforms [],
        shared ["surfel", "surfel_patch_record", "patch_corners", "surfel_tree", "facet"];
    /// The nodes above.
    AOV_PARENTS: "aov.parents", file "surfels/parents", constants [HEIGHT = 10], uniforms [TreeLevel],
        shared ["surfel", "surfel_tree"];
    /// What all facets occlude.
    AOV_OCCLUSION: "aov.occlusion", file "methods/aov/occlusion", constants [HEIGHT = 10, SLICE = 4],
        uniforms [FacetSum, FacetSlice],
        shared ["surface", "surface_valid", "surfel", "surfel_patch_record", "surfel_tree", "surfel_walk", "facet",
                "facet_form_factor"];
    /// Which of a pixel's rays facets hide.
    AOV_TRACE: "aov.trace", file "methods/aov/trace",
        constants [HEIGHT = 10, SLICE = 4], uniforms [FacetRays, FacetSlice],
        shared ["random", "surface", "surface_valid", "packing", "interleaved", "surfel", "surfel_patch_record",
                "surfel_tree", "surfel_walk", "facet", "tangents", "bounced_directions", "bounced_matte"];
}
