//! Surfels: making them, and shading by them.

use super::{Shader, uniforms};

table! {
    /// Where vertices are in camera space.
    SURFELS_VERTICES: "surfels.vertices", file "surfels/vertices", constants [], uniforms [FrameView], shared ["view"];
    /// How many surfels each patch gets.
    SURFELS_MEASURE: "surfels.measure", file "surfels/measure", constants [HEIGHT = 8], uniforms [Surfels, FrameView],
        shared ["random", "surfel", "surfel_patch_record", "patch_corners", "surfel_patch"];
    /// Sums of 64 numbers each.
    SURFELS_SUM: "surfels.sum", file "surfels/sum", constants [], uniforms [], shared [];
    /// Where each of a few sums begins, and how many surfels there are.
    SURFELS_TOTAL: "surfels.total", file "surfels/total", constants [HEIGHT = 8], uniforms [], shared ["surfel"];
    /// Where each of 64 begins.
    SURFELS_BEGIN: "surfels.begin", file "surfels/begin", constants [], uniforms [], shared [];
    /// Where surfels are.
    SURFELS_PLACE: "surfels.place", file "surfels/place", constants [HEIGHT = 8], uniforms [Surfels],
        shared ["random", "packing", "surfel", "surfel_patch_record", "patch_corners", "surfel_patch"];
    /// The lowest nodes of the tree, of surfels that reach as far as they are large.
    SURFELS_LEAVES: "surfels.leaves", file "surfels/leaves", constants [HEIGHT = 8], uniforms [],
        shared ["surfel", "surfel_tree", "surfel_reach_by_radius"];
    /// The nodes above.
    SURFELS_PARENTS: "surfels.parents", file "surfels/parents", constants [HEIGHT = 8], uniforms [TreeLevel],
        shared ["surfel", "surfel_tree"];
    /// Ambient occlusion of a level.
    SURFEL_OCCLUSION: "surfel.occlusion", file "methods/surfel/splat", constants [CHANNELS = 1, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree",
                "surfel_walk", "surfel_reach_by_radius", "surfel_facing", "surfel_form_factor", "surfel_receiver", "surfel_occlusion"];
    /// The sum of all levels of ambient occlusion.
    SURFEL_OPENNESS: "surfel.openness", file "methods/surfel/add", constants [CHANNELS = 1], uniforms [LevelSum],
        shared ["surfel_openness"];
    /// Direct light that surfels reflect.
    SURFELS_LIGHT: "surfels.light", file "surfels/light", constants [LIGHTS = 1, WHITE = 0, HEIGHT = 8],
        uniforms [FrameView, LightRecord], shared ["view", "packing", "surfel", "surfel_patch_record", "lights", "shadow"];
    /// The lowest nodes of the tree, of surfels that send light.
    SURFELS_LIT_LEAVES: "surfels.lit_leaves", file "surfels/leaves", constants [HEIGHT = 8], uniforms [],
        shared ["surfel", "surfel_tree", "surfel_reach_if_lit"];
    /// Indirect light of a level.
    SURFEL_LIGHT: "surfel.light", file "methods/surfel/splat", constants [CHANNELS = 3, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree", "surfel_walk", "surfel_reach_if_lit",
                "surfel_facing", "surfel_form_factor", "surfel_receiver", "surfel_colour", "surfel_light"];
    /// What glossy receivers read of each pixel.
    GLOSS: "gloss", file "methods/gloss", constants [], uniforms [], shared [];
    /// Light of a level that glossy surfaces reflect.
    SURFEL_GLOSSY: "surfel.glossy", file "methods/surfel/splat", constants [CHANNELS = 3, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "glossy_surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree", "surfel_walk", "surfel_reach_if_lit",
                "surfel_facing", "lobe", "surfel_colour", "surfel_glossy"];
    /// That light in the colour of what reflects it.
    SURFEL_REFLECT: "surfel.reflect", file "methods/surfel/reflect", constants [], uniforms [LevelSum],
        shared ["glossy_surface", "lobe"];
    /// The sum of all levels of indirect light.
    SURFEL_INDIRECT: "surfel.indirect", file "methods/surfel/add", constants [CHANNELS = 3], uniforms [LevelSum],
        shared ["surfel_sum"];
    /// Light of the environment that a level blocks.
    SURFEL_BLOCKED: "surfel.blocked", file "methods/surfel/splat", constants [CHANNELS = 3, BLOCKED_HEIGHT = 16, HEIGHT = 8],
        uniforms [SplatLevel, FrameView],
        shared ["view", "random", "surface", "bounded", "packing", "interleaved", "environment", "surfel", "surfel_tree",
                "surfel_walk", "surfel_reach_by_radius", "surfel_facing", "surfel_form_factor", "surfel_receiver", "surfel_colour",
                "surfel_blocked"];
    /// Light of the environment less what is blocked.
    SURFEL_OPEN: "surfel.open", file "methods/surfel/open", constants [OPEN_HEIGHT = 32],
        uniforms [LevelSum, FrameView], shared ["view", "environment"];
    /// What scatters below each pixel.
    SURFEL_BODIES: "surfel.bodies", file "methods/surfel/bodies", constants [], uniforms [LevelSum], shared [];
    /// Light that objects on a level give through themselves.
    SURFEL_GIVEN: "surfel.given", file "methods/surfel/splat", constants [CHANNELS = 6, HEIGHT = 8], uniforms [SplatLevel],
        shared ["random", "bounded", "packing", "interleaved", "surfel", "surfel_patch_record", "surfel_tree", "surfel_walk",
                "surfel_reach_by_radius", "surfel_scattering"];
    /// Scattered light.
    SURFEL_SCATTER: "surfel.scatter", file "methods/surfel/scatter", constants [], uniforms [LevelSum], shared [];
    /// What of a white sky a pixel's rays see past surfels.
    BOUNCED_SKY: "bounced-z.sky", file "methods/bounced_z/trace", constants [HEIGHT = 8], uniforms [Bounces],
        shared ["random", "surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree", "surfel_walk",
                "tangents", "bounced_directions", "bounced_matte", "bounced_sky"];
    /// What light surfels send along a pixel's rays.
    BOUNCED_LIGHT: "bounced-z.light", file "methods/bounced_z/trace", constants [HEIGHT = 8], uniforms [Bounces],
        shared ["random", "surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree", "surfel_walk",
                "tangents", "bounced_directions", "bounced_matte", "surfel_facing", "bounced_light"];
    /// The same along directions that glossy surfaces reflect to the eye.
    BOUNCED_GLOSSY: "bounced-z.glossy", file "methods/bounced_z/trace", constants [HEIGHT = 8], uniforms [Bounces],
        shared ["random", "glossy_surface", "bounded", "packing", "interleaved", "surfel", "surfel_tree", "surfel_walk",
                "tangents", "bounced_directions", "lobe", "bounced_glossy", "surfel_facing", "bounced_light"];
    /// What neighbouring pixels' rays say of a pixel.
    BOUNCED_FILTER: "bounced-z.filter", file "methods/bounced_z/filter", constants [CHANNELS = 1], uniforms [BounceWindow],
        shared ["surface", "bounded", "packing", "tangents", "bounced_matte"];
    /// The same of glossy surfaces.
    BOUNCED_GLOSSY_FILTER: "bounced-z.glossy_filter", file "methods/bounced_z/filter", constants [CHANNELS = 3],
        uniforms [BounceWindow], shared ["glossy_surface", "bounded", "packing", "tangents", "lobe", "bounced_glossy"];
    /// Facets, and the lowest nodes of the tree over them.
    AOV_FACETS: "aov.facets", file "methods/aov/facets", constants [HEIGHT = 10], uniforms [],
        shared ["surfel", "surfel_patch_record", "patch_corners", "surfel_tree", "facet"];
    /// The nodes above.
    AOV_PARENTS: "aov.parents", file "surfels/parents", constants [HEIGHT = 10], uniforms [TreeLevel],
        shared ["surfel", "surfel_tree"];
    /// What all facets occlude.
    AOV_OCCLUSION: "aov.occlusion", file "methods/aov/occlusion", constants [HEIGHT = 10, SLICE = 4],
        uniforms [FacetSum, FacetSlice],
        shared ["surface", "surfel", "surfel_patch_record", "surfel_tree", "surfel_walk", "facet",
                "facet_form_factor"];
    /// Which of a pixel's rays facets hide.
    AOV_TRACE: "aov.trace", file "methods/aov/trace", constants [HEIGHT = 10], uniforms [FacetRays],
        shared ["random", "surface", "packing", "interleaved", "surfel", "surfel_patch_record", "surfel_tree",
                "surfel_walk", "facet", "tangents", "bounced_directions", "bounced_matte"];
}
