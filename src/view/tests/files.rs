//! Files that the window opens and saves.

use super::Opened;
use crate::compare;
use crate::view::window::Window;
use clap::Parser as _;
use deepshade_render::exr_file;
use deepshade_shaders::Planes;
use std::path::Path;

/// The mean of an image's values, and how far those of another one are from them on average: as they lie, and
/// shifted by a pixel.
fn apart(image: &Planes, other: &Planes) -> [f64; 3] {
    let (image, other) = (image.data(), other.data());
    let mean =
        |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>() / image.len() as f64;
    let apart = |by: usize| mean(&mut image[by..].iter().zip(other).map(|(a, b)| (a - b).abs()));
    [mean(&mut image.iter().copied()), apart(0), apart(1)]
}

#[test]
fn what_is_saved_is_made_again_without_a_window() {
    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        args: compare::Args,
    }
    let mut opened = Opened::new("--effect aa --methods fxaa");
    opened.click("truth, up to");
    opened.choose("of the g-buffer", "normal");
    opened.wait_until_complete();
    opened.click("save");
    opened.wait("files", Window::is_idle);
    for name in ["fxaa.exr", "fxaa.png", "normal.exr", "gbuffer.exr"] {
        assert!(opened.path("view-1").join(name).is_file(), "{name}");
    }
    let [config, out] = ["view-1/compare.toml", "again"].map(|name| opened.path(name).display().to_string());
    let line = ["compare", "--config", &config, "--spp", "8", "--out", &out];
    compare::run(&Line::try_parse_from(line).expect("a command line").args).expect("a comparison");
    let read = |path: &Path, layer: &str| {
        exr_file::read(path).expect("an EXR file").image(layer, 3).expect("its layer")
    };
    let frames = std::fs::read_dir(opened.path("again")).expect("a report");
    let mut files = frames.filter_map(|entry| Some(entry.ok()?.path().join("fxaa-low.exr")));
    let made = files.find(|file| file.is_file()).expect("the method's image");
    let [mean, same, shifted] = apart(&read(&opened.path("view-1/fxaa.exr"), "fxaa"), &read(&made, "aa"));
    assert!(same < 0.02 * mean && shifted > 0.08 * mean, "{mean} {same} {shifted}");
}

#[test]
fn what_is_dropped_is_opened_and_what_cannot_be_is_said() {
    let mut opened = Opened::new("--methods hbao");
    opened.click("truth, up to");
    opened.wait_until_complete();
    opened.click("save");
    opened.wait("files", Window::is_idle);
    std::fs::write(opened.path("broken.exr"), b"no EXR file at all").expect("written");
    std::fs::write(opened.path("broken.glb"), b"glTF, but not for long").expect("written");
    for name in ["broken.exr", "broken.glb", "missing"] {
        let path = opened.path(name);
        opened.window_mut().open(&path);
        opened.wait_for_error(name);
    }
    opened.wait_until_complete();
    // Nothing shines here: effects that need a lamp add one.
    let room = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 2 -2\nv 2 2 -2\nv 2 2 2\nv -2 2 2\n\
        f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
    std::fs::write(opened.path("dark.obj"), room).expect("written");
    let path = opened.path("dark.obj");
    opened.window_mut().open(&path);
    opened.wait_until_complete();
    opened.choose("effect", "gi");
    opened.wait_until_complete();
    assert!(opened.window().results.subject.as_ref().is_some_and(|subject| !subject.added.is_empty()));
    // Layers are seen beside methods, whatever is shown.
    let path = opened.path("view-1/hbao.exr");
    opened.window_mut().open(&path);
    opened.wait("layers", |window| !window.layers.images.is_empty());
    assert!(opened.window().shown().iter().any(|shown| shown.name.contains("hbao.exr: hbao")));
    opened.click("close");
    assert!(opened.window().layers.opened.is_none() && opened.window().is_idle());
    // A folder cannot be made where a file is.
    std::fs::write(opened.path("taken"), b"a file").expect("written");
    opened.window_mut().files.folder = opened.path("taken");
    opened.click("save");
    opened.wait_for_error("taken");
}

#[test]
fn a_file_that_was_written_anew_is_read_anew_and_has_truth_of_its_own() {
    let floor = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3\nf 1 3 2\n";
    let wall = "v -2 2 -2\nv 2 2 -2\nf 1 2 6 5\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("corner.obj");
    std::fs::write(&path, format!("{floor}{wall}")).expect("written");
    let options = "--eye 0,1.5,3 --look-at 0,0.3,-1 --radius 1 --methods hbao";
    let mut opened = Opened::new(&format!("--scene {} {options}", path.display()));
    // The images of truth and of the method, of the file as it is now.
    let seen = |opened: &mut Opened| {
        opened.window_mut().open(&path);
        opened.wait_until_complete();
        let truth = opened.window().truth_of_picture().expect("truth").image.values.clone();
        [truth, opened.window().results.picture.as_ref().expect("a picture").images[0].values.clone()]
    };
    let (with_wall, again) = (seen(&mut opened), seen(&mut opened));
    std::fs::write(&path, floor).expect("written");
    let without = seen(&mut opened);
    for ((one, two), other) in with_wall.iter().zip(&again).zip(&without) {
        let (same, differs) = (apart(one, two)[1], apart(one, other)[1]);
        assert!(differs > 0.005 + 4.0 * same, "{same} {differs}");
    }
}
