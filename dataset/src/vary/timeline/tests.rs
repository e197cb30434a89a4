use super::super::tests::{recipe, record, sliding};
use super::*;
use crate::{Dataset, Props, Recipe, generate};
use deepshade_render::path::{Sampling, Shot, render};
use deepshade_shaders::{Attribute, Effect};
use std::path::Path;

/// A lamp that shines for the second half of the first second, and frames half a second apart.
const TIMELINE: &str = "timeline = { seconds = 0.5, on = [[0.5, 1.0], [5.0, 6.0]] }";

/// A recipe of sequences of four frames, in which the camera stands still.
fn films(folder: &Path, vary: &str) -> Recipe {
    let recipe = recipe(folder, "phosphor", "");
    let path = folder.join("films.toml");
    let sequence = "sequence = { frames = 4, turn = 0.0, step = 0.0 }\n";
    let text = std::fs::read_to_string(&recipe.path).expect("a recipe");
    let text = text.replace("views_per_scene = 2", "views_per_scene = 4").replace("= 0.5\n", "= 0.0\n");
    std::fs::write(&path, format!("{sequence}vary = {{ {TIMELINE}, light = true{vary} }}\n{text}"))
        .expect("written");
    Recipe::load(&path).expect("a sound recipe")
}

/// The frames of a recipe's only sequence: what was drawn for each, and the scene that it shows.
fn frames(recipe: &Recipe) -> Vec<(Camera, Variation, Arc<TracedScene>)> {
    let props = Props::load(recipe).expect("textures");
    let planned = &recipe.plan().expect("a plan")[0];
    let staged = StagedScene::load(&record(recipe), recipe, &props).expect("a scene");
    let frame = |view| {
        let (camera, variation) = staged.drawn(planned.key, view).expect("a view");
        let scene = staged.shown(&camera, variation.as_ref()).expect("shown");
        (camera, variation.expect("drawn"), scene)
    };
    planned.views.iter().map(frame).collect()
}

#[test]
fn frames_of_a_sequence_share_all_but_their_moments_and_things_go_on_evenly() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = films(folder.path(), ", materials = true, motion = [1.0, 3.0]");
    let frames = frames(&recipe);
    let (camera, first, scene) = &frames[0];
    let base = record(&recipe).load(&recipe.folder).expect("a scene");
    let mut count = 0;
    for (number, (seen_by, variation, shown)) in (1..).zip(&frames) {
        assert_eq!((seen_by, variation.seed, variation.lamp), (camera, first.seed, first.lamp));
        assert_eq!(variation.moment.map(|moment| moment.time), Some(0.5 * number as f32));
        assert_eq!(format!("{:?}", shown.scene().materials), format!("{:?}", scene.scene().materials));
        for (mesh, resting) in shown.scene().meshes.iter().zip(&base.scene().meshes) {
            for ((position, way), rest) in
                mesh.positions.iter().zip(&mesh.displacements).zip(&resting.positions)
            {
                let gone = *position - *rest;
                assert!(gone.distance(number as f32 * *way) < 1e-5 * base.diagonal(), "{gone} by {way}");
            }
            count += usize::from(!mesh.displacements.is_empty());
        }
        // The lamp began to shine at the first frame.
        assert_eq!(shown.past().is_empty(), number == 1);
        let poses = shown.past().iter().map(|(_, pose)| pose.scene().meshes.iter());
        for (own, before) in poses.flat_map(|meshes| shown.scene().meshes.iter().zip(meshes)) {
            let gone = own.positions[0] - before.positions[0];
            let least = own.displacements.first().map_or(0.0, |way| (number as f32 - 2.0) * way.length());
            assert!(gone.length() >= least - 1e-4, "poses are of the time in which the lamp shone");
        }
    }
    assert!(count > 4 && count < 4 * scene.scene().meshes.len(), "{count} move");
}

