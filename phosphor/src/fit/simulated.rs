//! A laboratory that measures a material that is known: the thesis' procedure (section 8.4) with its camera's
//! noise, made of steps of the rate equation.

use super::measurement::{Charged, Exposure, Filtered, Measurement, Shot};
use crate::curves::Curves;
use crate::noise::Noise;
use crate::simulation::{Simulation, SimulationError};
use deepshade_glow::material::Material;
use deepshade_glow::spectrum::lights::Light;
use deepshade_glow::spectrum::{Axis, Bands};

/// In how many parts the light of an open shutter is summed, by Simpson's rule.
const PARTS: usize = 8;
/// Electrons of a pixel that is full at ISO 100, and the electrons of noise that reading one adds.
const FULL_WELL: f64 = 60_000.0;
const READ_NOISE: f64 = 10.0;
/// The f-number of all photographs.
const F_NUMBER: f64 = 2.8;
const HIGHEST_ISO: f64 = 6400.0;

/// How a material is measured.
#[derive(Clone, Debug)]
pub struct Laboratory {
    /// The camera's red, green and blue.
    pub sensor: Curves,
    /// The places of a linear variable filter.
    pub filters: Curves,
    /// The lamp.
    pub lamp: Light,
    /// From lamp off to the first open shutter, in seconds.
    pub delay: f64,
    /// From lamp off to the open shutter where a filter has to swing away (section 8.4.6), in seconds.
    pub charged_delay: f64,
    /// Between photographs of a decay, in seconds, and their number.
    pub interval: f64,
    /// The number of photographs of a decay.
    pub count: usize,
    /// How long the shutter is open, in seconds.
    pub open: f64,
    /// How long the lamp is on in each photograph of excitation, in seconds.
    pub charges: Vec<f64>,
    /// How many of the first bands excite.
    pub excited: usize,
    /// Over how many pixels a photograph is averaged.
    pub pixels: f64,
}

impl Laboratory {
    /// As in the thesis: a photograph every 5 s for 180 s, 31 places of the filter, a halogen lamp, twice the
    /// time of light with each photograph of excitation, 280 ms until the filter is away.
    pub fn thesis() -> Self {
        Self {
            sensor: Curves::nominal_sensor(),
            filters: Curves::variable_filter(31),
            lamp: Light::Halogen,
            delay: 0.005,
            charged_delay: 0.28,
            interval: 5.0,
            count: 37,
            open: 1.0,
            charges: (0..11).map(|power| f64::from(1 << power)).collect(),
            excited: 3,
            pixels: 1000.0,
        }
    }

    /// What is measured of a material of eight bands, with the noise of a seed. Excitation is left out of
    /// materials whose excitation nobody knows.
    ///
    /// # Errors
    /// If the material makes no sense, is not of eight bands or sends nothing.
    pub fn measure(&self, material: &Material, seed: u64) -> Result<Measurement, SimulationError> {
        if material.bands != Bands::Eight {
            return Err(SimulationError(format!(
                "{}: described in RGB; materials of eight bands are measured",
                material.name
            )));
        }
        let axis = Axis::EIGHT;
        let [red, green, blue] = [0, 1, 2].map(|channel| self.sensor.bands(axis)[channel].clone());
        let mut measurement = Measurement {
            bands: Bands::Eight,
            sensor: [red, green, blue],
            filters: self.filters.bands(axis),
            light: of_length_one(self.lamp.spectrum(axis)),
            decay: Vec::new(),
            spectrum: Vec::new(),
            excitation: Vec::new(),
            noise_is_known: true,
            checker: None,
        };
        let full = vec![1.0; material.states.len()];
        let open_to = vec![1.0; axis.count];
        let seen = |filter: &[f64], shares: &[f64], delay: f64| {
            self.seen(material, &measurement.sensor, filter, shares, delay)
        };
        let decay: Vec<(f64, [f64; 3])> = (0..self.count)
            .map(|i| self.delay + i as f64 * self.interval)
            .map(|delay| Ok((delay, seen(&open_to, &full, delay)?)))
            .collect::<Result<_, SimulationError>>()?;
        let through = |filter: &Vec<f64>| seen(filter, &full, self.delay);
        let spectrum: Vec<[f64; 3]> = measurement.filters.iter().map(through).collect::<Result<_, _>>()?;
        let mut charged = Vec::new();
        let excited = if material.excitation_is_known() { self.excited } else { 0 };
        // Light that the lamp lacks excites nothing.
        for band in (0..excited).filter(|band| measurement.light[*band] > 0.0) {
            for seconds in &self.charges {
                let shares = charged_shares(material, &measurement.light, band, *seconds)?;
                charged.push((band, *seconds, seen(&open_to, &shares, self.charged_delay)?));
            }
        }
        let brightest = decay[0].1.into_iter().fold(0.0, f64::max);
        if brightest <= 0.0 {
            let fault = "sends no light that the camera sees, not even where all is excited";
            return Err(SimulationError(format!("{}: {fault}", material.name)));
        }
        let mut camera = Camera { brightest, open: self.open, pixels: self.pixels, noise: Noise::new(seed) };
        measurement.decay = decay.into_iter().map(|(delay, seen)| camera.shot(delay, seen)).collect();
        measurement.spectrum = (0..)
            .zip(spectrum)
            .map(|(filter, seen)| Filtered { filter, shot: camera.shot(self.delay, seen) })
            .collect();
        measurement.excitation = charged
            .into_iter()
            .map(|(band, seconds, seen)| Charged {
                band,
                seconds,
                shot: camera.shot(self.charged_delay, seen),
            })
            .collect();
        Ok(measurement)
    }

