//! Pictures of a comparison: both images, and their difference in standard errors and in size.

use anyhow::Result;
use deepshade::shared::pictures::{diverging, painted, shown, write_png};
use deepshade_render::path::Estimate;
use deepshade_shaders::Planes;
use std::path::Path;

/// The deviate that gets the last colour.
const DEVIATE_RANGE: f32 = 6.0;

/// The difference, relative to the brightest that both show, that gets the last colour.
const DIFFERENCE_RANGE: f32 = 0.1;

/// Writes `ours.png`, `theirs.png`, `difference.png` (blue where ours is darker, orange where it is lighter)
/// and `deviates.png`, the same in standard errors.
///
/// # Errors
/// If a file cannot be written.
pub fn write(folder: &Path, ours: &Estimate, theirs: &Estimate) -> Result<()> {
    let exposure = 1.0 / (theirs.mean.mean() as f32).max(f32::MIN_POSITIVE) * 0.3;
    let exposed = |image: &Planes| {
        Planes::from_fn(image.channels(), image.height(), image.width(), |c, y, x| {
            image.at(c, y, x) * exposure
        })
    };
    write_png(&folder.join("ours.png"), &shown(&exposed(&ours.mean)))?;
    write_png(&folder.join("theirs.png"), &shown(&exposed(&theirs.mean)))?;
    let channels = ours.mean.channels();
    let over_channels = |pixel: usize, value: &dyn Fn(usize) -> f32| {
        (0..channels).map(|c| value(c * ours.mean.pixels() + pixel)).sum::<f32>()
    };
    let difference = |i: usize| ours.mean.data()[i] - theirs.mean.data()[i];
    let variance = |i: usize| {
        [ours, theirs]
            .iter()
            .filter_map(|image| image.variance.as_ref())
            .map(|image| image.data()[i])
            .sum::<f32>()
    };
    let sizes = painted(&ours.mean, |pixel| {
        diverging(over_channels(pixel, &difference) / channels as f32 * exposure / DIFFERENCE_RANGE)
    });
    let deviate =
        |i: usize| difference(i) / (variance(i) + 1e-8 * theirs.mean.data()[i].powi(2)).sqrt().max(1e-12);
    let deviates = painted(&ours.mean, |pixel| {
        diverging(over_channels(pixel, &deviate) / channels as f32 / DEVIATE_RANGE)
    });
    write_png(&folder.join("difference.png"), &sizes)?;
    write_png(&folder.join("deviates.png"), &deviates)
}
