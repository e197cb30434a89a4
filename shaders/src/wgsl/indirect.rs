//! Indirect light and light from the environment.

use super::{Shader, uniforms};

table! {
    /// Light of one diffuse bounce by visibility bitmasks before its blur.
    SSGI_LIGHT: "ssgi.light", file "methods/ssgi/light",
        constants [], uniforms [Slices], shared ["random", "surface", "surface_valid", "bounded", "slices"];
    /// Light from a prefiltered environment.
    PREFILTERED_SHADE: "prefiltered.shade", file "methods/prefiltered/shade",
        constants [LEVELS = 14, EXPONENTS = 26, ANGLES = 32], uniforms [Prefiltered], shared ["environment"];
}
