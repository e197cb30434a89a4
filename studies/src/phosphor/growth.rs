//! What a frame takes as a sequence goes on: by the rate equation the same, by the integral over the past
//! more, of which there is more to look at (thesis, section 8.5).

use super::equal_quality::EqualQuality;
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade::shared::plot::{Line, Plot};
use deepshade_shaders::gpu::Gpu;
use serde_json::json;

/// Seconds of a sequence before the frame that is measured.
const LENGTHS: [u16; 3] = [1, 4, 16];
/// The lamp blinks: seconds from one flash to the next, how long each is, and until when there are some.
const PERIOD: f32 = 0.75;
const FLASH: f32 = 0.25;
const UNTIL: f32 = 16.0;

/// Frames of equal quality after sequences of different lengths.
pub struct Growth(Vec<EqualQuality>);

impl Growth {
    /// Measures them.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, size: Size, runs: usize) -> Result<Self> {
        let flash = |index: u16| [f32::from(index) * PERIOD, f32::from(index) * PERIOD + FLASH];
        let on: Vec<[f32; 2]> = (0..(UNTIL / PERIOD) as u16).map(flash).collect();
        let after = |length: u16| EqualQuality::of(gpu, size, runs, on.clone(), f32::from(length));
        Ok(Self(LENGTHS.into_iter().map(after).collect::<Result<_>>()?))
    }

    /// Sets their figures.
    pub fn set(&self, figures: &mut Figures) {
        for (length, comparison) in LENGTHS.iter().zip(&self.0) {
            figures.set(&format!("ms_rate_equation_after_{length}_s"), comparison.states.milliseconds);
            if let Some(row) = comparison.equal_quality() {
                figures.set(&format!("ms_glassner_after_{length}_s"), row.milliseconds);
                figures.set(&format!("samples_glassner_after_{length}_s"), f64::from(row.samples));
            }
        }
        figures.detail("growth", json!(self.0.iter().map(EqualQuality::to_json).collect::<Vec<_>>()));
    }

    /// Milliseconds of both against the length.
    pub fn plot(&self) -> Plot {
        let pairs = || LENGTHS.iter().map(|length| f64::from(*length)).zip(&self.0);
        let states = pairs().map(|(length, comparison)| (length, comparison.states.milliseconds)).collect();
        let moment = |(length, comparison): (f64, &EqualQuality)| {
            Some((length, comparison.equal_quality()?.milliseconds))
        };
        let moments = pairs().filter_map(moment).collect();
        Plot {
            x: "length of the sequence so far, s",
            is_logarithmic: true,
            y: "a frame, ms",
            lines: vec![Line::dotted("rate-equation", states), Line::dotted("glassner, as exact", moments)],
            level: None,
        }
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["seconds so far", "rate-equation, ms", "glassner as exact, ms", "its moments"];
        let row = |(length, comparison): (&u16, &EqualQuality)| {
            let of_moments = comparison.equal_quality().map_or_else(
                || ["more than tried".to_owned(), String::new()],
                |row| [format!("{:.1}", row.milliseconds), row.samples.to_string()],
            );
            let first = [length.to_string(), format!("{:.1}", comparison.states.milliseconds)];
            [first, of_moments].concat()
        };
        let head = std::iter::once(head.map(str::to_owned).to_vec());
        head.chain(LENGTHS.iter().zip(&self.0).map(row)).collect()
    }
}
