use super::super::tests::{camera, classic, off};
use super::*;
use crate::fit::tests::read;
use crate::fit::{Fit, Measurement, Warning};
use image::{ImageBuffer, Rgb};
use std::error::Error;
use std::fmt::Write;

const DECAY: f64 = 0.02;
/// Linear sRGB of the light that a material sends at first.
const LIGHT: [f64; 3] = [0.05, 0.4, 0.2];

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("written");
}

/// A folder with the decay of such a light, as the camera saw it.
fn folder(light: [f64; 3]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut decay = "time_s,red,green,blue\n".to_owned();
    for time in (0..16).map(|index| 5.0 * f64::from(index)) {
        // What the open shutter takes of a decay in one second.
        let share = (-DECAY * time).exp() * -(-DECAY).exp_m1() / DECAY;
        let [red, green, blue] = camera(light).map(|value| value * share);
        let _ = writeln!(decay, "{time},{red},{green},{blue}");
    }
    write(folder.path(), "decay.csv", &decay);
    folder
}

/// The list of what the camera saw, under a gain.
fn list(patches: &[Patch], gain: f64) -> String {
    let row = |Patch { name, seen: [red, green, blue], .. }: &Patch| {
        format!("{name},{gain},{},{},{}\n", red * gain, green * gain, blue * gain)
    };
    let rows: String = patches.iter().map(row).collect();
    format!("patch,gain,red,green,blue\n{rows}")
}

/// Why a folder is, with all reasons.
fn refused(folder: &Path) -> String {
    let mut error: &dyn Error = &read(folder).expect_err("refused");
    let mut said = error.to_string();
    while let Some(source) = error.source() {
        said = format!("{said}: {source}");
        error = source;
    }
    said
}

/// The light at first that a fit finds, and its warnings.
fn fitted(folder: &Path) -> ([f64; 3], Vec<Warning>) {
    let measurement = read(folder).expect("a measurement");
    let fit = Fit::new("test", &measurement, 1).expect("a fit");
    let state = &fit.material.states[0];
    ([0, 1, 2].map(|channel: usize| state.emission[channel] * state.decay), fit.warnings)
}

fn near(found: [f64; 3], expected: [f64; 3]) -> bool {
    found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4)
}

#[test]
fn a_fit_is_in_linear_srgb_where_there_is_a_chart() {
    let folder = folder(LIGHT);
    let (raw, _) = fitted(folder.path());
    assert!(near(raw, camera(LIGHT)) && !near(raw, LIGHT), "without a chart it is the camera's: {raw:?}");
    write(folder.path(), "checker.csv", &list(&classic(), 0.25));
    let (light, warnings) = fitted(folder.path());
    assert!(near(light, LIGHT) && warnings.is_empty(), "{light:?} {warnings:?}");
    let mut upside_down = classic();
    let seen: Vec<_> = upside_down.iter().rev().map(|patch| patch.seen).collect();
    upside_down.iter_mut().zip(seen).for_each(|(patch, seen)| patch.seen = seen);
    write(folder.path(), "checker.csv", &list(&upside_down, 1.0));
    let (light, warnings) = fitted(folder.path());
    assert!(!near(light, LIGHT) && matches!(warnings[..], [Warning::Chart { rms, .. }, ..] if rms > 0.2));
}

/// A chart that says that the camera is right changes nothing, noise neither; nor does one that is not there.
#[test]
fn the_identity_changes_nothing() {
    let folder = folder(LIGHT);
    let without = read(folder.path()).expect("a measurement");
    assert_eq!(without.checker, None);
    let mut patches = classic();
    // What screens lack no camera sees as less than nothing.
    patches.retain(|patch| patch.known.iter().all(|part| *part >= 0.0));
    patches.iter_mut().for_each(|patch| patch.seen = patch.known);
    write(folder.path(), "checker.csv", &list(&patches, 1.0));
    let with = read(folder.path()).expect("a measurement");
    assert!(with.checker.is_some());
    for (a, b) in without.decay.iter().zip(&with.decay) {
        let pairs = a.value.iter().chain(&a.noise).zip(b.value.iter().chain(&b.noise));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12 * a), "{a:?} {b:?}");
        assert_eq!((a.delay, a.exposure), (b.delay, b.exposure));
    }
}

