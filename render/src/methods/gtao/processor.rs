//! The passes in vector instructions of the processor.

#[cfg(test)]
mod tests;

use super::GtaoParameters;
use crate::methods::march::Marched;
use crate::methods::{Surface, blur, slices};
use crate::screen::View;
use deepshade_shaders::Planes;

/// Openness before the blur, after that along rows, and after both, `[1, height, width]` each: what the
/// passes write, for machines without a graphics card.
pub fn on_processor(parameters: &GtaoParameters, surface: &Surface, view: &View) -> [Planes; 3] {
    let noisy = slices::vector::openness(surface, &parameters.march(view));
    let blurs = parameters.blur.settings(view, GtaoParameters::EFFECT);
    let [along_rows, image] = blur::vector::smooth(surface, &blurs, &noisy);
    [noisy, along_rows, image]
}
