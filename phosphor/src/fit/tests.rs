use super::*;
use deepshade_glow::file::MaterialFile;
use deepshade_glow::spectrum::Bands;
use deepshade_glow::spectrum::lights::Light;
use std::path::Path;

fn preset(name: &str) -> Material {
    MaterialFile::presets().named(name).expect("a preset").clone()
}

/// The stickers of two states, with emission of one spectrum: that of the table is, but for its rounding.
fn stickers() -> Material {
    let mut material = preset("stickers, two states");
    material.states[1].emission = material.states[0].emission.iter().map(|value| 4.486 * value).collect();
    material
}

/// A laboratory with hardly any noise.
fn quiet() -> Laboratory {
    Laboratory { pixels: 1e14, ..Laboratory::thesis() }
}

/// What a camera alone measures of the decay.
pub(super) fn in_rgb(spectral: &Measurement) -> Measurement {
    let unit = |channel: usize| (0..3).map(|band| f64::from(u8::from(band == channel))).collect();
    Measurement {
        bands: Bands::Rgb,
        sensor: [unit(0), unit(1), unit(2)],
        filters: vec![],
        light: vec![1.0; 3],
        spectrum: vec![],
        excitation: vec![],
        ..spectral.clone()
    }
}

/// The measurements of a folder without EXR files.
pub(super) fn read(folder: &Path) -> Result<Measurement, FilesError> {
    Measurement::read(folder, |_| Err("an EXR file".into()))
}

