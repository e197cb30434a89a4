//! What is made of the finished picture: anti-aliasing, depth of field, motion blur, subsurface scattering.

use super::Shader;

shaders! {
    table POST;
    /// Luma of fast approximate anti-aliasing.
    FXAA_LUMA: "fxaa.luma", "methods/fxaa/luma";
    /// Fast approximate anti-aliasing, given the luma.
    FXAA_SMOOTH: "fxaa.smooth", "methods/fxaa/smooth";
    /// Ring gather's picture in few pixels, with radii of circles of confusion.
    RING_GATHER_SHRINK: "ring_gather.shrink", "methods/ring_gather/shrink";
    /// The largest circle in front of focus in each tile.
    RING_GATHER_TILES: "ring_gather.tiles", "methods/ring_gather/tiles";
    /// The largest of these circles that reaches a tile.
    RING_GATHER_NEIGHBOURS: "ring_gather.neighbours", "methods/ring_gather/neighbours";
    /// What is seen through the lens at a pixel, in two layers.
    RING_GATHER_GATHER: "ring_gather.gather", "methods/ring_gather/gather";
    /// The layers over the sharp picture.
    RING_GATHER_COMBINE: "ring_gather.combine", "methods/ring_gather/combine";
    /// Half of the longest movement in each tile.
    RECONSTRUCTION_TILES: "reconstruction.tiles", "methods/reconstruction/tiles";
    /// Half of the longest movement that reaches a tile.
    RECONSTRUCTION_NEIGHBOURS: "reconstruction.neighbours", "methods/reconstruction/neighbours";
    /// What a pixel shows while the shutter is open.
    RECONSTRUCTION_GATHER: "reconstruction.gather", "methods/reconstruction/gather";
    /// One direction of separable subsurface scattering.
    SEPARABLE_BLUR: "separable.blur", "methods/separable/blur";
    /// Areas that pixels show, for the gather of subsurface scattering.
    GATHER_AREAS: "gather.areas", "methods/gather/areas";
    /// The gather of subsurface scattering.
    GATHER_GATHER: "gather.gather", "methods/gather/gather";
    /// What subsurface scattering by methods in screen space begins with.
    SUBSURFACE_ENTER: "subsurface.enter", "methods/subsurface/enter";
    /// What it ends with.
    SUBSURFACE_LEAVE: "subsurface.leave", "methods/subsurface/leave";
}
