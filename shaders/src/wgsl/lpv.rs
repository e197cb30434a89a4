//! Light propagation volumes.

use super::Shader;

shaders! {
    table LPV;
    /// Sums of the frame before are forgotten.
    LPV_CLEAR: "lpv.clear", "methods/lpv/clear";
    /// Surfels as light and as blockers.
    LPV_INJECT: "lpv.inject", "methods/lpv/inject";
    /// Light that surfels emit.
    LPV_SHINE: "lpv.shine", "methods/lpv/shine_emitted";
    /// Light that surfels give back of what they kept.
    LPV_SHINE_KEPT: "lpv.shine_kept", "methods/lpv/shine_kept";
    /// Light that a medium gives back of what it kept.
    LPV_SHINE_MEDIUM: "lpv.shine_medium", "methods/lpv/shine_medium";
    /// Light that surfels reflect of it.
    LPV_REFLECT: "lpv.reflect", "methods/lpv/reflect";
    /// What passes between cells.
    LPV_LINKS: "lpv.links", "methods/lpv/links";
    /// What the medium in cells does to light.
    LPV_MEDIA: "lpv.media", "methods/lpv/media";
    /// Light that surfaces send.
    LPV_FRESH: "lpv.fresh", "methods/lpv/fresh";
    /// Light of the lamps that the medium in cells scatters.
    LPV_BEGIN: "lpv.begin", "methods/lpv/begin_of_lamps";
    /// Light of the lamps and of surfaces that the medium in cells scatters.
    LPV_BEGIN_EMITTED: "lpv.begin_emitted", "methods/lpv/begin_emitted";
    /// One iteration.
    LPV_PROPAGATE: "lpv.propagate", "methods/lpv/propagate";
    /// Where a finer grid lies.
    LPV_NEST: "lpv.nest", "methods/lpv/nest";
    /// Light that a coarser grid hands to it.
    LPV_BORDER: "lpv.border", "methods/lpv/border";
    /// Surfaces lit by the grid.
    LPV_LIT: "lpv.lit", "methods/lpv/lit";
    /// The medium, lit by the grid, in an image of fewer pixels.
    LPV_MARCH: "lpv.march", "methods/lpv/march";
    /// The medium in front of each pixel and the surface behind it.
    LPV_APPLY: "lpv.apply", "methods/lpv/apply";
}