    /// What the camera's channels see in the mean while the shutter is open, `delay` seconds into the dark.
    fn seen(
        &self,
        material: &Material,
        sensor: &[Vec<f64>; 3],
        filter: &[f64],
        shares: &[f64],
        delay: f64,
    ) -> Result<[f64; 3], SimulationError> {
        let dark = vec![0.0; filter.len()];
        let mut run = Simulation { material, shares: shares.to_vec() };
        run.step(&dark, delay)?;
        let mut seen = [0.0; 3];
        for part in 0..=PARTS {
            let weight = if part == 0 || part == PARTS { 1.0 } else { 2.0 + 2.0 * (part % 2) as f64 };
            let light = run.emission();
            for (seen, channel) in seen.iter_mut().zip(sensor) {
                let sum: f64 = channel.iter().zip(filter).zip(&light).map(|((a, b), c)| a * b * c).sum();
                *seen += weight / (3 * PARTS) as f64 * sum;
            }
            run.step(&dark, self.open / PARTS as f64)?;
        }
        Ok(seen)
    }
}

/// The camera of one series: its aperture is such that the brightest photograph fills half of what a pixel
/// holds.
struct Camera {
    brightest: f64,
    open: f64,
    pixels: f64,
    noise: Noise,
}

impl Camera {
    /// A photograph, at the ISO that brings its brightest channel to between an eighth and a quarter, if
    /// there is one.
    fn shot(&mut self, delay: f64, seen: [f64; 3]) -> Shot {
        let share = seen.map(|seen| 0.5 * seen / self.brightest);
        let brightest = share.into_iter().fold(0.0, f64::max);
        let mut iso = 100.0;
        while brightest * iso / 100.0 < 0.125 && iso < HIGHEST_ISO {
            iso *= 2.0;
        }
        let exposure = Exposure::of_camera(self.open, iso, F_NUMBER);
        let per_electron = |share: f64| {
            let electrons = share * FULL_WELL;
            (electrons + READ_NOISE * READ_NOISE).sqrt() / FULL_WELL / self.pixels.sqrt()
        };
        let noise = share.map(|share| per_electron(share) * 2.0 * self.brightest * exposure.gain);
        let value = std::array::from_fn(|c| seen[c] * exposure.gain + noise[c] * self.noise.normal());
        Shot { delay, exposure, value, noise }
    }
}

/// Shares after light of one band on what had been dark.
fn charged_shares(
    material: &Material,
    light: &[f64],
    band: usize,
    seconds: f64,
) -> Result<Vec<f64>, SimulationError> {
    let mut only = vec![0.0; light.len()];
    only[band] = light[band];
    let mut run = Simulation::dark(material);
    run.step(&only, seconds)?;
    Ok(run.shares)
}

/// A spectrum scaled to length 1, as the thesis' lamp is (section 8.4.6).
pub fn of_length_one(spectrum: Vec<f64>) -> Vec<f64> {
    let length = spectrum.iter().map(|value| value * value).sum::<f64>().sqrt();
    spectrum.into_iter().map(|value| value / length).collect()
}
