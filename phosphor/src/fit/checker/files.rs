//! A colour chart in a folder of measurements.
//!
//! `checker.csv` has a row a patch: its name, `patch`, and what the camera saw of it. That is `red`, `green`,
//! `blue` (linear), or the rectangle `left`, `top`, `width`, `height` of the photograph `file`, in pixels. As
//! photographs of a decay have, it may have `exposure_s`, `iso` and `f_number`, colours `gain`. What is known
//! of a patch is that of the classic chart, or the columns `known_red`, `known_green`, `known_blue` (linear
//! sRGB), or `lab_l`, `lab_a`, `lab_b` (CIE L*a*b* under D50, as makers of charts state it). For the classic
//! chart there may be `filter`, a column of `filters.csv` from 1 on, or 0, and `checker-light.csv`, the light
//! on it.

use super::{CHECKER, Checker, CheckerError, Patch, chart};
use crate::curves::Curves;
use crate::fit::files::gains;
use crate::fit::photographs::Photographs;
use crate::table::{Table, TableError};
use deepshade_glow::spectrum::Axis;
use std::path::Path;

/// The light on the chart.
const LIGHT: &str = "checker-light.csv";
const SEEN: [&str; 3] = ["red", "green", "blue"];
const RECTANGLE: [&str; 4] = ["left", "top", "width", "height"];
const KNOWN: [&str; 3] = ["known_red", "known_green", "known_blue"];
const LAB: [&str; 3] = ["lab_l", "lab_a", "lab_b"];
const FILTER: &str = "filter";

impl Checker {
    /// That of a folder; none where there is no `checker.csv`.
    ///
    /// # Errors
    /// If a file cannot be read or says what makes no sense, or its patches do not tell the camera's colours.
    pub(in crate::fit) fn read(
        folder: &Path,
        photographs: &mut Photographs,
    ) -> Result<Option<Self>, CheckerError> {
        let path = folder.join(CHECKER);
        if !path.exists() {
            return Ok(None);
        }
        let table = Table::read(&path)?;
        let names = table.patches().ok_or_else(|| table.says("has no column patch".to_owned()))?;
        check_columns(&table)?;
        let known = known(folder, &table, names)?;
        let seen = match table.files() {
            Some(files) => photographed(&table, files, photographs)?,
            None => listed(&table)?,
        };
        let patch = |((name, seen), known): ((&String, [f64; 3]), [f64; 3])| Patch {
            name: name.clone(),
            seen,
            known,
        };
        let patches: Vec<Patch> = names.iter().zip(seen).zip(known).map(patch).collect();
        Self::new(&patches).map(Some)
    }
}

fn has(table: &Table, name: &str) -> bool {
    table.names().iter().any(|other| other == name)
}

/// Whether all columns mean something beside each other.
fn check_columns(table: &Table) -> Result<(), TableError> {
    let mut columns = vec!["patch"];
    if table.files().is_some() {
        columns.extend(["file", "exposure_s", "iso", "f_number"].into_iter().chain(RECTANGLE));
    } else if has(table, "gain") {
        columns.extend(SEEN.into_iter().chain(["gain"]));
    } else {
        columns.extend(SEEN.into_iter().chain(["exposure_s", "iso", "f_number"]));
    }
    columns.extend(if has(table, KNOWN[0]) {
        &KNOWN[..]
    } else if has(table, LAB[0]) {
        &LAB[..]
    } else {
        &[FILTER][..]
    });
    table.has_only(&columns, "such a list of patches")
}

/// Three columns as colours.
fn colours(columns: [Vec<f64>; 3]) -> Vec<[f64; 3]> {
    let [red, green, blue] = columns;
    red.into_iter().zip(green).zip(blue).map(|((red, green), blue)| [red, green, blue]).collect()
}

