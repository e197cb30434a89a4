//! Photographs of a measurement, and how strongly each setting of the camera really exposes (thesis, section
//! 8.4.1).
//!
//! Photographs are linear RGB: EXR files, or PNG files of 16 bits whose values are taken as they are, without
//! a transfer curve; those whose values are 8 bits made wider are refused. Where a folder has `mask.png`, its
//! bright pixels are those of the material. `calibration.csv` lists photographs of one thing in steady light
//! under different settings: `file`, `exposure_s`, `iso`, `f_number`. What cameras do is not quite what their
//! dials say; with that list gains are those that were measured, without it all photographs must have one ISO
//! and f-number. Shutters are taken to keep their times: what photographs of one ISO and f-number say, under
//! whatever times, is averaged, and refused where they say different things.

use super::measurement::{Exposure, Shot, relative_gain};
use crate::table::{Table, TableError};
use deepshade_shaders::Planes;
use image::DynamicImage;
use std::error::Error;
use std::path::{Path, PathBuf};

/// The list of photographs that tells what settings do.
const CALIBRATION: &str = "calibration.csv";
/// Side of the patches, in pixels, whose means are compared.
const PATCH: usize = 8;
/// A channel at this share of what a file of 16 bits holds is full.
const FULL: f64 = 0.999;
/// What is wrong then.
const LOST: &str = "a pixel is full: what it would have had is lost; expose less";
/// Settings are the same within this part.
const SAME: f64 = 1e-6;
/// By how much of it photographs of one setting may disagree on what it does: shutters keep their times, and
/// light is steady, within some per cent.
const AGREE: f64 = 0.05;

/// What reads an EXR file's one picture, `[3, height, width]`: whoever reads measurements brings it.
pub type ExrReader = fn(&Path) -> Result<Planes, Box<dyn Error + Send + Sync>>;

