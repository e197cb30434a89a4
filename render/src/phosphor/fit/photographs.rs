//! Photographs of a measurement, and how strongly each setting of the camera really exposes (thesis, section 8.4.1).
//!
//! Photographs are linear RGB: EXR files, or PNG files of 16 bits whose values are taken as they are, without a transfer curve. Where
//! a folder has `mask.png`, its bright pixels are those of the material. `calibration.csv` lists photographs of one thing in steady
//! light under different settings: `file`, `exposure_s`, `iso`, `f_number`. What cameras do is not quite what their dials say; with
//! that list gains are those that were measured, without it those of the dials. Shutters are taken to keep their times: what
//! photographs of one ISO and f-number say, under whatever times, is averaged, and refused where they say different things.

use super::measurement::{Exposure, PhotographError, Shot, relative_gain};
use crate::exr_file::{self, ExrError};
use crate::phosphor::table::{Table, TableError};
use image::DynamicImage;
use std::path::{Path, PathBuf};

/// Side of the patches, in pixels, whose means are compared.
const PATCH: usize = 8;
/// A channel at this share of what a file of 16 bits holds is full.
const FULL: f64 = 0.999;
/// Settings are the same within this part.
const SAME: f64 = 1e-6;
/// By how much of it photographs of one setting may disagree on what it does: shutters keep their times, and light is steady, within
/// some per cent.
const AGREE: f64 = 0.05;

