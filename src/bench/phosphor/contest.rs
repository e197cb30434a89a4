//! States beside moments of the past in images, at equal quality and in equal time, as in the thesis' Figure 8.16.
//!
//! The lamp is faint, so that nothing saturates and both have the same mean; errors are relative squared errors against
//! truth under one exposure, those of shadow maps included.

use super::cornell::{BRIGHT, OFF};
use super::subject::Subject;
use crate::arguments::Size;
use crate::figures::Figures;
use anyhow::Result;
use deepshade_render::methods::Quality;
use deepshade_render::methods::phosphor::glassner::{Glassner, Parameters as Moments};
use deepshade_render::methods::phosphor::{Parameters, RateEquation};
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes};
use serde_json::{Value, json};

/// How much fainter the lamp is than one that the walls take in well.
const FAINT: f32 = 1e-4;
/// Seconds after the lamp has gone out.
const AFTER: f32 = 5.0;
/// Moments that are drawn at most.
const MOST: u32 = 4096;
/// Quality is equal where the integral's error is no larger than this times that of states.
const EQUAL: f64 = 1.1;

/// A method's image: how many moments, milliseconds, error.
struct Row {
    samples: u32,
    milliseconds: f64,
    error: f64,
}

/// What was measured.
pub struct Contest {
    size: Size,
    states: Row,
    moments: Vec<Row>,
}

impl Contest {
    /// Measures it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, size: Size, runs: usize) -> Result<Self> {
        let mut subject = Subject::new(gpu, size, FAINT * BRIGHT, false)?;
        let moment = OFF + AFTER;
        let truth = subject.truth(Effect::Phosphor, moment, 8)?;
        let scale = exposure(Effect::Phosphor, &truth);
        let right = exposed(&truth, scale);
        let error = |image: &Planes| relative_mse(&exposed(image, scale), &right);
        let plan = subject.plan(&RateEquation::new(gpu, Parameters::of(Quality::High))?)?;
        subject.make(moment, &[&plan])?;
        let (milliseconds, wrong) = (subject.milliseconds(&plan, runs)?, error(&subject.image(&plan)?));
        let states = Row { samples: 0, milliseconds, error: wrong };
        let (mut moments, mut samples): (Vec<Row>, u32) = (Vec::new(), 1);
        while samples <= MOST {
            let plan = subject.plan(&Glassner::new(gpu, Moments { samples })?)?;
            let milliseconds = subject.milliseconds(&plan, runs)?;
            let row = Row { samples, milliseconds, error: error(&subject.image(&plan)?) };
            let is_equal = row.error <= EQUAL * states.error;
            moments.push(row);
            if is_equal {
                break;
            }
            samples *= 4;
        }
        Ok(Self { size, states, moments })
    }

    /// The first of equal quality.
    fn equal_quality(&self) -> Option<&Row> {
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