/// Why photographs cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PhotographsError {
    /// A table is at fault.
    #[error("a list of photographs")]
    Table(#[from] TableError),
    /// An EXR file cannot be read.
    #[error("a photograph")]
    Exr(#[source] Box<dyn Error + Send + Sync>),
    /// Another file cannot be read.
    #[error("{}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// It makes no sense; in words.
    #[error("{}: {what}", path.display())]
    Sense {
        /// The file.
        path: PathBuf,
        /// What.
        what: String,
    },
}

/// A photograph.
struct Photograph {
    path: PathBuf,
    height: usize,
    width: usize,
    pixels: Vec<[f64; 3]>,
}

/// The photographs of a folder: which pixels count, and what its camera's settings do.
pub struct Photographs {
    folder: PathBuf,
    exr: ExrReader,
    mask: Option<Photograph>,
    is_calibrated: bool,
    /// ISO, f-number, and how many times as strongly they expose as they say; without a calibration that of
    /// the first photograph.
    settings: Vec<([f64; 2], f64)>,
}

impl Photographs {
    /// Those of a folder.
    ///
    /// # Errors
    /// If its mask or its calibration cannot be read or makes no sense.
    pub fn new(folder: &Path, exr: ExrReader) -> Result<Self, PhotographsError> {
        let mut photographs =
            Self { folder: folder.into(), exr, mask: None, is_calibrated: false, settings: Vec::new() };
        let mask = folder.join("mask.png");
        if mask.exists() {
            photographs.mask = Some(Photograph::of_any_depth(&mask)?);
        }
        let calibration = folder.join(CALIBRATION);
        if calibration.exists() {
            photographs.is_calibrated = true;
            photographs.settings = photographs.calibrated(&Table::read(&calibration)?)?;
        }
        Ok(photographs)
    }

    /// A photograph as its mean pixel, `delay` seconds after light.
    ///
    /// # Errors
    /// If the file cannot be read, is full or not as large as the mask, or its settings were not calibrated
    /// and others were, or are those of photographs before.
    pub fn shot(
        &mut self,
        file: &str,
        delay: f64,
        [seconds, iso, f_number]: [f64; 3],
    ) -> Result<Shot, PhotographsError> {
        let photograph = Photograph::read(&self.folder.join(file), self.exr)?;
        let exposure = self.exposure(&photograph.path, [seconds, iso, f_number])?;
        let seen = self.seen(&photograph)?;
        Shot::of_pixels(delay, exposure, &photograph.pixels, &seen)
            .map_err(|what| PhotographsError::Sense { path: photograph.path, what })
    }

    /// How a photograph was exposed.
    fn exposure(
        &mut self,
        path: &Path,
        [seconds, iso, f_number]: [f64; 3],
    ) -> Result<Exposure, PhotographsError> {
        let mut exposure = Exposure::of_camera(seconds, iso, f_number);
        if self.settings.is_empty() {
            self.settings.push(([iso, f_number], 1.0));
        }
        let Some((_, factor)) = self.settings.iter().find(|of| same(of.0, [iso, f_number])) else {
            return Err(PhotographsError::Sense { path: path.into(), what: self.unknown([iso, f_number]) });
        };
        exposure.gain *= factor;
        Ok(exposure)
    }

    /// The mean radiance of rectangles of photographs, each with seconds, ISO and f-number, and left, top,
    /// width and height in pixels. The mask does not count: it is of the material. Without a calibration
    /// their settings must be the same, but not those of other photographs, beside which only the unit of
    /// brightness would be off.
    ///
    /// # Errors
    /// As of [`Self::shot`], and if a rectangle is not in its photograph, or not finite there.
    pub(super) fn areas(
        &mut self,
        areas: &[(&str, [f64; 3], [usize; 4])],
    ) -> Result<Vec<[f64; 3]>, PhotographsError> {
        // A chart is one photograph as a rule.
        let mut last: Option<(&str, Photograph)> = None;
        let mut means = Vec::with_capacity(areas.len());
        for (file, settings, rectangle) in areas {
            let photograph = match last.take() {
                Some((name, photograph)) if name == *file => photograph,
                _ => Photograph::read(&self.folder.join(file), self.exr)?,
            };
            let Exposure { gain, .. } = self.exposure(&photograph.path, *settings)?;
            means.push(photograph.mean(*rectangle)?.map(|value| value / gain));
            last = Some((*file, photograph));
        }
        if !self.is_calibrated {
            self.settings.clear();
        }
        Ok(means)
    }

    /// What is wrong with a photograph whose settings are not among those that are known.
    fn unknown(&self, [iso, f_number]: [f64; 2]) -> String {
        if self.is_calibrated {
            return format!("ISO {iso} at f/{f_number} is not in {CALIBRATION}, as other settings are");
        }
        let [first_iso, first_f_number] = self.settings[0].0;
        format!(
            "is of ISO {iso} at f/{f_number}, others are of ISO {first_iso} at f/{first_f_number}, and what \
            cameras do is not what their \
             dials say: write {}, a table (file, exposure_s, iso, f_number) of photographs of one thing in \
             steady light, one at least \
             under each of these settings",
            self.folder.join(CALIBRATION).display()
        )
    }

    /// Which pixels of a photograph count.
    fn seen(&self, photograph: &Photograph) -> Result<Vec<bool>, PhotographsError> {
        let Photograph { path, height, width, pixels } = photograph;
        let fails = |what: String| PhotographsError::Sense { path: path.clone(), what };
        let seen = match &self.mask {
            None => vec![true; pixels.len()],
            Some(mask) if [mask.height, mask.width] == [*height, *width] => {
                mask.pixels.iter().map(|pixel| pixel.iter().sum::<f64>() > 1.5).collect()
            }
            Some(mask) => {
                let other = format!("{} has {}x{}", mask.path.display(), mask.width, mask.height);
                return Err(fails(format!("{width}x{height} pixels, {other}")));
            }
        };
        let full = photograph.full();
        if pixels.iter().zip(&seen).any(|(pixel, seen)| *seen && is_full(pixel, full)) {
            return Err(fails(LOST.to_owned()));
        }
        Ok(seen)
    }

    /// What is compared of a photograph of a calibration.
    fn patches(&self, photograph: &Photograph) -> Result<Vec<f64>, PhotographsError> {
        let seen = self.seen(photograph)?;
        let patches = photograph.patches(&seen);
        if patches.is_empty() {
            let what = format!(
                "mask.png leaves {} pixels, in which there is none of the squares of {PATCH}x{PATCH} from \
                the upper left on that \
                 {CALIBRATION} compares: make it larger",
                seen.iter().filter(|seen| **seen).count()
            );
            return Err(PhotographsError::Sense { path: photograph.path.clone(), what });
        }
        Ok(patches)
    }

    /// How strongly the settings of a list expose, relative to what they say, that of the first being right.
    fn calibrated(&self, table: &Table) -> Result<Vec<([f64; 2], f64)>, PhotographsError> {
        table.has_only(&["file", "exposure_s", "iso", "f_number"], "a calibration")?;
        let files = table.files().ok_or_else(|| table.says("has no column file".to_owned()))?;
        let [seconds, iso, f_number] = [("exposure_s", 1.0), ("iso", 100.0), ("f_number", 1.0)]
            .map(|(name, usual)| table.positive_or(name, usual));
        let (seconds, iso, f_number) = (seconds?, iso?, f_number?);
        let mut first: Option<(Vec<f64>, f64)> = None;
        // Of each setting what its photographs say.
        let mut said: Vec<([f64; 2], Vec<f64>)> = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let photograph = Photograph::read(&self.folder.join(file), self.exr)?;
            let patches = self.patches(&photograph)?;
            let says = Exposure::of_camera(seconds[index], iso[index], f_number[index]).gain;
            let (reference, its) = first.get_or_insert_with(|| (patches.clone(), says));
            let wrong = |what: String| PhotographsError::Sense { path: photograph.path.clone(), what };
            let gain = relative_gain(reference, &patches)
                .filter(|gain| *gain > 0.0)
                .ok_or_else(|| wrong(format!("shows nothing to compare with the first of {CALIBRATION}")))?;
            let (setting, factor) = ([iso[index], f_number[index]], gain / (says / *its));
            let known = said.iter_mut().find(|(other, _)| same(*other, setting));
            let Some((_, factors)) = known else {
                said.push((setting, vec![factor]));
                continue;
            };
            if let Some(other) = factors.iter().find(|other| (factor / **other - 1.0).abs() > AGREE) {
                let [iso, f_number] = setting;
                let off = 100.0 * (factor / other - 1.0);
                let what = format!(
                    "exposes {off:+.0} % beside another of {CALIBRATION} at ISO {iso} and f/{f_number}"
                );
                return Err(wrong(format!("{what}: the light was not steady, or the shutter keeps no time")));
            }
            factors.push(factor);
        }
        let mean = |factors: &Vec<f64>| factors.iter().sum::<f64>() / factors.len() as f64;
        let right = said.first().map_or(1.0, |(_, factors)| mean(factors));
        Ok(said.iter().map(|(setting, factors)| (*setting, mean(factors) / right)).collect())
    }
}

