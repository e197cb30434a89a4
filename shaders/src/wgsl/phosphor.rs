//! Light that surfaces keep.

use super::Shader;

shaders! {
    table PHOSPHOR;
    /// The tree over tiles.
    PHOSPHOR_FIT: "phosphor.fit", "methods/phosphor/fit";
    /// The tile of each pixel.
    PHOSPHOR_FIND: "phosphor.find", "methods/phosphor/find";
    /// States after a stretch of time.
    PHOSPHOR_STEP: "phosphor.step", "methods/phosphor/step_clear";
    /// The same where the medium dims the lamps' light.
    PHOSPHOR_STEP_DIMMED: "phosphor.step_dimmed", "methods/phosphor/step_dimmed";
    /// States of a medium's cells after a stretch of time.
    PHOSPHOR_CELLS: "phosphor.cells", "methods/phosphor/cells";
    /// What they give back at each pixel.
    PHOSPHOR_SHINE: "phosphor.shine", "methods/phosphor/shine";
    /// What states give back at each pixel.
    PHOSPHOR_SHOW: "phosphor.show", "methods/phosphor/show";
    /// The same as an integral over the past.
    PHOSPHOR_GLASSNER: "phosphor.glassner", "methods/phosphor/glassner_clear";
    /// The same where the medium dims the lamps' light.
    PHOSPHOR_GLASSNER_DIMMED: "phosphor.glassner_dimmed", "methods/phosphor/glassner_dimmed";
}
