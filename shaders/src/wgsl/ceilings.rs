//! How fast a device is at best.

use super::Shader;

table! {
    /// Memory's speed: a copy.
    COPY: "ceilings.copy", file "ceilings/copy", constants [], uniforms [], shared [];
    /// Arithmetic's speed: multiplications with additions.
    FMA: "ceilings.fma", file "ceilings/fma", constants [TURNS = 256], uniforms [], shared [];
}
