use super::*;
use crate::simulation::Simulation;

/// 200 frames in which lights of different colours come and go.
fn animation(bands: Bands) -> Vec<Vec<f64>> {
    let count = bands.count();
    let light = |frame: usize, band: usize| {
        let phase = frame as f64 / 200.0 * std::f64::consts::TAU;
        (1.0 + (phase * (1.0 + 0.5 * band as f64) + band as f64).sin()) * if frame < 130 { 1.0 } else { 0.1 }
    };
    (0..200).map(|frame| (0..count).map(|band| light(frame, band)).collect()).collect()
}

fn state(decay: f64, excitation: &[f64], emission: &[f64]) -> State {
    State { decay, excitation: excitation.to_vec(), emission: emission.to_vec() }
}

fn material(bands: Bands, states: Vec<State>) -> Material {
    Material { name: "hidden".into(), bands, doubt: None, states }
}

/// A place that should look at some frames as it does with a material.
fn place(material: &Material, frames: &[usize]) -> TargetPoint {
    let bands = material.bands;
    let key = |frame: &usize| Key { frame: *frame, radiance: vec![0.0; bands.count()] };
    let irradiance = animation(bands);
    let reflected = |light: &Vec<f64>| light.iter().map(|light| 0.3 * light / std::f64::consts::PI).collect();
    let mut place = TargetPoint {
        bands,
        dt: 0.25,
        reflected: irradiance.iter().map(reflected).collect(),
        irradiance,
        keys: frames.iter().map(key).collect(),
    };
    let seen = seen(material, &place);
    place.keys.iter_mut().zip(seen).for_each(|(key, seen)| key.radiance = seen);
    place
}

/// How a place looks at its keys with a material.
fn seen(material: &Material, place: &TargetPoint) -> Vec<Vec<f64>> {
    let mut run = Simulation::dark(material);
    let mut seen = vec![Vec::new(); place.keys.len()];
    for (frame, light) in place.irradiance.iter().enumerate() {
        if let Some(key) = place.keys.iter().position(|key| key.frame == frame) {
            seen[key] = run.emission().iter().zip(&place.reflected[frame]).map(|(a, b)| a + b).collect();
        }
        run.step(light, place.dt).expect("a step");
    }
    seen
}

fn one() -> Material {
    material(Bands::Rgb, vec![state(0.047, &[0.002, 0.011, 0.06], &[0.4, 3.0, 1.7])])
}

#[test]
fn hidden_parameters_are_found_again() {
    let hidden = one();
    let found = Design::new("found", &[place(&hidden, &[20, 70, 120, 150, 190])], 1).expect("a design");
    let (found_state, state) = (&found.material.states[0], &hidden.states[0]);
    assert!(found.residual < 1e-12, "{found:?}");
    assert!((found_state.decay / state.decay - 1.0).abs() < 0.01, "{found:?}");
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02 * b + 1e-4);
    assert!(near(&found_state.excitation, &state.excitation), "{found:?}");
    assert!(near(&found_state.emission, &state.emission), "{found:?}");
}

#[test]
fn two_states_are_found_again() {
    let fast = state(0.2, &[0.01, 0.03, 0.05], &[3.0, 0.5, 0.2]);
    let slow = state(0.01, &[0.002, 0.01, 0.03], &[0.2, 2.0, 9.0]);
    let hidden =
        place(&material(Bands::Rgb, vec![fast, slow]), &[15, 40, 60, 90, 115, 135, 140, 150, 170, 199]);
    let size: f64 = hidden.wanted().iter().flatten().map(|value| value * value).sum();
    let [one, two] = [1, 2].map(|states| {
        Design::new("found", std::slice::from_ref(&hidden), states).expect("a design").residual
    });
    assert!(two < 1e-6 * size && one > 100.0 * two, "{one} {two} of {size}");
}

