//! What is measured of a material: photographs of its light, in the dark and after light.

use super::FitError;
use super::checker::Checker;
use deepshade_glow::spectrum::Bands;

/// A step of a photograph with 16 bits.
const STEP: f64 = 1.0 / 65_535.0;
/// Light that grows by so many standard errors, and by this share of it, is no decay: cameras and lamps drift
/// by less.
const GROWN: f64 = 5.0;
const GROWN_SHARE: f64 = 0.05;

/// How a photograph was exposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// How long the shutter was open, in seconds.
    pub seconds: f64,
    /// What a radiance of 1 gives a pixel.
    pub gain: f64,
}

impl Exposure {
    /// The relative gain that camera settings stand for: seconds times ISO / 100 over the squared f-number.
    /// Cameras keep to them within some per cent; [`relative_gain`] measures what they really do.
    pub fn of_camera(seconds: f64, iso: f64, f_number: f64) -> Self {
        Self { seconds, gain: seconds * iso / 100.0 / (f_number * f_number) }
    }
}

/// A linear RGB photograph of a material's light, averaged over its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Seconds from when the light went off to when the shutter opened.
    pub delay: f64,
    /// How it was exposed.
    pub exposure: Exposure,
    /// The mean pixel: linear red, green and blue of the camera.
    pub value: [f64; 3],
    /// The standard error of `value`. Intervals follow from what the fit leaves, so that only ratios of
    /// noises matter.
    pub noise: [f64; 3],
}

/// A photograph through a filter, of the same decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filtered {
    /// Which filter of [`Measurement::filters`].
    pub filter: usize,
    /// The photograph.
    pub shot: Shot,
}

/// A photograph after light of one band on a material that had been dark for long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charged {
    /// Which band.
    pub band: usize,
    /// How long the light was on.
    pub seconds: f64,
    /// The photograph.
    pub shot: Shot,
}

/// Measurements of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The bands that it is to be described in.
    pub bands: Bands,
    /// The camera's channels: how strongly each sees each band. Where the material is described in the
    /// camera's own RGB, ones on the diagonal.
    pub sensor: [Vec<f64>; 3],
    /// What each filter lets through of each band.
    pub filters: Vec<Vec<f64>>,
    /// The lamp's irradiance in each band; the thesis scales it to length 1 (section 8.4.6).
    pub light: Vec<f64>,
    /// The decay after so much light that all states are full (section 8.4.4).
    pub decay: Vec<Shot>,
    /// The same decay through filters, which tells the spectrum. Not needed in RGB.
    pub spectrum: Vec<Filtered>,
    /// Excitation; none if it was not measured.
    pub excitation: Vec<Charged>,
    /// Whether the noise of all photographs is known, not taken for something.
    pub noise_is_known: bool,
    /// What made linear sRGB of the camera's colours, where there was a colour chart.
    pub checker: Option<Checker>,
}

impl Shot {
    /// The mean of the pixels that a mask leaves, of a linear RGB photograph, and its standard error.
    ///
    /// # Errors
    /// If the mask has another size or leaves fewer than two pixels, or one that it leaves is not finite; in
    /// words.
    pub fn of_pixels(
        delay: f64,
        exposure: Exposure,
        pixels: &[[f64; 3]],
        mask: &[bool],
    ) -> Result<Self, String> {
        if mask.len() != pixels.len() {
            return Err(format!("a mask of {} pixels for a photograph of {}", mask.len(), pixels.len()));
        }
        let seen: Vec<usize> = (0..pixels.len()).filter(|index| mask[*index]).collect();
        if seen.len() < 2 {
            return Err(format!("the mask leaves {} pixels, at least 2 are needed", seen.len()));
        }
        if let Some(index) = seen.iter().find(|index| !pixels[**index].iter().all(|value| value.is_finite()))
        {
            return Err(format!("pixel {index} is not finite"));
        }
        let count = seen.len() as f64;
        let value = std::array::from_fn(|c| seen.iter().map(|index| pixels[*index][c]).sum::<f64>() / count);
        let noise = std::array::from_fn(|c: usize| {
            let off: f64 = seen.iter().map(|index| (pixels[*index][c] - value[c]).powi(2)).sum();
            // Nobody knows a mean better than its steps, even where all pixels are alike.
            (off / (count - 1.0) / count).sqrt().max(STEP / (12.0 * count).sqrt())
        });
        Ok(Self { delay, exposure, value, noise })
    }

    /// The mean radiance while the shutter was open, as the camera sees it.
    pub fn radiance(&self) -> [f64; 3] {
        self.value.map(|value| value / self.exposure.gain)
    }

    /// The standard error of [`Self::radiance`].
    pub fn radiance_noise(&self) -> [f64; 3] {
        self.noise.map(|noise| noise / self.exposure.gain)
    }

    /// The part of light that decays at a rate, 1 where it went off, that it has in the mean while the
    /// shutter is open.
    pub fn decayed(&self, rate: f64) -> f64 {
        (-rate * self.delay).exp() * filled(rate, self.exposure.seconds) / self.exposure.seconds
    }

    fn makes_sense(&self) -> bool {
        let above = |value: f64| value.is_finite() && value > 0.0;
        let delay = self.delay.is_finite() && self.delay >= 0.0;
        let values = self.value.iter().all(|value| value.is_finite());
        delay
            && values
            && above(self.exposure.seconds)
            && above(self.exposure.gain)
            && self.noise.into_iter().all(above)
    }
}

