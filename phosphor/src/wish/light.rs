//! The light of a place from frame to frame, and what a material makes of it.

use crate::simulation::{Simulation, SimulationError};
use deepshade_glow::material::{Material, is_amount};
use deepshade_glow::paint::LightInterval;
use deepshade_glow::spectrum::Bands;

/// Frames of a curve.
pub const FRAMES: usize = 200;
/// A frame that one light fills but for this share has that light, bit for bit.
const WHOLE: f64 = 1e-6;

/// The light of a place that was in the dark before, in [`FRAMES`] frames.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameLight {
    /// When the first frame is, seconds.
    begin: f64,
    /// From frame to frame, seconds.
    dt: f64,
    /// Mean irradiance from each frame to the next, linear RGB, W/m².
    irradiance: Vec<[f64; 3]>,
}

impl FrameLight {
    /// That of a place's light, one after the other from `begin` on, for so many seconds, above 0. Afterwards
    /// it is dark.
    pub fn new(begin: f64, seconds: f64, history: &[LightInterval]) -> Self {
        let dt = seconds / FRAMES as f64;
        let mut ends = Vec::with_capacity(history.len());
        let mut at = 0.0;
        for lit in history {
            let from = at;
            at += f64::from(lit.seconds);
            ends.push(([from, at], lit.irradiance.to_array().map(amount)));
        }
        let irradiance = (0..FRAMES).map(|frame| mean(&ends, frame as f64 * dt, dt)).collect();
        Self { begin, dt, irradiance }
    }

    /// When a frame is, seconds.
    pub fn seconds(&self, frame: usize) -> f64 {
        self.begin + frame as f64 * self.dt
    }

    /// The frame next to a moment, seconds.
    pub fn frame(&self, seconds: f64) -> usize {
        (((seconds - self.begin) / self.dt).round().max(0.0) as usize).min(FRAMES - 1)
    }

    /// From frame to frame, seconds.
    pub const fn dt(&self) -> f64 {
        self.dt
    }

    /// Whether no light comes in any frame.
    pub fn is_dark(&self) -> bool {
        self.irradiance.iter().flatten().all(|light| *light == 0.0)
    }

    /// Irradiance of each frame in bands.
    pub(super) fn in_bands(&self, bands: Bands) -> Vec<Vec<f64>> {
        self.irradiance.iter().map(|light| bands.of_linear_srgb(*light)).collect()
    }

    /// What a material gives back in each frame, linear RGB radiance.
    ///
    /// # Errors
    /// If it was never measured how light excites it.
    pub fn glow(&self, material: &Material) -> Result<Vec<[f64; 3]>, SimulationError> {
        let mut run = Simulation::dark(material);
        let frame = |light: Vec<f64>| {
            let sent = material.bands.linear_srgb(&run.emission());
            run.step(&light, self.dt)?;
            Ok(sent)
        };
        self.in_bands(material.bands).into_iter().map(frame).collect()
    }
}

/// The mean light of the time `dt` from `from` on.
fn mean(lit: &[([f64; 2], [f64; 3])], from: f64, dt: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for ([begin, end], light) in lit {
        let share = (end.min(from + dt) - begin.max(from)) / dt;
        if share > 1.0 - WHOLE {
            return *light;
        }
        if share > WHOLE {
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += share * light);
        }
    }
    sum
}

/// What is no amount of light is none.
fn amount(light: f32) -> f64 {
    let light = f64::from(light);
    if is_amount(light) { light } else { 0.0 }
}