/// The mean of designs is of fast states and of slow ones, in whatever order they were found.
#[test]
fn designs_spread_state_by_state() {
    let frames = [15, 40, 60, 90, 115, 135, 140, 150, 170, 199];
    let designed = |[fast, slow]: [f64; 2], emission: [&[f64]; 2]| {
        let states = vec![
            state(fast, &[0.01, 0.03, 0.05], emission[0]),
            state(slow, &[0.002, 0.01, 0.03], emission[1]),
        ];
        let hidden = [place(&material(Bands::Rgb, states), &frames)];
        Design::new("found", &hidden, 2).expect("a design").material
    };
    let (red, blue): (&[f64], &[f64]) = (&[3.0, 0.5, 0.2], &[0.2, 2.0, 9.0]);
    let edit = |(index, material): (usize, Material)| {
        let rates: Vec<f64> = material.states.iter().map(|state| state.decay).collect();
        assert!(rates[0] > rates[1], "{index}: {rates:?}");
        Edit { feature: feature(index as f64), material }
    };
    let found = [
        designed([0.2, 0.01], [red, blue]),
        designed([0.2, 0.01], [blue, red]),
        designed([0.12, 0.015], [red, blue]),
        designed([0.12, 0.015], [blue, red]),
    ];
    let edits: Vec<Edit> = found.into_iter().enumerate().map(edit).collect();
    // All count alike.
    let reach = Reach { distance: 1e6, colour: 1.0 };
    let mean = reach.propagate(&edits, feature(1.5)).expect("a material").material;
    for (place, state) in mean.states.iter().enumerate() {
        let rates = edits.iter().map(|edit| edit.material.states[place].decay.ln());
        let expected = (rates.sum::<f64>() / edits.len() as f64).exp();
        assert!((state.decay / expected - 1.0).abs() < 1e-6, "{place}: {} {expected}", state.decay);
    }
    assert!(mean.states[0].decay > mean.states[1].decay, "{mean:?}");
}

fn feature(x: f64) -> Feature {
    Feature { position: [x, 0.0, 0.0], colour: [0.5; 3] }
}

/// Two places in different light know more of a material than one does: each has too few keys alone.
#[test]
fn places_that_share_a_material_find_it_together() {
    let hidden = one();
    let dim = |place: TargetPoint, by: f64| {
        let light = |values: &Vec<f64>| values.iter().zip([1.0, by, by * by]).map(|(a, b)| a * b).collect();
        TargetPoint { irradiance: place.irradiance.iter().map(light).collect(), ..place }
    };
    let lit = |by: f64, frames: &[usize]| {
        let mut dimmed = dim(place(&hidden, frames), by);
        let seen = seen(&hidden, &dimmed);
        dimmed.keys.iter_mut().zip(seen).for_each(|(key, seen)| key.radiance = seen);
        dimmed
    };
    let places = [lit(1.0, &[30, 120, 190]), lit(0.2, &[60, 140]), lit(4.0, &[20, 100, 170])];
    let found = Design::new("found", &places, 1).expect("a design");
    assert!(found.residual < 1e-12, "{found:?}");
    assert!((found.material.states[0].decay / hidden.states[0].decay - 1.0).abs() < 0.01, "{found:?}");
}

#[test]
fn eight_bands_are_designed() {
    let excitation = [0.017, 0.05, 0.004, 0.0, 0.0, 0.0, 0.0, 0.0];
    let emission = [0.34, 4.37, 3.65, 0.55, 0.0, 0.01, 0.0, 0.0];
    let hidden =
        place(&material(Bands::Eight, vec![state(0.032, &excitation, &emission)]), &[30, 90, 140, 190]);
    let size: f64 = hidden.wanted().iter().flatten().map(|value| value * value).sum();
    let found = Design::new("found", std::slice::from_ref(&hidden), 1).expect("a design");
    assert!(found.residual < 1e-6 * size, "{} of {size}: {:?}", found.residual, found.material);
}

