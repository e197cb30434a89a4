//! The light of a place from frame to frame, and what a material makes of it.

use crate::simulation::{Simulation, SimulationError};
use deepshade_glow::material::{Material, is_amount};
use deepshade_glow::paint::LightInterval;
use deepshade_glow::spectrum::Bands;
use deepshade_glow::spectrum::lights::Light;
use deepshade_shaders::colour::luminance;

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
    /// Radiance that the place reflects as each frame begins, linear RGB, where that is part of what is
    /// wanted; else none.
    reflected: Vec<[f64; 3]>,
    /// The spectrum of all lamps for what is sought, whose colours then say how bright they are and no more.
    lamp: Option<Light>,
}

impl FrameLight {
    /// That of a place's light, one after the other from `begin` on, for so many seconds, above 0. Afterwards
    /// it is dark.
    pub fn new(begin: f64, seconds: f64, history: &[LightInterval]) -> Self {
        let dt = seconds / FRAMES as f64;
        let lit = with_ends(history);
        let irradiance = (0..FRAMES).map(|frame| mean(&lit, frame as f64 * dt, dt)).collect();
        Self { begin, dt, irradiance, reflected: Vec::new(), lamp: None }
    }

    /// The same for materials under lamps of a spectrum.
    #[must_use]
    pub fn under(self, lamp: Option<Light>) -> Self {
        Self { lamp, ..self }
    }

    /// The same of a place of which what it reflects is wanted, too: radiance, one after the other as light
    /// is.
    #[must_use]
    pub fn reflecting(self, seconds: f64, radiance: &[LightInterval]) -> Self {
        let (lit, dt) = (with_ends(radiance), seconds / FRAMES as f64);
        let at = |moment: f64| {
            let now = lit.iter().find(|([from, to], _)| (*from..*to).contains(&(moment + WHOLE * dt)));
            now.map_or([0.0; 3], |(_, colour)| *colour)
        };
        Self { reflected: (0..FRAMES).map(|frame| at(frame as f64 * dt)).collect(), ..self }
    }

    /// Radiance that the place reflects in each frame, as far as that is wanted.
    pub fn reflected(&self) -> Vec<[f64; 3]> {
        let mut all = self.reflected.clone();
        all.resize(FRAMES, [0.0; 3]);
        all
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

    /// Irradiance of each frame in bands, of lamps of the spectrum.
    pub(super) fn in_bands(&self, bands: Bands) -> Vec<Vec<f64>> {
        let lamp = self.lamp.map(|lamp| lamp.of_luminance_one(bands));
        let in_bands = |light: &[f64; 3]| match &lamp {
            Some(lamp) => {
                let brightness = f64::from(luminance(light.map(|part| part as f32)));
                lamp.iter().map(|part| brightness * part).collect()
            }
            None => bands.of_linear_srgb(*light),
        };
        self.irradiance.iter().map(in_bands).collect()
    }

    /// What is seen of a place of a material in each frame, linear RGB radiance: what it gives back under
    /// lamps as they are coloured, and reflects.
    ///
    /// # Errors
    /// If it was never measured how light excites it.
    pub fn glow(&self, material: &Material) -> Result<Vec<[f64; 3]>, SimulationError> {
        self.clone().under(None).designed(material)
    }

    /// The same under lamps of the spectrum.
    ///
    /// # Errors
    /// As [`Self::glow`].
    pub(super) fn designed(&self, material: &Material) -> Result<Vec<[f64; 3]>, SimulationError> {
        let mut run = Simulation::dark(material);
        let frame = |(light, reflected): (Vec<f64>, [f64; 3])| {
            let sent = material.bands.linear_srgb(&run.emission());
            run.step(&light, self.dt)?;
            Ok([0, 1, 2].map(|channel| sent[channel] + reflected[channel]))
        };
        self.in_bands(material.bands).into_iter().zip(self.reflected()).map(frame).collect()
    }
}

/// Light with the times from when to when it lasts, seconds from the beginning on.
fn with_ends(history: &[LightInterval]) -> Vec<([f64; 2], [f64; 3])> {
    let ends = history.iter().scan(0.0, |at, lit| {
        let from = *at;
        *at += f64::from(lit.seconds);
        Some(([from, *at], lit.irradiance.to_array().map(amount)))
    });
    ends.collect()
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