/// `(1 - exp(-rate seconds)) / rate`, for any rate, 0 and negative ones too.
pub fn filled(rate: f64, seconds: f64) -> f64 {
    if (rate * seconds).abs() < 1e-12 { seconds } else { -(-rate * seconds).exp_m1() / rate }
}

/// How many times as strong the values of one photograph are as those of another of the same thing: the
/// relative calibration of two camera settings (thesis, section 8.4.1). Values are means of patches; those of
/// both lists belong together. None if the first list is dark, or there are fewer than two values.
pub fn relative_gain(reference: &[f64], other: &[f64]) -> Option<f64> {
    let square: f64 = reference.iter().map(|value| value * value).sum();
    let is_told = square > 0.0 && reference.len() >= 2 && reference.len() == other.len();
    is_told.then(|| reference.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / square)
}

/// The mean radiance of photographs, of all channels together, and its standard error: the stated one, or
/// that by which they scatter if it is larger.
fn brightness(shots: &[Shot]) -> (f64, f64) {
    let count = shots.len() as f64;
    let values: Vec<f64> = shots.iter().map(|shot| shot.radiance().iter().sum()).collect();
    let mean = values.iter().sum::<f64>() / count;
    let stated: f64 = shots.iter().flat_map(Shot::radiance_noise).map(|noise| noise * noise).sum();
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let scattered = squares * count / (count - 1.0).max(1.0);
    (mean, stated.max(scattered).sqrt() / count)
}

impl Measurement {
    /// The bands that excitation was measured of, ascending.
    pub(super) fn measured_bands(&self) -> Vec<usize> {
        (0..self.excited_bands()).filter(|band| self.excites(*band)).collect()
    }

    /// The bands that excitation was not measured of, ascending.
    pub(super) fn unmeasured_bands(&self) -> Vec<usize> {
        (0..self.bands.count()).filter(|band| !self.excites(*band)).collect()
    }

    fn excites(&self, band: usize) -> bool {
        self.excitation.iter().any(|charged| charged.band == band)
    }

    /// Up to which band excitation was measured, not necessarily of all.
    pub fn excited_bands(&self) -> usize {
        self.excitation.iter().map(|charged| charged.band + 1).max().unwrap_or(0)
    }

    /// Whether there is enough, in the right form, for so many states.
    pub(super) fn check(&self, states: usize) -> Result<(), FitError> {
        self.check_form()?;
        let enough = |what, count, least| {
            if count < least { Err(FitError::TooFew { what, count, least }) } else { Ok(()) }
        };
        enough("decay", self.decay.len(), 2 * states + 1)?;
        if self.bands != Bands::Rgb {
            enough("spectrum", self.spectrum.len(), self.bands.count().div_ceil(3))?;
        }
        for band in self.measured_bands() {
            let count = self.excitation.iter().filter(|charged| charged.band == band).count();
            enough("excitation by a band", count, states + 1)?;
        }
        self.check_decay()
    }

    /// Whether light does not grow in the dark by more than noise, and some per cent, leave open.
    fn check_decay(&self) -> Result<(), FitError> {
        let third = self.decay.len() / 3;
        // One photograph does not show the noise that nobody stated.
        if third < 2 && !self.noise_is_known {
            return Ok(());
        }
        let (first, first_error) = brightness(&self.decay[..third]);
        let (last, last_error) = brightness(&self.decay[self.decay.len() - third..]);
        let grows = last - first > (GROWN * first_error.hypot(last_error)).max(GROWN_SHARE * first);
        if grows { Err(FitError::Grows { first, last }) } else { Ok(()) }
    }

    fn check_form(&self) -> Result<(), FitError> {
        let bands = self.bands.count();
        let lists = self.sensor.iter().chain(&self.filters).chain([&self.light]);
        for list in lists {
            if list.len() != bands || !list.iter().all(|value| value.is_finite() && *value >= 0.0) {
                let fault = format!(
                    "{list:?} of a sensor, filter or light is not {bands} numbers that are at least 0"
                );
                return Err(FitError::Measurement(fault));
            }
        }
        let fault = |text: String| Err(FitError::Measurement(text));
        let filtered = self.spectrum.iter().map(|filtered| &filtered.shot);
        let charged = self.excitation.iter().map(|charged| &charged.shot);
        if let Some(shot) = self.decay.iter().chain(filtered).chain(charged).find(|shot| !shot.makes_sense())
        {
            return fault(format!("{shot:?} has a number that is not finite, or no exposure, gain or noise"));
        }
        if let Some(filtered) = self.spectrum.iter().find(|filtered| filtered.filter >= self.filters.len()) {
            return fault(format!("filter {}: there are {}", filtered.filter + 1, self.filters.len()));
        }
        let dark = |charged: &&Charged| charged.band >= bands || self.light[charged.band] <= 0.0;
        if let Some(charged) = self.excitation.iter().find(dark) {
            return fault(format!("excitation by band {}: no light has it", charged.band + 1));
        }
        if let Some(charged) = self.excitation.iter().find(|c| !c.seconds.is_finite() || c.seconds < 0.0) {
            return fault(format!("{} seconds of excitation", charged.seconds));
        }
        Ok(())
    }
}