/// What is known of each patch.
fn known(folder: &Path, table: &Table, names: &[String]) -> Result<Vec<[f64; 3]>, TableError> {
    for (columns, lab) in [(KNOWN, false), (LAB, true)] {
        if has(table, columns[0]) {
            let [a, b, c] = columns.map(|name| table.column(name));
            let colours = colours([a?, b?, c?]);
            return Ok(if lab { colours.into_iter().map(chart::of_lab).collect() } else { colours });
        }
    }
    let path = folder.join(LIGHT);
    let light = if path.exists() { Some(lamp(&path)?) } else { None };
    let filters = if has(table, FILTER) { Some(Curves::read(&folder.join("filters.csv"))?) } else { None };
    // Reflectances are of older charts than the stated colours: a list has either.
    let by_reflectance = light.is_some() || filters.is_some();
    let places = match &filters {
        Some(filters) => places(table, filters.values.len())?,
        None => vec![None; names.len()],
    };
    let of = |(row, (name, place)): (usize, (&String, Option<usize>))| {
        let filter = filters.as_ref().zip(place);
        let colour = match by_reflectance {
            true => chart::seen_in(name, light.as_ref(), filter),
            false => chart::stated(name),
        };
        colour.ok_or_else(|| {
            let all: Vec<&str> = chart::names().collect();
            let fault = format!(
                "{name:?} is no patch of the classic chart: {}. other charts need {} or {}",
                all.join(", "),
                KNOWN.join(", "),
                LAB.join(", ")
            );
            table.says_of_row(row, fault)
        })
    };
    names.iter().zip(places).enumerate().map(of).collect()
}

/// The light on the chart.
fn lamp(path: &Path) -> Result<Curves, TableError> {
    let light = Curves::read(path)?;
    let seen = Axis::EIGHT.from..=Axis::EIGHT.end();
    let shines = |power: &Vec<f64>| {
        light.wavelengths.iter().zip(power).any(|(at, power)| seen.contains(at) && *power > 0.0)
    };
    if light.values.len() == 1 && shines(&light.values[0]) {
        return Ok(light);
    }
    Err(Table::read(path)?.says("is not one curve of power that is above 0 from 400 to 700 nm".to_owned()))
}

/// The filter of each row, from 0 on, or none.
fn places(table: &Table, count: usize) -> Result<Vec<Option<usize>>, TableError> {
    let place = |(row, value): (usize, f64)| {
        if value.fract() == 0.0 && (0.0..=count as f64).contains(&value) {
            return Ok((value as usize).checked_sub(1));
        }
        let fault = format!("{FILTER} is {value}, there are 1 to {count} of filters.csv, and 0 for none");
        Err(table.says_of_row(row, fault))
    };
    table.column(FILTER)?.into_iter().enumerate().map(place).collect()
}

/// What the camera saw, of a table that has its colours.
fn listed(table: &Table) -> Result<Vec<[f64; 3]>, TableError> {
    let [red, green, blue] = SEEN.map(|name| table.not_negative(name));
    let seen = colours([red?, green?, blue?]);
    let gains = gains(table, &table.positive_or("exposure_s", 1.0)?)?;
    Ok(seen.into_iter().zip(gains).map(|(seen, gain)| seen.map(|value| value / gain)).collect())
}

/// The same of a table that has rectangles of photographs.
fn photographed(
    table: &Table,
    files: &[String],
    photographs: &mut Photographs,
) -> Result<Vec<[f64; 3]>, CheckerError> {
    let settings = [("exposure_s", 1.0), ("iso", 100.0), ("f_number", 1.0)]
        .map(|(name, usual)| table.positive_or(name, usual));
    let [seconds, iso, f_number] = settings;
    let (seconds, iso, f_number) = (seconds?, iso?, f_number?);
    let [left, top, width, height] = RECTANGLE.map(|name| table.not_negative(name));
    let (left, top, width, height) = (left?, top?, width?, height?);
    let mut areas = Vec::with_capacity(files.len());
    for (row, file) in files.iter().enumerate() {
        let numbers = [left[row], top[row], width[row], height[row]];
        if numbers.iter().any(|number| number.fract() != 0.0) || numbers[2] < 1.0 || numbers[3] < 1.0 {
            let fault = format!("{numbers:?} is no rectangle of whole pixels");
            return Err(table.says_of_row(row, fault).into());
        }
        let rectangle = numbers.map(|number| number as usize);
        areas.push((file.as_str(), [seconds[row], iso[row], f_number[row]], rectangle));
    }
    Ok(photographs.areas(&areas)?)
}

#[cfg(test)]
mod tests;
