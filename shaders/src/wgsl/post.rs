//! What is made of the finished picture: anti-aliasing, depth of field, motion blur, subsurface scattering.

use super::{Shader, uniforms};

table! {
    /// Luma of fast approximate anti-aliasing.
    FXAA_LUMA: "fxaa.luma", file "methods/fxaa/luma", constants [], uniforms [Fxaa], shared ["picture"];
    /// Fast approximate anti-aliasing, given the luma.
    FXAA_SMOOTH: "fxaa.smooth", file "methods/fxaa/smooth", constants [], uniforms [Fxaa], shared ["picture", "bounded"];
    /// Ring gather's picture in few pixels, with radii of circles of confusion.
    RING_GATHER_SHRINK: "ring_gather.shrink", file "methods/ring_gather/shrink",
        constants [], uniforms [RingGather], shared ["picture", "ring_gather"];
    /// The largest circle in front of focus in each tile.
    RING_GATHER_TILES: "ring_gather.tiles", file "methods/ring_gather/tiles",
        constants [], uniforms [RingGather], shared [];
    /// The largest of these circles that reaches a tile.
    RING_GATHER_NEIGHBOURS: "ring_gather.neighbours", file "methods/ring_gather/neighbours",
        constants [], uniforms [RingGather], shared [];
    /// What is seen through the lens at a pixel, in two layers.
    RING_GATHER_GATHER: "ring_gather.gather", file "methods/ring_gather/gather",
        constants [], uniforms [RingGather], shared [];
    /// The layers over the sharp picture.
    RING_GATHER_COMBINE: "ring_gather.combine", file "methods/ring_gather/combine",
        constants [], uniforms [RingGather], shared ["picture", "ring_gather"];
    /// Half of the longest movement in each tile.
    RECONSTRUCTION_TILES: "reconstruction.tiles", file "methods/reconstruction/tiles",
        constants [], uniforms [Reconstruction], shared ["motion"];
    /// Half of the longest movement that reaches a tile.
    RECONSTRUCTION_NEIGHBOURS: "reconstruction.neighbours", file "methods/reconstruction/neighbours",
        constants [], uniforms [Reconstruction], shared [];
    /// What a pixel shows while the shutter is open.
    RECONSTRUCTION_GATHER: "reconstruction.gather", file "methods/reconstruction/gather",
        constants [], uniforms [Reconstruction], shared ["picture", "motion", "random", "bounded"];
    /// One direction of separable subsurface scattering.
    SEPARABLE_BLUR: "separable.blur", file "methods/separable/blur",
        constants [MOST_TAPS = 25], uniforms [Separable], shared ["picture", "translucent", "bounded"];
    /// Areas that pixels show, for the gather of subsurface scattering.
    GATHER_AREAS: "gather.areas", file "methods/gather/areas",
        constants [], uniforms [Gather], shared ["picture", "translucent"];
    /// The gather of subsurface scattering.
    GATHER_GATHER: "gather.gather", file "methods/gather/gather",
        constants [], uniforms [Gather], shared ["picture", "translucent", "random", "bounded"];
    /// What subsurface scattering by methods in screen space begins with.
    SUBSURFACE_ENTER: "subsurface.enter", file "methods/subsurface/enter",
        constants [], uniforms [], shared ["diffusion_length"];
    /// What it ends with.
    SUBSURFACE_LEAVE: "subsurface.leave", file "methods/subsurface/leave", constants [], uniforms [], shared [];
}
