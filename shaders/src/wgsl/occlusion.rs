//! Ambient and directional occlusion.

use super::{Shader, uniforms};

table! {
    /// Horizon-based ambient occlusion before its blur.
    HBAO_OCCLUSION: "hbao.occlusion", file "methods/hbao/occlusion",
        constants [], uniforms [Hbao], shared ["random", "surface", "surface_valid", "bounded"];
    /// One direction of the blur of images of `CHANNELS` channels whose samples were random.
    BLUR: "blur.smooth", file "methods/blur/smooth",
        constants [CHANNELS = 1], uniforms [Blur], shared ["surface", "surface_valid", "bounded"];
    /// Ambient occlusion by visibility bitmasks before its blur.
    GTAO_OCCLUSION: "gtao.occlusion", file "methods/gtao/occlusion",
        constants [], uniforms [Slices], shared ["random", "surface", "surface_valid", "bounded", "slices"];
    /// Directional occlusion before its blur.
    SSDO_LIGHT: "ssdo.light", file "methods/ssdo/light",
        constants [], uniforms [Ssdo], shared ["random", "surface", "surface_valid", "bounded", "environment"];
}
