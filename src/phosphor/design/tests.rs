use super::*;
use deepshade_render::path::phosphor::Afterglow;
use deepshade_render::phosphor::material::State;
use deepshade_render::phosphor::paint::Paint;
use deepshade_render::phosphor::spectrum::Bands;
use deepshade_render::scene::Look;
use deepshade_render::scene::glow::Glow;
use std::path::Path;
use std::sync::Arc;
use task::{WantedKey, WantedPlace};

/// The places that are looked at: by the moments of their keys.
const TIMES: [f32; 6] = [1.5, 3.0, 6.0, 9.0, 14.0, 19.0];

fn hidden(bands: Bands) -> Material {
    let in_bands = |colour| bands.of_linear_srgb(colour);
    let excitation = bands.of_linear_srgb([0.002, 0.01, 0.05]);
    let state = State { decay: 0.11, excitation, emission: in_bands([0.3, 2.0, 1.1]) };
    Material { name: "hidden".to_owned(), bands, doubt: None, states: vec![state] }
}

/// A task for two places of a room, whose lamps blink, without keys.
fn task(bands: Bands, at: &[Vec3]) -> Task {
    let lamps = "[[lamps]]\nlights = [0]\non = [[0.0, 2.0], [5.0, 7.5], [11.0, 11.5]]\n";
    let text = format!("scene = 'room:7'\nplace = []\nframes = 200\nfps = 10\n{lamps}");
    let mut task: Task = toml::from_str(&text).expect("a task");
    let keys = |_| TIMES.map(|time| WantedKey { time, colour: vec![0.0; 3] }).to_vec();
    task.bands = bands;
    task.places = at.iter().map(|at| WantedPlace { at: *at, keys: keys(at) }).collect();
    task
}

/// The radiance that truth shows of a place with a material.
fn rendered(task: &Task, spot: &Spot, material: &Material, time: f32) -> Vec<f64> {
    let scene = light::at(task, time).expect("a scene");
    let paint = Paint::new(material).expect("few states");
    let glow = Glow { surfaces: vec![(None, paint.clone())], ..Glow::of(scene.scene()).clone() };
    let look = Look { glow: Some(Arc::new(glow)), ..scene.scene().look() };
    let scene = scene.with_look(look).expect("a look");
    let shares = Afterglow::new(&scene).shares(spot.mesh, spot.triangle, spot.weights).expect("paint");
    paint.emission(&shares).as_dvec3().to_array().to_vec()
}

/// Two places on the floor that the lamp lights.
const LIT: [Vec3; 2] = [Vec3::new(1.5, 0.0, 0.5), Vec3::new(-1.5, 0.0, 0.5)];

#[test]
fn parameters_are_found_again_from_what_was_rendered_with_them() {
    for bands in [Bands::Rgb, Bands::Eight] {
        let blank = task(bands, &[]);
        let scene = light::at(&blank, 0.0).expect("a room");
        let mut task = task(bands, &LIT);
        let hidden = hidden(bands);
        for place in &mut task.places {
            let spot = light::spot(&scene, place.at).expect("a floor");
            for key in &mut place.keys {
                key.colour = rendered(&blank, &spot, &hidden, key.time);
            }
        }
        let found = designs(&task, &scene).expect("designs");
        let residual: f64 = found.iter().map(|found| found.design.residual / found.wanted()).sum();
        assert!(residual < 1e-5, "{bands:?}: {residual}");
        for found in &found {
            let decay = found.design.material.states[0].decay;
            assert!((decay / 0.11 - 1.0).abs() < 0.02, "{bands:?}: {decay}");
            assert!(found.design.residual <= found.grid, "{} {}", found.design.residual, found.grid);
        }
    }
}

/// What is written is what `--phosphor` reads, and materials like those of the places get paint like theirs.
#[test]
fn files_are_those_that_rendering_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = light::at(&task(Bands::Rgb, &[]), 0.0).expect("a room");
    let at = LIT[0].to_array();
    let text = format!(
        "scene = 'room:7'\nframes = 60\nfps = 10\n[spread]\ndistance = 1e4\ncolour = 10.0\n\
         [[place]]\nat = {at:?}\nkeys = [{{ time = 2.0, colour = [0.01, 0.02, 0.03] }}]\n"
    );
    let file = folder.path().join("wanted.toml");
    std::fs::write(&file, text).expect("written");
    let out = folder.path().join("designed");
    let args = Args { file, out: out.clone(), height: 32, json: Some(out.join("design.json")) };
    run(&args).expect("a design");
    let glow = Glow::read(&out.join("glow.toml"), 2.0).expect("a sound file");
    assert_eq!(glow.check(scene.scene()), Ok(()));
    assert!(glow.surfaces.len() > 1, "it has spread: {}", glow.surfaces.len());
    for name in ["materials.toml", "place-1.svg", "strip.png", "design.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let missing = Args { file: Path::new("none.toml").into(), out, height: 32, json: None };
    assert!(format!("{:#}", run(&missing).expect_err("no file")).contains("none.toml"));
}

#[test]
fn places_that_cannot_be_are_refused() {
    let scene = light::at(&task(Bands::Rgb, &[]), 0.0).expect("a room");
    let far = task(Bands::Rgb, &[Vec3::splat(1e3)]);
    assert!(
        format!("{:#}", designs(&far, &scene).err().expect("far away")).contains("from the next surface")
    );
    let mut dark = task(Bands::Rgb, &LIT[..1]);
    dark.lamps[0].lights = None;
    dark.lamps[0].on = vec![[100.0, 101.0]];
    let scene = light::at(&dark, 0.0).expect("a room");
    assert!(format!("{:#}", designs(&dark, &scene).err().expect("dark")).contains("no light of lamps"));
}