/// Whether all values of 16 bits are such as 8 bits give, by either way of making them wider. What is black
/// or full says nothing, nor does one value alone, which may be such by chance.
fn is_widened(image: &DynamicImage) -> bool {
    let values = image.to_rgb16();
    let are_multiples = |step: u16| values.iter().all(|value| value % step == 0);
    let mut telling = values.iter().filter(|value| !matches!(**value, 0 | u16::MAX));
    let first = telling.next();
    telling.any(|value| Some(value) != first) && [256, 257].into_iter().any(are_multiples)
}

fn is_full(pixel: &[f64; 3], full: Option<f64>) -> bool {
    full.is_some_and(|full| pixel.iter().any(|value| *value >= full))
}

fn same(a: [f64; 2], b: [f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * b.abs())
}

impl Photograph {
    fn read(path: &Path, exr: ExrReader) -> Result<Self, PhotographsError> {
        let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        if is_exr {
            let image = exr(path).map_err(PhotographsError::Exr)?;
            let pixel = |index: usize| [0, 1, 2].map(|channel| f64::from(image.plane(channel)[index]));
            let pixels = (0..image.pixels()).map(pixel).collect();
            return Ok(Self { path: path.into(), height: image.height(), width: image.width(), pixels });
        }
        let image = Self::opened(path)?;
        let narrow = image.color().bytes_per_pixel() < 2 * image.color().channel_count();
        if narrow || is_widened(&image) {
            let what = format!(
                "has 8 bits a colour{}, which are not linear; EXR files and PNG files of 16 bits are read",
                if narrow { "" } else { " written as 16" }
            );
            return Err(PhotographsError::Sense { path: path.into(), what });
        }
        Ok(Self::of_image(path, &image))
    }

