//! States beside moments of the past in images, at equal quality and in equal time, as in the thesis' Figure
//! 8.16.
//!
//! The lamp is faint, so that nothing saturates and both have the same mean; errors are relative squared
//! errors against truth under one exposure, those of shadow maps included. Moments of equal quality are found
//! by bisection.

use super::cornell::BRIGHT;
use super::subject::GlowingRoom;
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade_render::methods::Quality;
use deepshade_render::methods::phosphor::RateEquationParameters;
use deepshade_render::methods::phosphor::glassner::GlassnerParameters as Moments;
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes};
use serde_json::{Value, json};

/// How much fainter the lamp is than one that the walls take in well.
const FAINT: f32 = 1e-4;
/// Seconds from the frame before to the one that is compared.
const STEP: f32 = 1.0 / 60.0;
/// Moments that are drawn at most.
const MOST: u32 = 4096;
/// Quality is equal where the integral's error is no larger than this times that of states: the errors of
/// shadow maps, which both have, are never the same.
const EQUAL: f64 = 1.1;
/// By how much bisection may leave the moments of equal quality too many.
const FINE: f64 = 1.05;

/// A method's image: how many moments, milliseconds, error.
pub struct Row {
    pub samples: u32,
    pub milliseconds: f64,
    pub error: f64,
}

/// What was measured.
pub struct EqualQuality {
    size: Size,
    pub states: Row,
    moments: Vec<Row>,
}

impl EqualQuality {
    /// Measures it at a moment of a room whose lamp shines at these times, in the frame of a sequence.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, size: Size, runs: usize, on: Vec<[f32; 2]>, moment: f32) -> Result<Self> {
        let mut subject = GlowingRoom::new(gpu, size, FAINT * BRIGHT, false, on)?;
        let truth = subject.truth(Effect::Phosphor, moment, 8)?;
        let scale = exposure(Effect::Phosphor, &truth);
        let right = exposed(&truth, scale);
        let error = |image: &Planes| relative_mse(&exposed(image, scale), &right);
        let passes = subject.passes(&ScreenMethod::new(gpu, RateEquationParameters::of(Quality::High)))?;
        subject.make(moment - STEP, &[&passes])?;
        subject.make(moment, &[&passes])?;
        // Timing repeats the step.
        let wrong = error(&subject.image(&passes)?);
        let states = Row { samples: 0, milliseconds: subject.milliseconds(&passes, runs)?, error: wrong };
        let mut moments = bisected(EQUAL * states.error, |samples| {
            let passes = subject.passes(&ScreenMethod::new(gpu, Moments { samples }))?;
            let milliseconds = subject.milliseconds(&passes, runs)?;
            Ok(Row { samples, milliseconds, error: error(&subject.image(&passes)?) })
        })?;
        moments.sort_unstable_by_key(|row| row.samples);
        Ok(Self { size, states, moments })
    }

    /// The fewest moments of equal quality.
    pub fn equal_quality(&self) -> Option<&Row> {
        self.moments.iter().find(|row| row.error <= EQUAL * self.states.error)
    }

    /// The one of the most moments that takes no longer, or of a single moment if that does.
    fn equal_time(&self) -> Option<&Row> {
        let in_time = self.moments.iter().rfind(|row| row.milliseconds <= self.states.milliseconds);
        in_time.or(self.moments.first())
    }

    /// Moments of equal time and of equal quality, or as near as was tried.
    pub fn rivals(&self) -> [u32; 2] {
        [self.equal_time(), self.equal_quality().or(self.moments.last())]
            .map(|row| row.map_or(1, |row| row.samples))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        figures.set("ms_rate_equation", self.states.milliseconds);
        figures.set("relmse_rate_equation", self.states.error);
        if let Some(row) = self.equal_quality() {
            figures.set("ratio_glassner_equal_quality", row.milliseconds / self.states.milliseconds);
            figures.set("samples_glassner_equal_quality", f64::from(row.samples));
        }
        if let Some(row) = self.equal_time() {
            figures.set("ratio_error_glassner_equal_time", row.error / self.states.error);
        }
    }

    /// All rows, for the record.
    pub fn to_json(&self) -> Value {
        let row = |row: &Row| json!([row.samples, row.milliseconds, row.error]);
        json!({ "size": self.size.to_string(), "rate_equation": row(&self.states),
            "glassner": self.moments.iter().map(row).collect::<Vec<_>>() })
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["method", "ms", "relative squared error"].map(str::to_owned).to_vec();
        let row = |name: String, row: &Row| {
            vec![name, format!("{:.2}", row.milliseconds), format!("{:.2e}", row.error)]
        };
        let first = row(format!("rate-equation at {}", self.size), &self.states);
        let moments = self.moments.iter().map(|of| row(format!("glassner, {} moments", of.samples), of));
        [head, first].into_iter().chain(moments).collect()
    }
}

/// What is measured on the way to the fewest moments whose error is no larger than `wanted`: four times as
/// many until they are enough, or there are no more, then in between.
fn bisected(wanted: f64, measured: impl Fn(u32) -> Result<Row>) -> Result<Vec<Row>> {
    let (mut rows, mut too_few, mut samples): (Vec<Row>, u32, u32) = (Vec::new(), 0, 1);
    while samples <= MOST {
        rows.push(measured(samples)?);
        if rows[rows.len() - 1].error <= wanted {
            break;
        }
        (too_few, samples) = (samples, 4 * samples);
    }
    let mut enough = samples;
    while enough <= MOST && enough - too_few > 1 && f64::from(enough) > FINE * f64::from(too_few) {
        let between = (f64::from(too_few.max(1)) * f64::from(enough)).sqrt() as u32;
        let row = measured(between.clamp(too_few + 1, enough - 1))?;
        *(if row.error <= wanted { &mut enough } else { &mut too_few }) = row.samples;
        rows.push(row);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that fall with the moments: `needed` are enough.
    fn fewest(needed: u32) -> Option<u32> {
        let row = |samples| Ok(Row { samples, milliseconds: 1.0, error: 1.0 / f64::from(samples) });
        let rows = bisected(1.0 / f64::from(needed), row).expect("rows");
        assert!(rows.len() < 14, "{needed}: {}", rows.len());
        rows.iter().filter(|row| row.samples >= needed).map(|row| row.samples).min()
    }

    #[test]
    fn bisection_finds_the_fewest_moments_that_are_enough() {
        for needed in [1, 2, 3, 5, 17, 63, 64, 65, 700, 4096] {
            let found = fewest(needed).expect("enough");
            assert!(f64::from(found) <= FINE * f64::from(needed) + 1.0, "{needed}: {found}");
        }
        assert_eq!(fewest(MOST + 1), None);
    }
}
