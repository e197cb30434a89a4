use super::*;
use deepshade_glow::material::State;
use deepshade_glow::paint::Paint;
use deepshade_glow::spectrum::Bands;
use deepshade_glow::spectrum::lights::Light;
use deepshade_render::path::phosphor::Afterglow;
use deepshade_render::scene::Look;
use deepshade_render::scene::glow::{Glow, GlowSurface};
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

fn switched(task: &Task) -> SwitchedScene {
    SwitchedScene::new(task).expect("a scene")
}

/// The radiance that truth shows of a place with a material.
fn rendered(task: &Task, spot: &Spot, material: &Material, time: f32) -> Vec<f64> {
    let scene = switched(task).at(time).expect("a scene");
    let paint = Paint::new(material, task.spectrum).expect("few states");
    let glow =
        Glow { surfaces: vec![GlowSurface::new(None, paint.clone())], ..Glow::of(scene.scene()).clone() };
    let look = Look { glow: Some(Arc::new(glow)), ..scene.scene().look() };
    let scene = scene.with_look(look).expect("a look");
    let shares = Afterglow::new(&scene).shares(spot.mesh, spot.triangle, spot.weights).expect("paint");
    paint.emission(&shares).as_dvec3().to_array().to_vec()
}

/// Two places on the floor that the lamp lights.
const LIT: [Vec3; 2] = [Vec3::new(1.5, 0.0, 0.5), Vec3::new(-1.5, 0.0, 0.5)];

#[test]
fn parameters_are_found_again_from_what_was_rendered_with_them() {
    let asked = [
        (Bands::Rgb, None),
        (Bands::Eight, None),
        (Bands::Rgb, Some(Light::Daylight)),
        (Bands::Eight, Some(Light::Mercury)),
    ];
    for (bands, spectrum) in asked {
        let blank = Task { spectrum, ..task(bands, &[]) };
        let scene = switched(&blank).at(0.0).expect("a room");
        let mut task = Task { spectrum, ..task(bands, &LIT) };
        let hidden = hidden(bands);
        for place in &mut task.places {
            let spot = light::spot(&scene, place.at).expect("a floor");
            for key in &mut place.keys {
                key.colour = rendered(&blank, &spot, &hidden, key.time);
            }
        }
        let found = designs(&task, &switched(&task), Vec3::ZERO).expect("designs");
        let residual: f64 = found.iter().map(|found| found.design.residual / found.wanted()).sum();
        assert!(residual < 1e-5, "{bands:?} {spectrum:?}: {residual}");
        for found in &found {
            let decay = found.design.material.states[0].decay;
            assert!((decay / 0.11 - 1.0).abs() < 0.02, "{bands:?} {spectrum:?}: {decay}");
            assert!(found.design.residual <= found.grid, "{} {}", found.design.residual, found.grid);
        }
    }
}

/// What is written is what `--phosphor` reads, and materials like those of the places get paint like theirs.
#[test]
fn files_are_those_that_rendering_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = switched(&task(Bands::Rgb, &[])).at(0.0).expect("a room");
    let at = LIT[0].to_array();
    let text = format!(
        "scene = 'room:7'\nframes = 60\nfps = 10\nspectrum = 'led'\n[spread]\ndistance = 1e4\ncolour = 10.0\n\
         [[place]]\nat = {at:?}\nkeys = [{{ time = 2.0, colour = [0.01, 0.02, 0.03] }}]\n"
    );
    let file = folder.path().join("wanted.toml");
    std::fs::write(&file, text).expect("written");
    let out = folder.path().join("designed");
    let args = Args { file, out: out.clone(), height: 32, json: Some(out.join("design.json")) };
    run(&args).expect("a design");
    let glow = Glow::read(&out.join("glow.toml"), 2.0).expect("a sound file");
    assert_eq!(glow.check(scene.scene()), Ok(()));
    let text = std::fs::read_to_string(out.join("glow.toml")).expect("written");
    assert!(text.contains("spectrum = \"led\""), "{text}");
    assert!(glow.surfaces.len() > 1, "it has spread: {}", glow.surfaces.len());
    for name in ["materials.toml", "place-1.svg", "strip.png", "design.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let missing = Args { file: Path::new("none.toml").into(), out, height: 32, json: None };
    assert!(format!("{:#}", run(&missing).expect_err("no file")).contains("none.toml"));
}

#[test]
fn places_that_cannot_be_are_refused() {
    let said = |task: &Task| {
        format!("{:#}", designs(task, &switched(task), Vec3::ZERO).err().expect("no such design"))
    };
    let far = task(Bands::Rgb, &[Vec3::splat(1e3)]);
    assert!(said(&far).contains("from the next surface"));
    let mut dark = task(Bands::Rgb, &LIT[..1]);
    dark.lamps[0].lights = None;
    dark.lamps[0].on = vec![[100.0, 101.0]];
    assert!(said(&dark).contains("no light of lamps"));
}

