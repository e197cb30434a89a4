//! Indirect light and light from the environment.

use super::Shader;

shaders! {
    table INDIRECT;
    /// Light of one diffuse bounce by visibility bitmasks before its blur.
    SSGI_LIGHT: "ssgi.light", "methods/ssgi/light";
    /// Light from a prefiltered environment.
    PREFILTERED_SHADE: "prefiltered.shade", "methods/prefiltered/shade";
}
