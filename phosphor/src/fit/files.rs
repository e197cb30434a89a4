//! Measurements in a folder of CSV files.
//!
//! `decay.csv` has a row a photograph of the decay: `time_s` (since the light went off), `red`, `green`,
//! `blue`, and if they differ from row to row `exposure_s`, `iso`, `f_number`, and the standard errors
//! `red_noise`, `green_noise`, `blue_noise`. `excitation.csv` has the same columns, `band` (from 1 on) and
//! `light_s`, how long light of that band was on. In place of `iso` and `f_number` there may be `gain`, what
//! a radiance of 1 gives a pixel. In place of the colours there may be a column `file`, of photographs
//! ([`photographs`](super::photographs)). Other columns are refused by name. Noise that is not stated is
//! taken for a hundredth of the brightest value, that of photographs in files for what their pixels scatter,
//! which leaves out what all pixels share; then nobody can say how well a fit explains it. `spectrum.csv` has
//! the same columns and `filter` (from 1 on), a column of `filters.csv`. `camera.csv` has the sensor and
//! `light.csv` the lamp, as curves. `checker.csv` has what the camera saw of a colour chart
//! ([`checker`](super::checker)).

use super::checker::{CHECKER, Checker, CheckerError};
use super::measurement::{Charged, Exposure, Filtered, Measurement, Shot};
use super::photographs::{ExrReader, Photographs, PhotographsError};
use super::simulated::{Laboratory, of_length_one};
use crate::curves::Curves;
use crate::table::{Table, TableError};
use deepshade_glow::spectrum::lights::Light;
use deepshade_glow::spectrum::{Axis, Bands};
use std::fmt::Write;
use std::path::Path;

/// The part of the largest value that noise is taken for where nobody stated it.
const UNSTATED_NOISE: f64 = 0.01;

