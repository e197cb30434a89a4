//! Ambient and directional occlusion.

use super::Shader;

shaders! {
    table OCCLUSION;
    /// Horizon-based ambient occlusion before its blur.
    HBAO_OCCLUSION: "hbao.occlusion", "methods/hbao/occlusion";
    /// One direction of the blur of images of `CHANNELS` channels whose samples were random.
    BLUR: "blur.smooth", "methods/blur/smooth";
    /// Ambient occlusion by visibility bitmasks before its blur.
    GTAO_OCCLUSION: "gtao.occlusion", "methods/gtao/occlusion";
    /// Directional occlusion before its blur.
    SSDO_LIGHT: "ssdo.light", "methods/ssdo/light";
}