/// Light so pure that screens lack it cannot be made; that is said.
#[test]
fn colours_that_screens_lack_are_named() {
    let folder = folder([-0.1, 0.5, 0.1]);
    write(folder.path(), "checker.csv", &list(&classic(), 1.0));
    let (light, warnings) = fitted(folder.path());
    assert!(warnings.contains(&Warning::Outside("red")), "{warnings:?}");
    assert!(light[0] < 1e-6 && (light[1] - 0.5).abs() < 0.01, "{light:?}");
}

/// Rectangles of a photograph say what colours in a table do, under their exposure; other known values and
/// filters are taken in the place of the chart's.
#[test]
fn photographs_and_other_charts_are_read() {
    let folder = folder(LIGHT);
    let all = classic();
    let image = ImageBuffer::from_fn(60, 40, |x, y| {
        let inside = x % 10 < 9 && y % 10 < 9;
        let seen = all[(y / 10 * 6 + x / 10) as usize].seen;
        Rgb(seen.map(|value| if inside { (65535.0 * value).round() as u16 } else { 65535 }))
    });
    image.save(folder.path().join("chart.png")).expect("written");
    let mut text = "patch,file,exposure_s,iso,left,top,width,height\n".to_owned();
    for (index, patch) in all.iter().enumerate() {
        let _ = writeln!(text, "{},chart.png,0.5,200,{},{},9,9", patch.name, index % 6 * 10, index / 6 * 10);
    }
    write(folder.path(), "checker.csv", &text);
    let checker = |folder: &Path| read(folder).expect("a measurement").checker.expect("a chart");
    assert!(off(&checker(folder.path())) < 1e-3);
    // Where shutter or ISO were not counted, all would be half as bright.
    write(folder.path(), "checker.csv", &text.replace(",0.5,200,", ",1,200,"));
    assert!((off(&checker(folder.path())) - 1.0).abs() < 1e-3);
    let other: String = all
        .iter()
        .map(|Patch { seen: [r, g, b], known: [x, y, z], .. }| format!("own,{r},{g},{b},{x},{y},{z}\n"))
        .collect();
    let named = format!("patch,red,green,blue,known_red,known_green,known_blue\n{other}");
    write(folder.path(), "checker.csv", &named);
    assert!(off(&checker(folder.path())) < 1e-12);
    write(folder.path(), "filters.csv", "wavelength_nm,a,b\n400,1,0\n500,1,0.2\n550,0.3,0.9\n700,0.1,0.8\n");
    let filters = Curves::read(&folder.path().join("filters.csv")).expect("curves");
    let through = |patch: &Patch, place: usize| {
        let filter = place.checked_sub(1).map(|index| (&filters, index));
        let known = chart::seen_in(&patch.name, None, filter).expect("a patch");
        let [red, green, blue] = camera(known).map(|value| value.max(0.0));
        format!("{},{place},{red},{green},{blue}\n", patch.name)
    };
    let rows: String = (0..3).flat_map(|place| all.iter().map(move |patch| through(patch, place))).collect();
    write(folder.path(), "checker.csv", &format!("patch,filter,red,green,blue\n{rows}"));
    let filtered = checker(folder.path());
    assert!(off(&filtered) < 1e-2 && filtered.rms < 1e-3 && filtered.patches == 72, "{filtered:?}");
    write(folder.path(), "filters.csv", "wavelength_nm,a,b\n400,0,1\n500,0.2,1\n550,0.9,0.3\n700,0.8,0.1\n");
    assert!(checker(folder.path()).rms > 0.1, "of filters that were taken for each other");
    write(folder.path(), "checker-light.csv", "wavelength_nm,power\n400,0.2\n700,2\n");
    write(folder.path(), "checker.csv", &list(&all, 1.0));
    assert!(off(&checker(folder.path())) > 0.05, "of a light that it was not");
}

