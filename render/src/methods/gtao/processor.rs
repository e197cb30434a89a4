//! The passes in vector instructions of the processor.

#[cfg(test)]
mod tests;

use super::Settings;
use crate::methods::{Surface, blur, slices};
use deepshade_shaders::Planes;

/// Openness before the blur, after that along rows, and after both, `[1, height, width]` each: what the
/// passes write, for machines without a graphics card.
pub fn on_processor(surface: &Surface, settings: &Settings) -> [Planes; 3] {
    let noisy = slices::vector::openness(surface, &settings.march);
    let [along_rows, image] = blur::vector::smooth(surface, &settings.blurs, &noisy);
    [noisy, along_rows, image]
}