/// Why photographs cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PhotographsError {
    /// A table is at fault.
    #[error("a list of photographs")]
    Table(#[from] TableError),
    /// An EXR file cannot be read.
    #[error("a photograph")]
    Exr(#[from] ExrError),
    /// Another file cannot be read.
    #[error("{}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// It says nothing.
    #[error("{}", path.display())]
    Nothing {
        /// The file.
        path: PathBuf,
        /// Why.
        source: PhotographError,
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
    mask: Option<(PathBuf, usize, usize, Vec<bool>)>,
    /// ISO, f-number, and how many times as strongly they expose as they say.
    settings: Vec<([f64; 2], f64)>,
}

impl Photographs {
    /// Those of a folder.
    ///
    /// # Errors
    /// If its mask or its calibration cannot be read or makes no sense.
    pub fn new(folder: &Path) -> Result<Self, PhotographsError> {
        let mut photographs = Self { folder: folder.into(), mask: None, settings: Vec::new() };
        let mask = folder.join("mask.png");
        if mask.exists() {
            let Photograph { path, height, width, pixels } = Photograph::of_any_depth(&mask)?;
            let bright = pixels.iter().map(|pixel| pixel.iter().sum::<f64>() > 1.5).collect();
            photographs.mask = Some((path, height, width, bright));
        }
        let calibration = folder.join("calibration.csv");
        if calibration.exists() {
            photographs.settings = photographs.calibrated(&Table::read(&calibration)?)?;
        }
        Ok(photographs)
    }

    /// A photograph as its mean pixel, `delay` seconds after light.
    ///
    /// # Errors
    /// If the file cannot be read, is full or not as large as the mask, or its settings were not calibrated where others were.
    pub fn shot(
        &self,
        file: &str,
        delay: f64,
        [seconds, iso, f_number]: [f64; 3],
    ) -> Result<Shot, PhotographsError> {
        let photograph = Photograph::read(&self.folder.join(file))?;
        let mut exposure = Exposure::of_camera(seconds, iso, f_number);
        let is_it = |of: &&([f64; 2], f64)| same(of.0, [iso, f_number]);
        match self.settings.iter().find(is_it) {
            Some((_, factor)) => exposure.gain *= factor,
            None if self.settings.is_empty() => {}
            None => {
                let what =
                    format!("ISO {iso} at f/{f_number} is not in calibration.csv, as other settings are");
                return Err(PhotographsError::Sense { path: photograph.path, what });
            }
        }
        let seen = self.seen(&photograph)?;
        Shot::of_pixels(delay, exposure, &photograph.pixels, &seen)
            .map_err(|source| PhotographsError::Nothing { path: photograph.path, source })
    }

    /// Which pixels of a photograph count.
    fn seen(&self, photograph: &Photograph) -> Result<Vec<bool>, PhotographsError> {
        let Photograph { path, height, width, pixels } = photograph;
        let fails = |what: String| PhotographsError::Sense { path: path.clone(), what };
        let seen = match &self.mask {
            None => vec![true; pixels.len()],
            Some((_, rows, columns, bright)) if rows == height && columns == width => bright.clone(),
            Some((mask, rows, columns, _)) => {
                let sizes = format!("{width}x{height} pixels, {} has {columns}x{rows}", mask.display());
                return Err(fails(sizes));
            }
        };
        let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        let full = |(pixel, seen): (&[f64; 3], &bool)| *seen && pixel.iter().any(|value| *value >= FULL);
        if is_png && pixels.iter().zip(&seen).any(full) {
            return Err(fails("a pixel is full: what it would have had is lost".to_owned()));
        }
        Ok(seen)
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
            let photograph = Photograph::read(&self.folder.join(file))?;
            let patches = photograph.patches(&self.seen(&photograph)?);
            let says = Exposure::of_camera(seconds[index], iso[index], f_number[index]).gain;
            let (reference, its) = first.get_or_insert_with(|| (patches.clone(), says));
            let wrong = |what: String| PhotographsError::Sense { path: photograph.path.clone(), what };
            let (gain, _) =
                relative_gain(reference, &patches).filter(|(gain, _)| *gain > 0.0).ok_or_else(|| {
                    wrong("shows nothing to compare with the first of calibration.csv".to_owned())
                })?;
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
                    "exposes {off:+.0} % beside another of calibration.csv at ISO {iso} and f/{f_number}"
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

fn same(a: [f64; 2], b: [f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * b.abs())
}

impl Photograph {
    fn read(path: &Path) -> Result<Self, PhotographsError> {
        let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        if is_exr {
            let image = exr_file::read(path)?.colour()?;
            let pixel = |index: usize| [0, 1, 2].map(|channel| f64::from(image.plane(channel)[index]));
            let pixels = (0..image.pixels()).map(pixel).collect();
            return Ok(Self { path: path.into(), height: image.height(), width: image.width(), pixels });
        }
        let image = Self::opened(path)?;
        if image.color().bytes_per_pixel() < 2 * image.color().channel_count() {
            let what =
                "has 8 bits a colour, which are not linear; EXR files and PNG files of 16 bits are read"
                    .to_owned();
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
mod tests {
    use super::super::super::noise::Noise;
    use super::super::{Fit, Measurement};
    use super::*;
    use image::{ImageBuffer, Rgb};

    const DECAY: f64 = 0.03;
    /// What ISO 200 really does over what it says.
    const REALLY: f64 = 1.08;

    /// Writes a photograph of 40x24 pixels whose left half is of this radiance; the right half is lit by something else.
    fn photograph(path: &Path, radiance: f64, iso: f64, noise: &mut Noise) {
        let gain = iso / 100.0 * if iso > 100.0 { REALLY } else { 1.0 };
        let image = ImageBuffer::from_fn(40, 24, |x, y| {
            let shade = if x < 20 { radiance * (1.0 + 0.5 * f64::from(y % 8) / 8.0) / 1.22 } else { 0.011 };
            let colour = [1.0, 0.8, 0.5].map(|part| part * shade * gain + 2e-4 * noise.normal());
            Rgb(colour.map(|value| (65535.0 * value).clamp(0.0, 65535.0) as u16))
        });
        image.save(path).expect("written");
    }

    /// A folder of a decay that ISO 100 shows at first and ISO 200 at last.
    fn folder(calibration: bool) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut noise, mut decay) = (Noise::new(2), "file,time_s,iso\n".to_owned());
        for index in 0..16u32 {
            let (time, iso) = (f64::from(index) * 5.0, if index < 8 { 100.0 } else { 200.0 });
            let name = format!("{index}.png");
            photograph(&folder.path().join(&name), 0.4 * (-DECAY * time).exp(), iso, &mut noise);
            decay += &format!("{name},{time},{iso}\n");
        }
        std::fs::write(folder.path().join("decay.csv"), decay).expect("written");
        let mask = ImageBuffer::from_fn(40, 24, |x, _| Rgb([if x < 20 { 255u8 } else { 0 }; 3]));
        mask.save(folder.path().join("mask.png")).expect("written");
        if calibration {
            for iso in [100.0, 200.0] {
                photograph(&folder.path().join(format!("steady-{iso}.png")), 0.2, iso, &mut noise);
            }
            let list = "file,iso\nsteady-100.png,100\nsteady-200.png,200\n";
            std::fs::write(folder.path().join("calibration.csv"), list).expect("written");
        }
        folder
    }

    fn decay(folder: &Path) -> f64 {
        let measurement = Measurement::read(folder).expect("a measurement");
        Fit::new("test", &measurement, 1).expect("a fit").material.states[0].decay
    }

    #[test]
    fn what_settings_really_do_is_measured() {
        let [calibrated, blind] = [true, false].map(|calibration| decay(folder(calibration).path()));
        assert!((calibrated / DECAY - 1.0).abs() < 0.005, "{calibrated}");
        assert!((blind / DECAY - 1.0).abs() > 0.02, "as the dials say: {blind}");
    }

    /// All photographs of a setting count, whatever their exposure times: noise is averaged, and a shutter that is off by 2 % one way
    /// and 2 % the other is right on average.
    #[test]
    fn photographs_of_a_setting_are_taken_together() {
        let folder = folder(false);
        let mut noise = Noise::new(7);
        let mut list = "file,exposure_s,iso\n".to_owned();
        for (name, seconds, really, iso) in
            [("a", 1.0, 1.0, 100.0), ("b", 0.5, 0.51, 200.0), ("c", 0.25, 0.245, 200.0)]
        {
            let name = format!("steady-{name}.png");
            photograph(&folder.path().join(&name), 0.2 * really, iso, &mut noise);
            list += &format!("{name},{seconds},{iso}\n");
        }
        std::fs::write(folder.path().join("calibration.csv"), list).expect("written");
        let photographs = Photographs::new(folder.path()).expect("a calibration");
        let settings: Vec<[f64; 2]> = photographs.settings.iter().map(|(setting, _)| *setting).collect();
        assert_eq!(settings, [[100.0, 1.0], [200.0, 1.0]]);
        assert_eq!(photographs.settings[0].1, 1.0);
        let factor = photographs.settings[1].1;
        assert!((factor / REALLY - 1.0).abs() < 2e-3, "{factor}");
    }

    #[test]
    fn what_cannot_be_used_is_said_by_name() {
        let good = folder(true);
        let said = |name: &str, change: &dyn Fn(&Path)| {
            let folder = folder(true);
            change(&folder.path().join(name));
            let mut error: &dyn std::error::Error = &Measurement::read(folder.path()).expect_err("refused");
            let mut said = error.to_string();
            while let Some(source) = error.source() {
                said = format!("{said}: {source}");
                error = source;
            }
            said
        };
        assert!(Measurement::read(good.path()).is_ok());
        let whole = |size: [u32; 2]| {
            move |path: &Path| {
                ImageBuffer::from_pixel(size[0], size[1], Rgb([u16::MAX; 3])).save(path).expect("written");
            }
        };
        assert!(said("3.png", &whole([40, 24])).contains("3.png: a pixel is full"));
        assert!(said("3.png", &whole([4, 4])).contains("4x4 pixels"));
        assert!(said("3.png", &|path| std::fs::write(path, "no image").expect("written")).contains("3.png"));
        let black =
            |path: &Path| ImageBuffer::from_pixel(40, 24, Rgb([0u16; 3])).save(path).expect("written");
        assert!(said("mask.png", &black).contains("shows nothing to compare"));
        let coarse =
            |path: &Path| ImageBuffer::from_pixel(40, 24, Rgb([9u8; 3])).save(path).expect("written");
        assert!(said("3.png", &coarse).contains("3.png: has 8 bits a colour"));
        assert!(said("steady-100.png", &black).contains("shows nothing to compare"));
        let written = |text: &'static str| move |path: &Path| std::fs::write(path, text).expect("written");
        let beside = "file,time_s,iso,red\n0.png,0,100,0.4\n";
        assert!(said("decay.csv", &written(beside)).contains("has a column red, which means nothing"));
        let beside = "file,time_s,gain\n0.png,0,1\n";
        assert!(said("decay.csv", &written(beside)).contains("has a column gain, which means nothing"));
        let beside = "time_s,gain,iso,red,green,blue\n0,1,100,0.4,0.4,0.4\n";
        assert!(said("decay.csv", &written(beside)).contains("has a column iso, which means nothing"));
        let misspelt = "file,exposure,iso\nsteady-100.png,1,100\nsteady-200.png,1,200\n";
        assert!(
            said("calibration.csv", &written(misspelt))
                .contains("has a column exposure, which means nothing")
        );
        let unsteady =
            "file,exposure_s,iso\nsteady-100.png,1,100\nsteady-200.png,1,200\nsteady-200.png,2,200\n";
        assert!(
            said("calibration.csv", &written(unsteady)).contains(
                "steady-200.png: exposes -50 % beside another of calibration.csv at ISO 200 and f/1"
            )
        );
        let other = |path: &Path| std::fs::write(path, "file,iso\nsteady-100.png,100\n").expect("written");
        assert!(said("calibration.csv", &other).contains("ISO 200 at f/1 is not in calibration.csv"));
    }
}