#[test]
fn lists_that_make_no_sense_are_refused_by_line() {
    let said = |files: &[(&str, &str)]| {
        let folder = folder(LIGHT);
        ImageBuffer::from_pixel(20, 10, Rgb([9000u16, 7001, 5002]))
            .save(folder.path().join("chart.png"))
            .expect("written");
        files.iter().for_each(|(name, text)| write(folder.path(), name, text));
        refused(folder.path())
    };
    let good = list(&classic(), 1.0);
    let is = |text: &str, expected: &str| {
        let said = said(&[("checker.csv", text)]);
        assert!(said.contains(expected), "{said}, not {expected}");
    };
    is("patch,gain,exposure_s,red,green,blue\nwhite,1,1,1,1,1\n", "exposure_s");
    is(
        &good.replace("cyan,", "teal,"),
        "checker.csv:19: \"teal\" is no patch of the classic chart: dark skin, ",
    );
    is(&good.replace("cyan,1,0", "cyan,1,-0"), "checker.csv:19: red is -0");
    is(&good.replace("cyan,1,0.", "cyan,1,NaN0."), "checker.csv:19: red is");
    is(&good.replace("cyan,", ","), "checker.csv:19: patch is \"\", not the name of a patch");
    is("patch,red,green,blue\nred,1,0,0\n", "checker.csv: 1 patches, at least 6");
    is("red,green,blue\n1,0,0\n", "checker.csv has no column patch");
    is("patch,red,green\nred,1,0\n", "has no column blue");
    is("patch,red,green,blue,known_red\nred,1,0,0,1\n", "has no column known_green");
    is("patch,red,green,blue,lab_l,filter\nred,1,0,0,1,1\n", "has a column filter, which means nothing");
    is("patch,red,green,blue,colour\nred,1,0,0,1\n", "has a column colour, which means nothing");
    is("patch,red,green,blue,filter\nred,1,0,0,1\n", "filters.csv");
    let area = |rest: &str| format!("patch,file,left,top,width,height\nred,{rest}\n");
    is(&area("chart.png,0,0,21,10"), "chart.png: has 20x10 pixels, not 21x10 pixels from (0, 0) on");
    is(&area("chart.png,0,0,1e300,10"), "chart.png: has 20x10 pixels");
    is(&area("chart.png,0,0,0,10"), "is no rectangle of whole pixels");
    is(&area("chart.png,0,0.5,1,1"), "checker.csv:2: [0.0, 0.5, 1.0, 1.0] is no rectangle");
    is(&area("chart.png,-1,0,1,1"), "left is -1, it must be at least 0");
    is(&area("none.png,0,0,1,1"), "none.png");
    let filters = ("filters.csv", "wavelength_nm,a\n400,1\n700,1\n");
    let wrong = said(&[filters, ("checker.csv", "patch,red,green,blue,filter\nred,1,0,0,2\n")]);
    assert!(wrong.contains("checker.csv:2: filter is 2, there are 1 to 1 of filters.csv, and 0"), "{wrong}");
    let dark = ("checker-light.csv", "wavelength_nm,power\n400,0\n700,0\n");
    assert!(said(&[dark, ("checker.csv", &good)]).contains("checker-light.csv is not one curve of power"));
    let spectrum = ("spectrum.csv", "filter,time_s,red,green,blue\n1,0,1,1,1\n");
    let both = said(&[filters, spectrum, ("checker.csv", &good)]);
    assert!(both.contains("checker.csv is for materials in the camera's colours"), "{both}");
}

/// Photographs of the chart may have other settings than those of the decay, but not among themselves.
#[test]
fn settings_of_the_chart_are_its_own() {
    let folder = folder(LIGHT);
    let all = classic();
    for (index, patch) in all.iter().enumerate() {
        let pixel = Rgb(patch.seen.map(|value| (65535.0 * value).round() as u16));
        let file = folder.path().join(format!("patch{index}.png"));
        // Two values: of one alone nobody could tell whether it has 16 bits.
        ImageBuffer::from_fn(4, 4, |x, _| if x < 3 { pixel } else { Rgb([3u16, 5, 7]) })
            .save(file)
            .expect("written");
    }
    let list = |odd: &str| {
        let row = |(index, patch): (usize, &Patch)| {
            format!("{},patch{index}.png,{},0,0,2,2\n", patch.name, if index == 3 { odd } else { "100" })
        };
        let rows: String = all.iter().enumerate().map(row).collect();
        format!("patch,file,iso,left,top,width,height\n{rows}")
    };
    write(folder.path(), "decay.csv", &{
        let rows: String = (0..8).map(|time| format!("patch5.png,{time},400\n")).collect();
        format!("file,time_s,iso\n{rows}")
    });
    write(folder.path(), "checker.csv", &list("100"));
    let measurement: Measurement = read(folder.path()).expect("a measurement");
    assert!(off(&measurement.checker.expect("a chart")) < 1e-3);
    write(folder.path(), "checker.csv", &list("800"));
    let error = refused(folder.path());
    assert!(error.contains("patch3.png: is of ISO 800 at f/1, others are of ISO 100"), "{error}");
}
