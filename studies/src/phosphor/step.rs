//! What a step of as many texels as in the thesis' Figure 8.1 takes, shadow-mapped irradiance included, and
//! which share of the device's copy bandwidth it moves.

use super::cornell::{BRIGHT, OFF};
use super::subject::GlowingRoom;
use crate::cards::{GTX_770, Timed};
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade_render::methods::phosphor::RateEquationParameters;
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::{self, Gpu};

/// Texels of the thesis' figure, and what it took with them.
const TEXELS: f64 = 4.7e6;
const THESIS: Timed = Timed { milliseconds: 3.4, at_best: GTX_770 };
/// Bytes that its step reads and writes of a texel at least: a state both ways.
const THESIS_BYTES: f64 = 8.0;
/// How far from that the lattices of triangles may be.
const NEAR: f64 = 0.01;
/// Texels along the diagonal of a first guess.
const GUESS: f64 = 500.0;
/// Bytes that a step reads and writes of a texel: a state and what rounding left of it both ways, and which
/// tile it is of.
const BYTES: f64 = 20.0;

/// What was measured.
pub struct StepCost {
    milliseconds: f64,
    texels: usize,
    bandwidth_share: f64,
}

impl StepCost {
    /// Measures it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, runs: usize) -> Result<Self> {
        let mut subject =
            GlowingRoom::new(gpu, Size { width: 64, height: 64 }, BRIGHT, true, vec![[0.0, OFF]])?;
        let mut across = GUESS;
        let (mut milliseconds, mut texels) = (0.0, 0);
        // Texels are as the square of how many are along the diagonal, but for rounding.
        for _ in 0..4 {
            let passes =
                subject.passes(&ScreenMethod::new(gpu, RateEquationParameters::exact(across as u32)))?;
            subject.make(0.0, &[&passes])?;
            subject.make(1.0 / 60.0, &[&passes])?;
            (milliseconds, texels) = subject.step(&passes, runs)?;
            let ratio = TEXELS / texels as f64;
            if (ratio - 1.0).abs() < NEAR {
                break;
            }
            across *= ratio.sqrt();
        }
        let at_best = gpu::ceilings(&gpu.device, &gpu.queue)?;
        let bandwidth_share = Timed { milliseconds, at_best }.share_of_copy(BYTES * texels as f64);
        Ok(Self { milliseconds, texels, bandwidth_share })
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        let per_second = self.texels as f64 / (1e-3 * self.milliseconds);
        figures.set("ms_step_4_7m", self.milliseconds);
        figures.set("texels", self.texels as f64);
        figures.set("texels_per_second", per_second);
        figures.set("bandwidth_share", self.bandwidth_share);
        figures.set("bandwidth_share_thesis", THESIS.share_of_copy(THESIS_BYTES * TEXELS));
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let Self { milliseconds, texels, bandwidth_share } = self;
        format!(
            "a step of {texels} texels with shadow-mapped irradiance: {milliseconds:.2} ms, {:.1} % of copy \
             bandwidth (thesis: {:.1} %)",
            100.0 * bandwidth_share,
            100.0 * THESIS.share_of_copy(THESIS_BYTES * TEXELS)
        )
    }
}
