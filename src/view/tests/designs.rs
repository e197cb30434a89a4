//! Key frames of glow, from a file to the images and back.

use super::{Opened, args};
use crate::phosphor::design::task::Task;
use crate::view::design::place::{Target, tests::lit_place};
use crate::view::subject::PreparedScene;
use crate::view::window::Window;
use deepshade_glow::spectrum::lights::Light;
use deepshade_phosphor::wish::CurvePoint;
use deepshade_render::scene::Glow;
use deepshade_shaders::{Effect, Planes};
use eframe::egui::accesskit::Role;
use std::sync::Arc;

/// What is wanted of a place of `still-life:1`, a second after its lamp went out and later.
const WANTED: &str = "scene = 'still-life:1'\nspectrum = 'mercury'\nframes = 200\nfps = 10\n\
    [[lamps]]\non = [[0.0, 1.0]]\n\
    [[place]]\nat = AT\nkeys = [{ time = 2, colour = [0.01, 0.02, 0.04] }, \
    { time = 6, colour = [0.005, 0.01, 0.02] }]\n";

#[test]
fn key_frames_are_solved_shown_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("wanted.toml");
    let first = args("--scene still-life:1 --effect phosphor --height 48 --width 64");
    let subject = PreparedScene::load(&first, &first.scene, Effect::Phosphor).expect("a scene");
    let at = lit_place(&Arc::new(subject), 20.0).place.at.to_array();
    std::fs::write(&file, WANTED.replace("AT", &format!("{at:?}"))).expect("written");
    let line = format!("--effect phosphor --methods rate-equation --time 1 --key-frames {}", file.display());
    let mut opened = Opened::new(&line);
    opened.click("truth, up to");
    opened.wait("the place", |window| window.design.place.is_some());
    opened.wait_until_complete();
    let design = &opened.window().design;
    assert_eq!(design.wish.as_ref().map(|wish| wish.keys().len()), Some(2));
    let (answer, _) = design.answer.as_ref().expect("an answer");
    let decay = answer.as_ref().expect("a material").design.material.states[0].decay;
    assert!((decay - 2f64.ln() / 4.0).abs() < 0.01, "half in four seconds: {decay}");
    let shown = |opened: &Opened| {
        let window = opened.window();
        let picture = window.results.picture.as_ref().expect("a picture");
        (picture.request.show.glow.clone(), picture.images[0].values.clone())
    };
    let (glow, image) = shown(&opened);
    let name = opened.window().design.place.as_ref().map(|place| place.material.clone());
    let paint =
        glow.as_ref().and_then(|glow| glow.surfaces.iter().find(|surface| surface.material == name).cloned());
    assert!(paint.is_some_and(|own| (f64::from(own.paint.states[0].decay) - decay).abs() < 1e-6));
    // A key that is dragged up makes it brighter.
    let window = opened.window_mut();
    let wish = window.design.wish.as_mut().expect("a wish");
    let reach = CurvePoint { seconds: 1.0, brightness: 1.0 };
    let from = wish.point(&wish.keys()[0]);
    wish.grab(from, reach);
    assert!(wish.drag(CurvePoint { brightness: 1.2 * from.brightness, ..from }));
    wish.release();
    window.solve();
    opened.wait_until_complete();
    let (dragged, brighter) = shown(&opened);
    let sum = |image: &Planes| image.data().iter().sum::<f32>();
    assert!(dragged != glow && sum(&brighter) > sum(&image), "{} {}", sum(&brighter), sum(&image));
    opened.click_role(Role::Button, "write");
    opened.wait("files", Window::is_idle);
    let task = Task::read(&opened.path("design-1/wanted.toml")).expect("a task");
    assert_eq!((task.places[0].keys.len(), task.places[0].keys[1].time), (2, 6.0));
    assert_eq!((task.spectrum, task.reflected), (Some(Light::Mercury), false), "as the file has it");
    let again = Glow::read(&opened.path("design-1/glow.toml"), 1.0).expect("what glows");
    assert_eq!(again.surfaces.len(), dragged.expect("designed").surfaces.len());
}

#[test]
fn a_click_on_an_image_chooses_a_place_while_the_panel_is_open() {
    let mut opened = Opened::new("--effect phosphor --methods rate-equation");
    opened.click("truth, up to");
    opened.wait_until_complete();
    let middle = eframe::egui::pos2(760.0, 800.0);
    let click = |opened: &mut Opened| {
        opened.harness.drag_at(middle);
        opened.harness.step();
        opened.harness.drop_at(middle);
        opened.harness.run_steps(2);
    };
    click(&mut opened);
    assert!(opened.window().design.target.is_none(), "the panel is closed");
    opened.click_role(Role::DisclosureTriangle, "key frames of glow");
    opened.harness.run_steps(30);
    click(&mut opened);
    opened.wait("the place", |window| window.design.place.is_some());
    let design = &opened.window().design;
    assert!(matches!(design.target, Some(Target::Spot(_))) && design.answer.is_none());
    assert!(design.wish.as_ref().is_some_and(|wish| wish.keys().is_empty()));
}