/// Two sheets beside each other, of materials that have one name.
const TWINS: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}},
    "scenes":[{"nodes":[0,1,2]}],
    "nodes":[{"mesh":0},{"mesh":1,"translation":[5,0,0]},
        {"translation":[2,3,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "materials":[{"name":"paper"},{"name":"paper"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]},
        {"primitives":[{"attributes":{"POSITION":0},"material":1}]}],
    "buffers":[{"uri":"sheet.bin","byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-2,0,-2],"max":[2,0,2]}]}"#;

#[test]
fn of_materials_of_one_name_the_one_of_the_place_is_designed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let corners = [-2.0f32, 0.0, -2.0, 0.0, 0.0, 2.0, 2.0, 0.0, -2.0];
    std::fs::write(path("sheet.bin"), corners.map(f32::to_le_bytes).as_flattened()).expect("written");
    std::fs::write(path("twins.gltf"), TWINS).expect("written");
    let text = "scene = 'twins.gltf'\nframes = 20\nfps = 10\n[[place]]\nat = [5.1, 0, 0]\n\
        keys = [{ time = 1.5, colour = [0.01, 0.02, 0.03] }]\n[view]\neye = [2, 4, 3]\nlook_at = [2.5, 0, 0]\n";
    std::fs::write(path("wanted.toml"), text).expect("written");
    let args = Args { file: path("wanted.toml"), out: path("designed"), height: 32, json: None };
    run(&args).expect("a design");
    let scene = switched(&Task::read(&args.file).expect("a task")).at(0.0).expect("a scene");
    let glow = Glow::read(&args.out.join("glow.toml"), 1.5).expect("a sound file");
    assert_eq!(glow.surfaces[0].material.as_deref(), Some("paper#2"));
    assert_eq!(glow.paints_of(scene.scene())[..2], [None, Some(0)]);
}

/// A square on the floor, seen from above, under a lamp that goes round it within 4 seconds: from above to
/// below and back.
const AROUND: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}},
    "scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"translation":[0,2,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "materials":[{"name":"paper","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.4,0.2,1],"metallicFactor":0}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
        "samplers":[{"input":1,"output":2,"interpolation":"STEP"}]}],
    "buffers":[{"uri":"around.bin","byteLength":68}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
        {"buffer":0,"byteOffset":44,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-2,0,-2],"max":[2,0,2]},
        {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]},
        {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}]}"#;

/// The lamp is above the paper for two seconds, and as far below it for two: both excite alike, and who looks
/// from above sees what is reflected above alone. The file is read once.
#[test]
fn reflected_light_is_that_of_the_side_that_is_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let corners = [-2.0f32, 0.0, -2.0, 0.0, 0.0, 2.0, 2.0, 0.0, -2.0];
    let (times, lamp) = ([0.0f32, 2.0], [0.0f32, 2.0, 0.0, 0.0, -2.0, 0.0]);
    let bytes: Vec<u8> = corners.into_iter().chain(times).chain(lamp).flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.path().join("around.bin"), bytes).expect("written");
    let file = folder.path().join("around.gltf");
    std::fs::write(&file, AROUND).expect("written");
    let text = format!("scene = '{}'\nplace = []\nframes = 8\nfps = 2\nreflected = true\n", file.display());
    let mut task: Task = toml::from_str(&text).expect("a task");
    task.places = vec![WantedPlace { at: Vec3::new(0.1, 0.0, 0.0), keys: vec![] }];
    let switched = switched(&task);
    std::fs::remove_file(&file).expect("deleted");
    let first = switched.at(0.0).expect("a scene");
    let spots = [light::spot(&first, task.places[0].at).expect("paper")];
    assert!(spots[0].albedo(&first).min_element() > 0.1);
    for (eye, lit) in [(Vec3::Y * 4.0, 0..4), (Vec3::NEG_Y * 4.0, 4..8)] {
        let [excites, reflected] = light::received(&task, &switched, &first, (&spots, eye)).expect("light");
        for frame in 0..8 {
            let irradiance = excites[0][frame];
            assert!((irradiance / excites[0][0] - 1.0).abs().max_element() < 1e-5, "{frame}: {irradiance}");
            let share = if lit.contains(&frame) { spots[0].albedo(&first) } else { Vec3::ZERO };
            let expected = share * irradiance / std::f32::consts::PI;
            let found = reflected[0][frame];
            assert!(
                (found - expected).abs().max_element() <= 1e-5 * irradiance.x,
                "{frame}: {found} {expected}"
            );
        }
    }
}

/// Places are plotted by their numbers in the task, whatever order their materials have in the scene.
#[test]
fn plots_have_the_numbers_of_their_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let blank = task(Bands::Rgb, &[]);
    let scene = switched(&blank).at(0.0).expect("a room");
    let wall = Vec3::new(1.5, 1.6, scene.bounds().min.z);
    let mut places = [LIT[0], wall].map(|at| (light::spot(&scene, at).expect("a surface").material, at));
    places.sort_by_key(|(material, _)| std::cmp::Reverse(*material));
    let [(first, one), (second, two)] = places;
    assert!(first > second, "the first place's material is the later one: {first} {second}");
    let mut task = task(Bands::Rgb, &[one, two]);
    task.lamps.clear();
    for (place, red) in task.places.iter_mut().zip([0.01, 0.02]) {
        place.keys.iter_mut().for_each(|key| key.colour = vec![red, 0.01, 0.01]);
    }
    let found = designs(&task, &switched(&task), Vec3::ZERO).expect("designs");
    pictures::plots(&task, &found, folder.path()).expect("plots");
    for (number, material) in [(1, first), (2, second)] {
        let svg = std::fs::read_to_string(folder.path().join(format!("place-{number}.svg"))).expect("a plot");
        let (at, name) = (task.places[number - 1].at, &scene.scene().material_names()[material]);
        let title = format!("Place {number} at {at}, {name}: wanted (dots) and reached");
        assert!(svg.contains(&title), "{title}: {svg}");
    }
    let moments = strip::moments(&found);
    assert_eq!(moments.keys().copied().collect::<Vec<_>>(), TIMES.map(|time| (time * 10.0) as usize));
    assert!(moments.values().all(|places| places == &[1, 2]), "{moments:?}");
}
