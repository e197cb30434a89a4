//! What is said of a moment, so that it can be made again.

use super::*;
use crate::view::method_worker::Request;
use crate::view::state::State;
use crate::view::subject::PreparedScene;
use crate::view::tests::args;
use deepshade_shaders::Planes;
use glam::Vec2;

/// A moment of a window with a command line, after the camera went around by so many radians.
fn snapshot(line: &str, turn: f32) -> Snapshot {
    let usual = if line.contains("--scene") { "" } else { "--scene still-life:1" };
    let args = args(&format!("{usual} --height 16 --width 16 {line}"));
    let state = State::new(&args).expect("methods");
    let model = state.show.model.as_deref().map(|folder| state.location_of_network(folder));
    let show = state.show;
    let subject = Arc::new(PreparedScene::load(&args, &show.source, show.effect).expect("a scene"));
    let mut controller = subject.controller;
    if turn != 0.0 {
        controller.orbit(Vec2::new(turn, 0.0));
    }
    let camera = controller.camera;
    let values = Planes::filled(show.effect.channels(), 16, 16, 0.5);
    let image = DisplayImage::new("image", values, crate::render::picture::Exposure::Plain);
    let picture = MethodFrame {
        request: Request { show, camera: Some(camera), time: 0.25, lights: None, exposure: None, number: 0 },
        camera,
        lights: subject.lights(None),
        radius: 0.5,
        warning: None,
        exposure: None,
        images: vec![image],
        inspected: None,
        passes: Vec::new(),
        subject,
    };
    Snapshot { picture: Arc::new(picture), truth: None, samples: 64, model, args: Arc::new(args) }
}

/// The keys of the file that a moment is saved with, and its head.
fn saved(snapshot: &Snapshot) -> (toml::Table, String) {
    let folder = tempfile::tempdir().expect("a folder");
    save(snapshot, folder.path()).expect("saved");
    let text = std::fs::read_to_string(folder.path().join(COMPARISON)).expect("written");
    (text.parse().expect("TOML"), text)
}

#[test]
fn what_the_first_view_decided_is_said_to_others() {
    let number = |keys: &toml::Table, name: &str| keys[name].as_float().map(|value| value as f32);
    for turn in [0.0, 1.0] {
        let snapshot = snapshot("--effect dof", turn);
        let (keys, head) = saved(&snapshot);
        let lens = snapshot.picture.subject.controller.camera.lens.expect("one that was added");
        assert_eq!(number(&keys, "aperture"), Some(lens.radius));
        assert_eq!(number(&keys, "focus"), Some(lens.focus));
        assert_eq!(number(&keys, "time"), Some(0.25));
        assert!(!head.contains("A lamp was added"), "the scene has its own: {head}");
        assert!(keys.get("mean_free_path").is_none() && keys.get("radius").is_none());
    }
    let snapshot = snapshot("--effect sss --aperture 0.01", 1.0);
    let (keys, _) = saved(&snapshot);
    let metres = keys["mean_free_path"].as_array().expect("of three colours");
    let metres: Vec<f32> = metres.iter().filter_map(|value| value.as_float()).map(|it| it as f32).collect();
    let own = snapshot.picture.subject.animated.scene.materials[0].mean_free_path;
    assert_eq!(metres, own.to_array());
    assert!(keys.get("aperture").is_none(), "the effect does not listen to it");
}

#[test]
fn a_lamp_that_was_added_for_another_view_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let dark = folder.path().join("dark.obj");
    std::fs::write(&dark, "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3\nf 1 3 2\n").expect("written");
    let line = format!("--scene {} --effect dof --eye 0,2,3 --look-at 0,0,0", dark.display());
    for turn in [0.0, 1.0] {
        let head = saved(&snapshot(&line, turn)).1;
        assert_eq!(head.contains("one is drawn for this view here"), turn != 0.0, "{head}");
        assert_eq!(head.contains("W/sr"), turn != 0.0, "{head}");
        assert!(!head.contains("a lens of radius"), "keys say it: {head}");
    }
}

#[test]
fn a_network_is_named_by_its_address() {
    let mut snapshot = snapshot("--methods learned --model models/ao", 0.0);
    snapshot.model = Some("s3://models/ao".parse().expect("an address"));
    let (keys, head) = saved(&snapshot);
    assert_eq!(keys["model"].as_str(), Some("s3://models/ao"));
    assert!(!head.contains("training run"), "{head}");
}

#[cfg(feature = "train")]
#[test]
fn weights_that_go_on_are_named() {
    use crate::view::method_worker::Trained;
    use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};

    let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4));
    for (method, is_told) in [("learned", true), ("hbao", false)] {
        let mut snapshot = snapshot(&format!("--methods {method} --model runs/ao"), 0.0);
        let model = Model { weights: Weights::random(&spec, 1), spec: spec.clone() };
        let picture = Arc::get_mut(&mut snapshot.picture).expect("nobody else's");
        picture.request.show.trained = Some(Trained(Arc::new(model)));
        let head = saved(&snapshot).1;
        assert_eq!(head.contains("its weights may have gone on"), is_told, "{method}: {head}");
    }
}

#[test]
fn whatever_is_shown_can_be_said_again() {
    let names = |keys: &toml::Table| -> Vec<String> {
        let name = |value: &toml::Value| value.as_str().map(str::to_owned);
        keys["methods"].as_array().expect("a list").iter().filter_map(name).collect()
    };
    let (keys, _) = saved(&snapshot("--methods hbao --model models/ao --radius inf", 0.0));
    assert_eq!(names(&keys), ["hbao", "truth"]);
    assert!(keys.get("model").is_none(), "no network is shown");
    assert_eq!(keys["radius"]["metres"].as_float(), Some(0.5));
    let (keys, _) = saved(&snapshot("--methods truth", 0.0));
    assert_eq!(names(&keys), ["truth"], "not all methods that there are");
    let (keys, _) = saved(&snapshot("--methods learned", 0.0));
    assert!(keys["model"].as_str().is_some_and(|folder| folder.ends_with("models/ao")), "{keys}");
    let (keys, _) = saved(&snapshot("--effect motion-blur --methods truth", 0.0));
    assert!(keys.get("shutter").is_some(), "{keys}");
}

#[test]
fn what_was_set_of_a_method_that_is_put_away_is_not_said() {
    let mut snapshot = snapshot("--methods hbao", 0.0);
    let changes = &mut Arc::get_mut(&mut snapshot.picture).expect("nobody else's").request.show.changes;
    for method in ["hbao", "gtao"] {
        changes.entry(method).or_default().0.insert("blur.radius".to_owned(), 2.0.into());
    }
    let (keys, text) = saved(&snapshot);
    let methods = keys["methods"].as_array().expect("a list");
    assert!(methods.len() == 2 && !text.contains("gtao"), "{text}");
    assert!(methods[0]["name"].as_str() == Some("hbao") && methods[0]["parameters"].is_table(), "{text}");
}

#[test]
fn what_cannot_be_said_leaves_no_images() {
    let mut snapshot = snapshot("--methods hbao", 0.0);
    Arc::get_mut(&mut snapshot.picture).expect("nobody else's").request.show.size = [4, 4];
    let folder = tempfile::tempdir().expect("a folder");
    let error = format!("{:#}", save(&snapshot, folder.path()).expect_err("too small to be compared"));
    assert!(error.contains("resolution.height"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
}
