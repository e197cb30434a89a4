//! Surfels: making them, and shading by them.

use super::Shader;

shaders! {
    table SURFELS;
    /// Where vertices are in camera space.
    SURFELS_VERTICES: "surfels.vertices", "surfels/vertices";
    /// How many surfels each patch gets.
    SURFELS_MEASURE: "surfels.measure", "surfels/measure";
    /// Sums of 64 numbers each.
    SURFELS_SUM: "surfels.sum", "surfels/sum";
    /// Where each of a few sums begins, and how many surfels there are.
    SURFELS_TOTAL: "surfels.total", "surfels/total";
    /// Where each of 64 begins.
    SURFELS_BEGIN: "surfels.begin", "surfels/begin";
    /// Where surfels are.
    SURFELS_PLACE: "surfels.place", "surfels/place";
    /// The lowest nodes of the tree, of surfels that reach as far as they are large.
    SURFELS_LEAVES: "surfels.leaves", "surfels/leaves_of_all";
    /// The nodes above.
    SURFELS_PARENTS: "surfels.parents", "surfels/parents_of_surfels";
    /// Ambient occlusion of a level.
    SURFEL_OCCLUSION: "surfel.occlusion", "methods/surfel/occlusion";
    /// The sum of all levels of ambient occlusion.
    SURFEL_OPENNESS: "surfel.openness", "methods/surfel/openness";
    /// Direct light that surfels reflect.
    SURFELS_REFLECTED: "surfels.reflected", "surfels/reflected";
    /// Direct light that surfels reflect, dimmed by the medium between them and the lamps.
    SURFELS_DIMMED: "surfels.dimmed", "surfels/dimmed";
    /// Direct light that falls on surfels.
    SURFELS_RECEIVED: "surfels.received", "surfels/received";
    /// States of patches after a stretch of time.
    SURFELS_KEEP: "surfels.keep", "surfels/keep_clear";
    /// The same where the medium dims the lamps' light.
    SURFELS_KEEP_DIMMED: "surfels.keep_dimmed", "surfels/keep_dimmed";
    /// Light that surfels give back.
    SURFELS_GIVE_BACK: "surfels.give_back", "surfels/give_back";
    /// An image of that light, in W/m²/sr.
    SURFELS_IN_WATTS: "surfels.in_watts", "surfels/in_watts";
    /// The lowest nodes of the tree, of surfels that send light.
    SURFELS_LIT_LEAVES: "surfels.lit_leaves", "surfels/leaves_of_lit";
    /// Indirect light of a level.
    SURFEL_LIGHT: "surfel.light", "methods/surfel/light";
    /// What glossy receivers read of each pixel.
    GLOSS: "gloss", "methods/gloss";
    /// Light of a level that glossy surfaces reflect.
    SURFEL_GLOSSY: "surfel.glossy", "methods/surfel/glossy";
    /// That light in the colour of what reflects it.
    SURFEL_REFLECT: "surfel.reflect", "methods/surfel/reflect";
    /// The sum of all levels of indirect light.
    SURFEL_INDIRECT: "surfel.indirect", "methods/surfel/indirect";
    /// Light of the environment that a level blocks.
    SURFEL_BLOCKED: "surfel.blocked", "methods/surfel/blocked";
    /// Light of the environment less what is blocked.
    SURFEL_OPEN: "surfel.open", "methods/surfel/open";
    /// What scatters below each pixel.
    SURFEL_BODIES: "surfel.bodies", "methods/surfel/bodies";
    /// Light that objects on a level give through themselves.
    SURFEL_GIVEN: "surfel.given", "methods/surfel/given";
    /// Scattered light.
    SURFEL_SCATTER: "surfel.scatter", "methods/surfel/scatter";
    /// What a pixel's rays meet.
    BOUNCED_TRACE: "bounced-z.trace", "methods/bounced_z/trace_matte";
    /// The same along directions that glossy surfaces reflect to the eye.
    BOUNCED_GLOSSY_TRACE: "bounced-z.glossy_trace", "methods/bounced_z/trace_glossy";
    /// What of a white sky a pixel's rays see past surfels.
    BOUNCED_SKY: "bounced-z.sky", "methods/bounced_z/sky";
    /// What light surfels send along a pixel's rays.
    BOUNCED_LIGHT: "bounced-z.light", "methods/bounced_z/light";
    /// What neighbouring pixels' rays say of a pixel.
    BOUNCED_FILTER: "bounced-z.filter", "methods/bounced_z/filter_matte";
    /// The same of glossy surfaces.
    BOUNCED_GLOSSY_FILTER: "bounced-z.glossy_filter", "methods/bounced_z/filter_glossy";
    /// Facets, and the lowest nodes of the tree over them.
    AOV_FACETS: "aov.facets", "methods/aov/facets";
    /// The nodes above.
    AOV_PARENTS: "aov.parents", "methods/aov/parents";
    /// What all facets occlude.
    AOV_OCCLUSION: "aov.occlusion", "methods/aov/occlusion";
    /// Which of a pixel's rays facets hide.
    AOV_TRACE: "aov.trace", "methods/aov/trace";
}