/// Why a folder of measurements cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// One of its tables is at fault.
    #[error("the measurement cannot be used")]
    Table(#[from] TableError),
    /// One of its photographs is.
    #[error("the measurement cannot be used")]
    Photographs(#[from] PhotographsError),
    /// Its colour chart is.
    #[error("the measurement cannot be used")]
    Checker(#[from] CheckerError),
}

impl Measurement {
    /// The measurements of a folder: `decay.csv`, and what else there is of the files. With `spectrum.csv`
    /// the material is described in eight bands, else in the camera's RGB, whose excitation is by a lamp of
    /// one band after the other all the same; in linear sRGB where there is `checker.csv`, which is refused
    /// beside `spectrum.csv`. Without `light.csv` the lamp is a halogen lamp.
    ///
    /// # Errors
    /// If a file cannot be read or says what makes no sense, with its line.
    pub fn read(folder: &Path, exr: ExrReader) -> Result<Self, FilesError> {
        let spectral = folder.join("spectrum.csv").exists();
        let bands = if spectral { Bands::Eight } else { Bands::Rgb };
        let filters =
            if spectral { Curves::read(&folder.join("filters.csv"))?.bands(Axis::EIGHT) } else { vec![] };
        let mut photographs = Photographs::new(folder, exr)?;
        if spectral && folder.join(CHECKER).exists() {
            let table = Table::read(&folder.join(CHECKER))?;
            let fault = "is for materials in the camera's colours; where there is spectrum.csv, camera.csv \
                says what the camera sees: take one of them away";
            return Err(table.says(fault.to_owned()).into());
        }
        let checker = Checker::read(folder, &mut photographs)?;
        let mut source = MeasurementFolder { photographs, checker, noise_is_known: true };
        let decay = source.shots(&Table::read(&folder.join("decay.csv"))?, true, &[])?;
        Ok(Self {
            bands,
            sensor: sensor(folder, bands)?,
            spectrum: if spectral { filtered(folder, filters.len(), &mut source)? } else { vec![] },
            filters,
            light: light(folder, bands)?,
            decay,
            excitation: excitation(folder, bands, &mut source)?,
            noise_is_known: source.noise_is_known,
            checker: source.checker,
        })
    }
}

impl Laboratory {
    /// The names and texts of the files that [`Measurement::read`] makes a measurement of this laboratory
    /// from.
    pub fn files(&self, measurement: &Measurement) -> Vec<(&'static str, String)> {
        let mut decay = format!("{SHOT}\n");
        measurement.decay.iter().for_each(|shot| row(&mut decay, &[], shot));
        let mut spectrum = format!("filter,{SHOT}\n");
        measurement.spectrum.iter().for_each(|f| row(&mut spectrum, &[(f.filter + 1) as f64], &f.shot));
        let mut files = vec![
            ("decay.csv", decay),
            ("spectrum.csv", spectrum),
            ("filters.csv", curves(&self.filters, |index| format!("place_{}", index + 1))),
            ("camera.csv", curves(&self.sensor, |index| ["red", "green", "blue"][index].into())),
        ];
        // Who reads it takes the lamp for a halogen lamp where nothing is said.
        if self.lamp != Light::Halogen {
            files.push((
                "light.csv",
                curves(&Curves::of_bands(self.lamp.spectrum(Axis::EIGHT)), |_| "power".into()),
            ));
        }
        if !measurement.excitation.is_empty() {
            let mut excitation = format!("band,light_s,{SHOT}\n");
            let rows = measurement.excitation.iter();
            rows.for_each(|c| row(&mut excitation, &[(c.band + 1) as f64, c.seconds], &c.shot));
            files.push(("excitation.csv", excitation));
        }
        files
    }
}

/// The columns of a photograph, as they are written.
const SHOT: &str = "time_s,exposure_s,gain,red,green,blue,red_noise,green_noise,blue_noise";

fn row(text: &mut String, first: &[f64], shot: &Shot) {
    let numbers = first.iter().copied().chain([shot.delay, shot.exposure.seconds, shot.exposure.gain]);
    let numbers: Vec<String> =
        numbers.chain(shot.value).chain(shot.noise).map(|number| number.to_string()).collect();
    let _ = writeln!(text, "{}", numbers.join(","));
}

fn curves(curves: &Curves, name: impl Fn(usize) -> String) -> String {
    let names: Vec<String> = (0..curves.values.len()).map(name).collect();
    let mut text = format!("wavelength_nm,{}\n", names.join(","));
    for (index, wavelength) in curves.wavelengths.iter().enumerate() {
        let values: Vec<String> = curves.values.iter().map(|values| values[index].to_string()).collect();
        let _ = writeln!(text, "{wavelength},{}", values.join(","));
    }
    text
}

/// The columns of all photographs, of those in files, and of those whose colours are in the table, with a
/// gain or the settings that it follows from.
const OF_ALL: [&str; 2] = ["time_s", "exposure_s"];
const SETTINGS: [&str; 2] = ["iso", "f_number"];
const GAIN: &str = "gain";
const COLOURS: [&str; 3] = ["red", "green", "blue"];
const NOISES: [&str; 3] = ["red_noise", "green_noise", "blue_noise"];

/// Whether a table has no column that means nothing beside its others, of which `own` are those of its kind.
fn check_columns(table: &Table, own: &[&str]) -> Result<(), TableError> {
    let mut known = [&OF_ALL[..], own].concat();
    let what = if table.files().is_some() {
        known.push("file");
        known.extend(SETTINGS);
        "a table of files of photographs"
    } else {
        known.extend(COLOURS.into_iter().chain(NOISES).chain([GAIN]));
        if table.names().iter().any(|name| name == GAIN) {
            "a table of colours under a gain"
        } else {
            known.extend(SETTINGS);
            "a table of colours"
        }
    };
    table.has_only(&known, what)
}

/// What is known of a folder while its tables are read.
struct MeasurementFolder {
    photographs: Photographs,
    checker: Option<Checker>,
    /// Of all tables so far.
    noise_is_known: bool,
}

impl MeasurementFolder {
    /// The photographs of a table, whose times ascend if they are of one decay; `own` are the other columns
    /// of a table of its kind. Where there is a colour chart they are in linear sRGB.
    fn shots(&mut self, table: &Table, ascending: bool, own: &[&str]) -> Result<Vec<Shot>, FilesError> {
        let seen = self.seen(table, ascending, own)?;
        let Some(checker) = &self.checker else { return Ok(seen) };
        Ok(seen.iter().map(|shot| checker.shot(shot)).collect())
    }

    /// The same in the camera's colours.
    fn seen(&mut self, table: &Table, ascending: bool, own: &[&str]) -> Result<Vec<Shot>, FilesError> {
        check_columns(table, own)?;
        let delays = if ascending { table.ascending("time_s")? } else { table.not_negative("time_s")? };
        let seconds = table.positive_or("exposure_s", 1.0)?;
        let Some(files) = table.files() else {
            self.noise_is_known &= NOISES.iter().all(|noise| table.names().iter().any(|name| name == noise));
            return Ok(of_colours(table, &delays, &seconds)?);
        };
        // That of pixels weighs photographs; how exposures and light vary from one to the next is not in it.
        self.noise_is_known = false;
        let (iso, f_number) = (table.positive_or("iso", 100.0)?, table.positive_or("f_number", 1.0)?);
        let shot = |(i, file): (usize, &String)| {
            let settings = [seconds[i], iso[i], f_number[i]];
            self.photographs.shot(file, delays[i], settings).map_err(FilesError::from)
        };
        files.iter().enumerate().map(shot).collect()
    }
}

/// The photographs of a table that has their colours.
fn of_colours(table: &Table, delays: &[f64], seconds: &[f64]) -> Result<Vec<Shot>, TableError> {
    let [red, green, blue] = COLOURS.map(|name| table.column(name));
    let value = [red?, green?, blue?];
    let brightest = value.iter().flatten().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let unstated = UNSTATED_NOISE * if brightest > 0.0 { brightest } else { 1.0 };
    let [red, green, blue] = NOISES.map(|name| table.positive_or(name, unstated));
    let noise = [red?, green?, blue?];
    let gains = gains(table, seconds)?;
    let shot = |i: usize| Shot {
        delay: delays[i],
        exposure: Exposure { seconds: seconds[i], gain: gains[i] },
        value: [0, 1, 2].map(|c: usize| value[c][i]),
        noise: [0, 1, 2].map(|c: usize| noise[c][i]),
    };
    Ok((0..delays.len()).map(shot).collect())
}

/// What a radiance of 1 gives a pixel: the column `gain` where it was measured, else what the camera's
/// settings say.
pub(super) fn gains(table: &Table, seconds: &[f64]) -> Result<Vec<f64>, TableError> {
    if table.names().iter().any(|name| name == GAIN) {
        return table.positive_or(GAIN, 1.0);
    }
    let (iso, f_number) = (table.positive_or("iso", 100.0)?, table.positive_or("f_number", 1.0)?);
    Ok((0..seconds.len()).map(|i| Exposure::of_camera(seconds[i], iso[i], f_number[i]).gain).collect())
}

fn sensor(folder: &Path, bands: Bands) -> Result<[Vec<f64>; 3], TableError> {
    if bands == Bands::Rgb {
        return Ok(std::array::from_fn(|channel| {
            (0..3).map(|band| f64::from(u8::from(band == channel))).collect()
        }));
    }
    let curves = Curves::read_sensor(&folder.join("camera.csv"))?.bands(Axis::EIGHT);
    Ok(std::array::from_fn(|channel| curves[channel].clone()))
}

fn light(folder: &Path, bands: Bands) -> Result<Vec<f64>, TableError> {
    let path = folder.join("light.csv");
    let power = match bands {
        Bands::Rgb => vec![1.0; 3],
        Bands::Eight if path.exists() => Curves::read(&path)?.bands(Axis::EIGHT).swap_remove(0),
        Bands::Eight => Light::Halogen.spectrum(Axis::EIGHT),
    };
    Ok(of_length_one(power))
}

fn filtered(
    folder: &Path,
    filters: usize,
    source: &mut MeasurementFolder,
) -> Result<Vec<Filtered>, FilesError> {
    let table = Table::read(&folder.join("spectrum.csv"))?;
    let places = table.indices("filter", filters)?;
    Ok(places
        .into_iter()
        .zip(source.shots(&table, false, &["filter"])?)
        .map(|(filter, shot)| Filtered { filter, shot })
        .collect())
}

fn excitation(
    folder: &Path,
    bands: Bands,
    source: &mut MeasurementFolder,
) -> Result<Vec<Charged>, FilesError> {
    let path = folder.join("excitation.csv");
    if !path.exists() {
        return Ok(vec![]);
    }
    let table = Table::read(&path)?;
    let places = table.indices("band", bands.count())?;
    let seconds = table.not_negative("light_s")?;
    let shots = source.shots(&table, false, &["band", "light_s"])?;
    let charged = |((band, seconds), shot)| Charged { band, seconds, shot };
    Ok(places.into_iter().zip(seconds).zip(shots).map(charged).collect())
}