/// Nothing moves, and the lamp is off from the second frame on: what is seen fades as the preset's only state
/// does.
#[test]
fn what_was_kept_fades_from_frame_to_frame_by_the_closed_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = films(folder.path(), "");
    let frames = frames(&recipe);
    let image = |number: usize| {
        let (camera, _, scene) = &frames[number];
        let shot = Shot::new(scene, camera, [24, 32], f32::INFINITY);
        render(Effect::Phosphor, &shot, Sampling::one(1, 1)).mean
    };
    assert!(image(0).data().iter().all(|value| *value == 0.0), "nothing has shone yet");
    let decay = Glow::of(frames[1].2.scene()).surfaces[0].paint.states[0].decay;
    for number in [1, 2] {
        let (before, after) = (image(number), image(number + 1));
        let brightest = before.data().iter().copied().fold(0.0, f32::max);
        assert!(brightest > 1e-5);
        for (before, after) in before.data().iter().zip(after.data()) {
            assert!((after - before * (-0.5 * decay).exp()).abs() < 1e-5 * brightest, "{before} {after}");
        }
    }
}

#[test]
fn pairs_say_their_time_and_hold_motion_and_light_of_lamps_that_shine() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = films(folder.path(), ", motion = [1.0, 3.0]");
    let out = folder.path().join("data");
    generate(&recipe, &out).expect("generated");
    let dataset = Dataset::open(&out).expect("a dataset");
    for index in 0..4 {
        let (record, pair) = (dataset.record(index), dataset.pair(index).expect("a pair"));
        let time = 0.5 * (index + 1) as f32;
        assert_eq!(record.variation.and_then(|variation| variation.moment).expect("a moment").time, time);
        let image = deepshade_render::exr_file::read(&out.join(&record.file)).expect("a file");
        assert_eq!(image.metadata()["time_seconds"], time.to_string());
        assert_eq!(image.metadata()["frame_seconds"], "0.5");
        let values = |attribute| pair.gbuffer.select(&[attribute]).expect("there").data().to_vec();
        let lit = values(Attribute::DiffuseLight).iter().any(|value| *value > 0.0);
        // It is switched on at the moment of the first frame, and off at that of the second.
        assert_eq!(lit, index == 0, "{time} s");
        let motion = pair.gbuffer.select(&[Attribute::Motion]).expect("there");
        assert!(motion.plane(1).iter().any(|pixels| *pixels > 0.5), "pixels from frame to frame");
        assert_eq!(pair.target.data().iter().any(|value| *value > 0.0), index > 0, "{time} s");
    }
    assert_eq!(crate::verify(&out).expect("verified").faults, []);
}

/// What is animated goes on as its file says, with textures that stay on it, and its lamp is not the drawn
/// one.
#[test]
fn what_is_animated_in_a_file_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = sliding(folder.path());
    let recipe = films(folder.path(), ", textures = { procedural = 2 }, motion = [1.0, 2.0]");
    let props = Props::load(&recipe).expect("textures");
    let staged = StagedScene::load(&file, &recipe, &props).expect("a scene");
    let first = Camera::look_at(Vec3::new(2.0, 1.5, 8.0), Vec3::new(2.0, 0.5, 0.0));
    let (_, drawn) = staged.draw(first, 5);
    let shown = |time: f32| {
        let moment = Some(TimelineMoment { time, first });
        let variation = drawn.map(|drawn| Variation { moment, ..drawn });
        staged.shown(&first, variation.as_ref()).expect("shown")
    };
    let uvs = format!("{:?}", shown(0.5).scene().meshes[0].uvs);
    for time in [0.5, 1.0, 1.5, 2.0, 9.0] {
        let shown = shown(time);
        let triangle = &shown.scene().meshes[0];
        let left = triangle.positions.iter().map(|position| position.x).fold(f32::INFINITY, f32::min);
        assert!((left - (2.0 * time.min(2.0) - 2.0)).abs() < 1e-5, "{time} s: {left}");
        assert_eq!(format!("{:?}", triangle.uvs), uvs);
        if time < 1.75 {
            assert!((triangle.displacements[0] - Vec3::X).length() < 1e-5, "a metre in half a second");
        }
        let lamp = drawn.and_then(|drawn| drawn.lamp).expect("a lamp").light();
        assert_eq!(shown.scene().lights, [lamp]);
        assert!(shown.past().iter().all(|(_, pose)| pose.scene().lights == [lamp]));
        let now = shown.scene().meshes[1].positions[0];
        let floor = |scene: &TracedScene| scene.scene().meshes[1].positions[0];
        let poses: Vec<f32> = shown.past().iter().map(|(_, pose)| floor(pose).distance(now)).collect();
        assert_eq!(poses.is_empty(), time == 0.5);
    }
}
