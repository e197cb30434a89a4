//! How fast a device is at best.

use super::Shader;

shaders! {
    table CEILINGS;
    /// Memory's speed: a copy.
    COPY: "ceilings.copy", "ceilings/copy";
    /// Arithmetic's speed: multiplications with additions.
    FMA: "ceilings.fma", "ceilings/fma";
}