/// Wanted colours that no material has: the residual is at most that of the thesis' grid, and what is said of
/// it is true.
#[test]
fn residuals_are_never_above_those_of_the_thesis() {
    let mut noise = crate::noise::Noise::new(11);
    for _ in 0..5 {
        let mut impossible = place(&one(), &[25, 80, 130, 180]);
        for key in &mut impossible.keys {
            key.radiance.iter_mut().for_each(|value| *value *= 2.0 * noise.uniform());
        }
        let grid = thesis_grid(std::slice::from_ref(&impossible)).expect("a grid");
        for states in [1, 2] {
            let found = Design::new("found", std::slice::from_ref(&impossible), states).expect("a design");
            assert!(found.residual <= grid, "{states} states: {} {grid}", found.residual);
            let looks = place(&found.material, &[25, 80, 130, 180]);
            let pairs =
                looks.keys.iter().zip(&impossible.keys).flat_map(|(a, b)| a.radiance.iter().zip(&b.radiance));
            let off: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            assert!((off - found.residual).abs() < 1e-9 * (1.0 + off), "{off} {}", found.residual);
        }
    }
}

/// Light that is gone at once wants a decay beyond all that are looked for; what was found again above does
/// not.
#[test]
fn what_ends_at_a_bound_of_the_search_is_said() {
    let key = |frame, radiance| Key { frame, radiance: vec![radiance; 3] };
    let place = TargetPoint {
        bands: Bands::Rgb,
        dt: 0.25,
        irradiance: (0..12).map(|frame| vec![f64::from(u8::from(frame < 10)); 3]).collect(),
        reflected: vec![],
        keys: vec![key(10, 1.0), key(11, 0.0)],
    };
    let found = Design::new("found", &[place], 1).expect("a design");
    assert_eq!(found.at_bounds(), ["state 1: decay is 10 per second"], "{found:?}");
    let hidden = one();
    let within = Design { material: hidden.clone(), residual: 0.0 };
    assert!(within.at_bounds().is_empty());
    let states = vec![hidden.states[0].clone(), state(1e-5, &[0.0, 100.0, 3.0], &[1.0; 3])];
    let slow = Design { material: material(Bands::Rgb, states), residual: 0.0 };
    let expected =
        ["state 2: decay is 0.00001 per second", "state 2: excitation by band 2 is 100 per second"];
    assert_eq!(slow.at_bounds(), expected);
}

#[test]
fn a_single_key_is_met() {
    let found = Design::new("found", &[place(&one(), &[100])], 2).expect("a design");
    assert!(found.residual < 1e-12, "{found:?}");
    let at_start = Design::new("found", &[place(&one(), &[0])], 1).expect("a design");
    assert!(at_start.residual < 1e-24 && at_start.material.clone().checked().is_ok(), "{at_start:?}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = place(&one(), &[20, 70]);
    let said =
        |places: &[TargetPoint], states| Design::new("x", places, states).expect_err("a fault").to_string();
    let fault = |change: &dyn Fn(&mut TargetPoint)| {
        let mut changed = good.clone();
        change(&mut changed);
        said(&[changed], 1)
    };
    assert_eq!(said(std::slice::from_ref(&good), 3), "3 states: 1 or 2 can be designed");
    assert_eq!(said(&[], 1), "a design needs one place at least");
    let other = place(&material(Bands::Eight, vec![state(0.1, &[0.1], &[1.0; 8])]), &[20]);
    assert_eq!(said(&[good.clone(), other], 1), "places of the same material differ in their bands");
    assert_eq!(fault(&|p| p.keys.clear()), "a design needs one key frame at least");
    assert_eq!(fault(&|p| p.keys[0].frame = 200), "a key at frame 200: there are frames 0 to 199");
    assert_eq!(fault(&|p| p.keys[0].frame = 70), "place 1 has two keys at frame 70");
    assert_eq!(fault(&|p| p.reflected.truncate(7)), "reflected light of 7 frames, irradiance of 200");
    assert!(fault(&|p| p.dt = 0.0).starts_with("0 s between frames"));
    assert!(fault(&|p| p.irradiance[3][1] = f64::NAN).starts_with("irradiance is ["));
    assert!(fault(&|p| p.keys[1].radiance.truncate(1)).starts_with("a key's radiance is ["));
}