/// A folder with the files of a measurement.
fn written(laboratory: &Laboratory, measurement: &Measurement) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in laboratory.files(measurement) {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn near(found: f64, expected: f64, relative: f64, what: &str) {
    assert!((found - expected).abs() <= relative * expected.abs() + 1e-5, "{what}: {found}, not {expected}");
}

#[test]
fn without_noise_materials_are_found_again() {
    for material in ["blue", "red", "green", "stickers"].map(preset).into_iter().chain([stickers()]) {
        let name = material.name.as_str();
        let measurement = quiet().measure(&material, 1).expect("a measurement");
        let fit = Fit::new(name, &measurement, material.states.len()).expect("a fit");
        for (found, expected) in fit.material.states.iter().zip(&material.states) {
            near(found.decay, expected.decay, 1e-4, name);
            let brightest = expected.emission.iter().copied().fold(0.0, f64::max);
            for (found, expected) in found.emission.iter().zip(&expected.emission) {
                assert!((found - expected).abs() < 1e-5 * brightest, "{name}: {found}, not {expected}");
            }
            let pairs = found.excitation.iter().zip(&expected.excitation);
            pairs.for_each(|(found, expected)| near(*found, *expected, 1e-4, name));
            assert_eq!(found.excitation.len(), expected.excitation.len());
        }
    }
}

/// More states than there are get some share of the light, and none less than nothing.
#[test]
fn states_too_many_send_no_negative_light() {
    for (name, seed) in [("orange", 1), ("blue", 1), ("red", 2)] {
        let measurement = Laboratory::thesis().measure(&preset(name), seed).expect("a measurement");
        let fit = Fit::new(name, &measurement, 3).expect("a fit");
        let emission = || fit.material.states.iter().flat_map(|state| &state.emission);
        assert!(emission().all(|value| *value >= 0.0), "{name}: {:?}", fit.material);
        assert!(fit.estimates.iter().all(|of| of.value >= 0.0 && of.interval[0] <= of.interval[1]), "{name}");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let said = |change: fn(&mut Material)| {
        let mut material = preset("blue");
        change(&mut material);
        Laboratory::thesis().measure(&material, 1).expect_err("refused").to_string()
    };
    assert!(said(|material| material.states[0].decay = 0.0).starts_with("blue: sends no light"));
    assert!(said(|material| material.states[0].emission = vec![0.0; 8]).starts_with("blue: sends no light"));
    assert!(said(|material| material.bands = Bands::Rgb).starts_with("blue: described in RGB"));
}

/// What the camera does not see of a material is not known of it, however certain the rest is.
#[test]
fn what_is_not_seen_is_not_known() {
    let mut measurement = Laboratory::thesis().measure(&preset("blue"), 1).expect("a measurement");
    measurement.sensor.iter_mut().for_each(|channel| channel[4] = 0.0);
    let fit = Fit::new("blue", &measurement, 1).expect("a fit");
    for ParameterEstimate { parameter, interval: [low, high], .. } in &fit.estimates {
        let is_known = *parameter != Parameter::Emission(4);
        assert_eq!(high.is_finite(), is_known, "{parameter:?}: {low} to {high}");
        assert!(is_known || *low == 0.0, "{low}");
    }
}

/// The delay until the shutter opens counts: taken for none, rates of excitation come out too small.
#[test]
fn delays_that_are_left_out_are_found_out() {
    let measurement = quiet().measure(&preset("green"), 1).expect("a measurement");
    let mut blind = measurement.clone();
    blind.excitation.iter_mut().for_each(|charged| charged.shot.delay = 0.0);
    let rate = |measurement: &Measurement| {
        Fit::new("green", measurement, 1).expect("a fit").material.states[0].excitation[0]
    };
    assert!(rate(&blind) < 0.97 * rate(&measurement), "{} {}", rate(&blind), rate(&measurement));
}

/// Light that nobody had to measure with excites nothing, and the material says so; the others are known as
/// well as before.
#[test]
fn bands_without_light_are_left_out_by_name() {
    let mut measurement = quiet().measure(&preset("blue"), 1).expect("a measurement");
    measurement.excitation.retain(|charged| charged.band != 1);
    let fit = Fit::new("blue", &measurement, 1).expect("a fit");
    let rates = &fit.material.states[0].excitation;
    near(rates[0], 0.0170, 1e-3, "band 1");
    near(rates[2], 0.0040, 1e-3, "band 3");
    assert_eq!((rates[1], &fit.unmeasured[..]), (0.0, &[1, 3, 4, 5, 6, 7][..]));
    let doubt = fit.material.doubt.as_deref();
    assert_eq!(doubt, Some("excitation by bands 2, 4 to 8 was not measured and is taken for none"));
    let bands = fit.estimates.iter().map(|estimate| estimate.parameter);
    let excited = bands.filter(|parameter| matches!(parameter, Parameter::Excitation(_)));
    assert_eq!(excited.collect::<Vec<_>>(), [Parameter::Excitation(0), Parameter::Excitation(2)]);
    let file = MaterialFile { materials: vec![fit.material], fragments: vec![] };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("fitted.toml");
    std::fs::write(&path, file.text()).expect("written");
    assert_eq!(MaterialFile::read(&path).expect("read"), file);
    assert_eq!(listed_bands(&[7]), "band 8");
}

/// Bands before the one that was measured make nothing less certain.
#[test]
fn bands_without_light_widen_no_interval() {
    let mut first = Laboratory::thesis().measure(&preset("blue"), 1).expect("a measurement");
    first.excitation.retain(|charged| charged.band == 0);
    let mut last = first.clone();
    last.light[7] = first.light[0];
    last.excitation.iter_mut().for_each(|charged| charged.band = 7);
    let [first, last] = [first, last].map(|measurement| {
        let [low, high] = Fit::new("blue", &measurement, 1).expect("a fit").estimates[0].interval;
        (high / low).ln()
    });
    assert!((last / first - 1.0).abs() < 5e-3, "{last}, not {first}");
}

/// What scatters does not grow, whatever its noise is taken for; what grows by more than it scatters does.
#[test]
fn noise_that_is_taken_for_something_refuses_no_decay() {
    let measurement = Laboratory::thesis().measure(&preset("blue"), 1).expect("a measurement");
    let grows = |noise_is_known: bool, radiances: &[f64]| {
        let mut measurement = Measurement { noise_is_known, ..measurement.clone() };
        measurement.decay.truncate(radiances.len());
        for (shot, radiance) in measurement.decay.iter_mut().zip(radiances) {
            shot.value = [radiance * shot.exposure.gain; 3];
            shot.noise = [0.01 * shot.exposure.gain; 3];
        }
        matches!(measurement.check(1), Err(FitError::Grows { .. }))
    };
    assert!(!grows(false, &[1.3, 0.8, 1.0, 1.0, 1.4, 1.2]), "flat");
    assert!(!grows(false, &[0.2, -0.3, 0.0, 0.1, 0.4, -0.1]), "dark");
    assert!(grows(false, &[1.0, 1.1, 1.5, 1.9, 2.4, 2.6]));
    let few = [1.0, 1.1, 1.3, 1.4];
    assert!(grows(true, &few) && !grows(false, &few), "one photograph a third");
}

/// Noise that nobody stated is known to be no noise.
#[test]
fn noise_is_known_where_all_tables_state_it() {
    let laboratory = Laboratory::thesis();
    let measurement = laboratory.measure(&preset("pink"), 7).expect("a measurement");
    let folder = written(&laboratory, &measurement);
    let is_known = || read(folder.path()).expect("read").noise_is_known;
    assert!(is_known());
    let excitation = "band,light_s,time_s,red,green,blue,red_noise\n1,1,0.1,0.1,0.1,0.1,0.01\n";
    std::fs::write(folder.path().join("excitation.csv"), excitation).expect("written");
    assert!(!is_known());
}

#[test]
fn two_excited_states_are_told_apart() {
    let mut material = stickers();
    material.states[0].excitation = vec![0.05, 0.02];
    material.states[1].excitation = vec![0.01, 0.03];
    let laboratory = Laboratory { excited: 2, ..quiet() };
    let fit = Fit::new("two", &laboratory.measure(&material, 3).expect("a measurement"), 2).expect("a fit");
    for (found, expected) in fit.material.states.iter().zip(&material.states) {
        found.excitation.iter().zip(&expected.excitation).for_each(|(a, b)| near(*a, *b, 1e-3, "excitation"));
    }
}

#[test]
fn three_states_explain_three() {
    let mut material = stickers();
    material.states.push(State { decay: 0.6, ..material.states[0].clone() });
    let laboratory = Laboratory { interval: 1.0, open: 0.2, count: 180, pixels: 1e9, ..Laboratory::thesis() };
    let measurement = laboratory.measure(&material, 3).expect("a measurement");
    let fit = Fit::new("three", &measurement, 3).expect("a fit");
    let decays: Vec<f64> = fit.material.states.iter().map(|state| state.decay).collect();
    decays
        .iter()
        .zip([0.6, 0.132, 0.009])
        .for_each(|(found, expected)| near(*found, expected, 0.01, "decay"));
    assert!(fit.residual_over_noise() < 1.1, "{}", fit.residual_over_noise());
    let two = Fit::new("three", &measurement, 2).expect("a fit");
    assert!(two.residual_over_noise() > 10.0, "two states do not: {}", two.residual_over_noise());
}

/// Photographs alone give a material in the camera's RGB.
#[test]
fn photographs_without_filters_give_rgb() {
    let spectral = quiet().measure(&preset("blue"), 1).expect("a measurement");
    let measurement = in_rgb(&spectral);
    let state = &Fit::new("blue", &measurement, 1).expect("a fit").material.states[0];
    near(state.decay, 0.032, 1e-4, "decay");
    let preset = preset("blue");
    for (channel, found) in state.emission.iter().enumerate() {
        let pairs = spectral.sensor[channel].iter().zip(&preset.states[0].emission);
        near(*found, pairs.map(|(a, b)| a * b).sum(), 1e-4, "emission");
    }
    assert!(state.excitation.is_empty());
}

#[test]
fn measurements_written_and_read_are_the_same() {
    let laboratory = Laboratory::thesis();
    let measurement = laboratory.measure(&preset("pink"), 7).expect("a measurement");
    let folder = written(&laboratory, &measurement);
    assert_eq!(read(folder.path()).expect("read"), measurement);
    let decay = folder.path().join("decay.csv");
    std::fs::write(&decay, "time_s,red,green,blue\n0,1,1,1\n5,1,,1\n").expect("written");
    let fault = read(folder.path()).expect_err("a gap");
    let source = std::error::Error::source(&fault).expect("a source").to_string();
    assert!(source.ends_with("decay.csv:3: green is \"\", not a finite number"), "{source}");
    std::fs::write(&decay, "time_s,red,green,blue\n5,1,1,1\n0,1,1,1\n").expect("written");
    let fault = read(folder.path()).expect_err("out of order");
    assert!(
        std::error::Error::source(&fault).expect("a source").to_string().contains("decay.csv:3: time_s is 0")
    );
}

/// A measurement under another lamp says which, band by band; light that it lacks excites nothing.
#[test]
fn lamps_are_written_and_read() {
    for lamp in Light::ALL {
        let laboratory = Laboratory { lamp, ..quiet() };
        let measurement = laboratory.measure(&preset("blue"), 3).expect("a measurement");
        let folder = written(&laboratory, &measurement);
        assert_eq!(folder.path().join("light.csv").exists(), lamp != Light::Halogen);
        let found = read(folder.path()).expect("read");
        let off = found.light.iter().zip(&measurement.light).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{lamp:?}: {off}");
        let excited = if lamp == Light::Mercury { 1 } else { 3 };
        assert_eq!(measurement.excited_bands(), excited, "{lamp:?}");
        let fit = Fit::new("blue", &found, 1).expect("a fit");
        let rates = &fit.material.states[0].excitation;
        for (found, expected) in rates.iter().zip([0.0170, 0.0500]).take(excited) {
            assert!((found / expected - 1.0).abs() < 0.05, "{lamp:?}: {rates:?}");
        }
    }
}

#[test]
fn what_cannot_be_fitted_is_said() {
    let measurement = Laboratory::thesis().measure(&preset("blue"), 1).expect("a measurement");
    let fault = |change: &dyn Fn(&mut Measurement)| {
        let mut changed = measurement.clone();
        change(&mut changed);
        Fit::new("x", &changed, 1).expect_err("a fault")
    };
    assert!(matches!(Fit::new("x", &measurement, 4), Err(FitError::States(4))));
    assert!(matches!(
        fault(&|m| m.decay.truncate(2)),
        FitError::TooFew { what: "decay", count: 2, least: 3 }
    ));
    assert!(matches!(fault(&|m| m.spectrum.clear()), FitError::TooFew { what: "spectrum", .. }));
    let once = |m: &mut Measurement| m.excitation.retain(|c| c.band != 1 || c.seconds == 1.0);
    assert!(matches!(fault(&once), FitError::TooFew { count: 1, least: 2, .. }));
    assert_eq!(fault(&|m| m.decay.iter_mut().for_each(|shot| shot.value = [0.0; 3])), FitError::Dark);
    let bright = |radiance: fn(f64) -> f64| {
        move |m: &mut Measurement| {
            for (index, shot) in m.decay.iter_mut().enumerate() {
                shot.value = [radiance(index as f64) * shot.exposure.gain; 3];
            }
        }
    };
    assert!(
        matches!(fault(&bright(|index| 1.0 + index)), FitError::Grows { first, last } if last > 3.0 * first)
    );
    let mut steady = measurement.clone();
    bright(|index| 1.0 + 0.001 * index)(&mut steady);
    assert!(!matches!(Fit::new("x", &steady, 1), Err(FitError::Grows { .. })), "cameras drift");
    let senseless =
        |change: &dyn Fn(&mut Measurement)| assert!(matches!(fault(change), FitError::Measurement(_)));
    senseless(&|m| m.decay[3].value[1] = f64::NAN);
    senseless(&|m| m.decay[3].noise[1] = 0.0);
    senseless(&|m| m.spectrum[0].filter = 31);
    senseless(&|m| m.light[2] = 0.0);
    senseless(&|m| m.sensor[0].truncate(3));
    senseless(&|m| m.excitation[0].seconds = f64::INFINITY);
}

#[test]
fn photographs_are_averaged_under_their_mask() {
    let exposure = Exposure::of_camera(2.0, 400.0, 2.0);
    let pixels = [[1.0, 2.0, 3.0], [3.0, 2.0, 5.0], [f64::NAN; 3]];
    let shot = Shot::of_pixels(0.5, exposure, &pixels, &[true, true, false]).expect("a shot");
    // Both pixels of green are alike: it is known to a step of 16 bits, of two.
    let step = 1.0 / 65_535.0 / 24f64.sqrt();
    assert_eq!((shot.value, shot.noise), ([2.0, 2.0, 4.0], [1.0, step, 1.0]));
    assert_eq!((exposure.gain, shot.radiance()), (2.0, [1.0, 1.0, 2.0]));
    let fault = |mask: &[bool]| Shot::of_pixels(0.5, exposure, &pixels, mask).expect_err("a fault");
    assert_eq!(fault(&[false; 3]), "the mask leaves 0 pixels, at least 2 are needed");
    assert_eq!(fault(&[true; 3]), "pixel 2 is not finite");
    assert_eq!(fault(&[true; 2]), "a mask of 2 pixels for a photograph of 3");
}

#[test]
fn gains_are_measured_from_the_same_thing_twice() {
    let gain = relative_gain(&[0.1, 0.2, 0.4], &[0.21, 0.39, 0.81]).expect("a gain");
    assert!((gain - 2.01).abs() < 0.01, "{gain}");
    assert_eq!(relative_gain(&[0.0; 3], &[1.0; 3]), None);
    assert_eq!(relative_gain(&[1.0], &[1.0]), None);
}