    /// An image of which only bright and dark matter.
    fn of_any_depth(path: &Path) -> Result<Self, PhotographsError> {
        Ok(Self::of_image(path, &Self::opened(path)?))
    }

    fn opened(path: &Path) -> Result<DynamicImage, PhotographsError> {
        image::open(path).map_err(|source| PhotographsError::Image { path: path.into(), source })
    }

    fn of_image(path: &Path, image: &DynamicImage) -> Self {
        let image = image.to_rgb32f();
        let pixels = image.pixels().map(|pixel| pixel.0.map(f64::from)).collect();
        Self { path: path.into(), height: image.height() as usize, width: image.width() as usize, pixels }
    }

    /// From where on a value of it is full; EXR files hold whatever there is.
    fn full(&self) -> Option<f64> {
        let is_png = self.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        is_png.then_some(FULL)
    }

    /// The mean pixel of a rectangle: left, top, width and height.
    fn mean(&self, [left, top, width, height]: [usize; 4]) -> Result<[f64; 3], PhotographsError> {
        let fails = |what: String| PhotographsError::Sense { path: self.path.clone(), what };
        let ends = |from: usize, size: usize, of: usize| from.checked_add(size).filter(|end| *end <= of);
        let (Some(right), Some(bottom)) = (ends(left, width, self.width), ends(top, height, self.height))
        else {
            let rectangle = format!("{width}x{height} pixels from ({left}, {top}) on");
            return Err(fails(format!(
                "has {}x{} pixels, not {rectangle}: correct left, top, width or height",
                self.width, self.height
            )));
        };
        let (mut sum, full) = ([0.0; 3], self.full());
        for pixel in (top..bottom).flat_map(|y| &self.pixels[y * self.width..][left..right]) {
            if is_full(pixel, full) {
                return Err(fails(LOST.to_owned()));
            }
            sum = [0, 1, 2].map(|channel: usize| sum[channel] + pixel[channel]);
        }
        let mean = sum.map(|sum| sum / (width * height) as f64);
        // A sum of what is not finite is not finite.
        if mean.iter().all(|value| value.is_finite()) {
            return Ok(mean);
        }
        Err(fails(format!("a pixel of {width}x{height} from ({left}, {top}) on is not finite")))
    }

    /// The mean of each channel in each patch whose pixels all count.
    fn patches(&self, seen: &[bool]) -> Vec<f64> {
        let mut means = Vec::new();
        for row in (0..self.height).step_by(PATCH) {
            for column in (0..self.width).step_by(PATCH) {
                let rows = row..(row + PATCH).min(self.height);
                let columns = column..(column + PATCH).min(self.width);
                let own: Vec<usize> =
                    rows.flat_map(|y| columns.clone().map(move |x| y * self.width + x)).collect();
                if own.iter().all(|index| seen[*index]) {
                    let mean = |channel: usize| {
                        own.iter().map(|index| self.pixels[*index][channel]).sum::<f64>() / own.len() as f64
                    };
                    means.extend([0, 1, 2].map(mean));
                }
            }
        }
        means
    }
}

#[cfg(test)]
mod tests;
