//! The window through the program, under a screen that is none (Xvfb) and hands that are a script.

#![cfg(all(feature = "view", target_os = "linux"))]

#[cfg(feature = "train")]
#[path = "view/training.rs"]
mod training;

use deepshade_render::exr_file;
use deepshade_shaders::Planes;
use serde_json::Value;
use std::collections::HashSet;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// A screen of its own for each test.
struct Screen {
    server: Child,
    number: String,
    /// Who puts windows away.
    manager: Option<Child>,
}

impl Screen {
    fn new() -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb, which `cargo xtask test` installs");
        let mut number = String::new();
        let out = server.stdout.take().expect("its standard output");
        BufReader::new(out).read_line(&mut number).expect("the number of its screen");
        Self { server, number: number.trim().to_owned(), manager: None }
    }

    /// One with a window manager.
    fn managed(folder: &Path) -> Self {
        let mut screen = Self::new();
        let mut manager = Command::new("openbox");
        manager.env("DISPLAY", format!(":{}", screen.number)).env("HOME", folder).current_dir(folder);
        manager.stdout(Stdio::null()).stderr(Stdio::null());
        screen.manager = Some(manager.spawn().expect("openbox, which `cargo xtask test` installs"));
        screen
    }

    /// Runs `deepshade view` with a script in a folder.
    fn view(&self, folder: &Path, options: &str, script: &str) -> Output {
        self.command(folder, options, script).output().expect("starts")
    }

    fn command(&self, folder: &Path, options: &str, script: &str) -> Command {
        std::fs::write(folder.join("script.txt"), script).expect("written");
        let mut command = Command::new(PROGRAM);
        command
            .args(["view", "--quality", "low"])
            .args(["--height", "48", "--width", "64"].iter().filter(|_| !options.contains("--height")))
            .args(["--scene", "still-life:1"].iter().filter(|_| !options.contains("--scene")))
            .args(["--script", "script.txt", "--json", "view.json"])
            .args(options.split_whitespace())
            .env("DISPLAY", format!(":{}", self.number))
            .env("XDG_RUNTIME_DIR", folder)
            .current_dir(folder);
        command
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        for process in self.manager.iter_mut().chain([&mut self.server]) {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

fn figures(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("view.json")).expect("written");
    serde_json::from_slice::<Value>(&bytes).expect("JSON")["figures"].clone()
}

/// The middle of a screenshot, right of the choices.
fn canvas(path: &Path) -> Vec<[u8; 3]> {
    let picture = image::open(path).expect("a screenshot").to_rgb8();
    let (width, height) = picture.dimensions();
    let canvas = picture.enumerate_pixels().filter(|(x, y, _)| *x > width / 3 && *y > height / 4);
    canvas.map(|(.., pixel)| pixel.0).collect()
}

/// Its colours.
fn colours(path: &Path) -> HashSet<[u8; 3]> {
    canvas(path).into_iter().collect()
}

/// The share of it that is no grey.
fn coloured(path: &Path) -> f64 {
    let canvas = canvas(path);
    let range =
        |pixel: &[u8; 3]| pixel.iter().max().zip(pixel.iter().min()).map_or(0, |(high, low)| high - low);
    canvas.iter().filter(|pixel| range(pixel) > 24).count() as f64 / canvas.len() as f64
}

/// The mean of an image's values, and how far those of another one are from them on average: as they lie, and shifted by a pixel.
fn apart(image: &Planes, other: &Planes) -> [f64; 3] {
    let (image, other) = (image.data(), other.data());
    let mean =
        |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>() / image.len() as f64;
    let apart = |by: usize| mean(&mut image[by..].iter().zip(other).map(|(a, b)| (a - b).abs()));
    [mean(&mut image.iter().copied()), apart(0), apart(1)]
}

#[test]
fn a_window_shows_methods_beside_truth_and_survives_what_is_done_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("broken.glb"), b"glTF, but not for long").expect("written");
    // Nothing shines here: effects that need a lamp add one, others do not.
    let room = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 2 -2\nv 2 2 -2\nv 2 2 2\nv -2 2 2\n\
        f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
    std::fs::write(folder.path().join("dark.obj"), room).expect("written");
    let script = "orbit -5 0\nwait truth 8\nscreenshot wipe.png\nsee difference\narrange tiles\nwait 0.1\nscreenshot tiles.png\n\
        see flip\nwait 0.1\nscreenshot flip.png\nsee image\n\
        orbit 20 -10\nfly 0 0.1 0\nwait truth 8\ntruth off\neffect gi\nmethods ssgi\nmeasure 2\n\
        effect path\nwait picture\neffect aa\nwait picture\ninspect normal\nwait picture\nscreenshot normal.png\nsave kept\n\
        size 37 23\nresize 333 217\nwait picture\nresize 1 1\nwait 0.2\nresize 900 700\nwait picture\n\
        minimise on\norbit 10 0\nwait picture\nminimise off\nwait picture\nscreenshot back.png\nopen broken.glb\nwait refusal\nwait picture\n\
        effect ao\ntruth on\ntemporal on\nwait truth 8\ntemporal off\ntruth off\nopen missing\nwait refusal\n\
        open playground:1\nwait picture\nopen dark.obj\nwait picture\neffect gi\nwait picture\neffect ao\nwait picture\n\
        effect gi\nwait picture\nquit\n";
    let output = Screen::managed(folder.path()).view(folder.path(), "--methods gtao,hbao", script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    for name in ["wipe.png", "tiles.png", "flip.png", "normal.png", "back.png"] {
        let found = colours(&folder.path().join(name)).len();
        assert!(found > 40, "{name}: {found} colours");
    }
    // Ambient occlusion is grey, maps of what differs are not.
    let [plain, difference, flip] =
        ["wipe.png", "tiles.png", "flip.png"].map(|name| coloured(&folder.path().join(name)));
    assert!(plain < 0.01 && difference > 0.05 && flip > 0.05, "{plain} {difference} {flip}");
    assert_ne!(canvas(&folder.path().join("tiles.png")), canvas(&folder.path().join("flip.png")));
    for name in ["kept/fxaa.exr", "kept/fxaa.png", "kept/normal.exr"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    // What was saved runs without a window, and makes the same image.
    let again = Command::new(PROGRAM)
        .args(["compare", "--config", "kept/compare.toml", "--spp", "8", "--out", "again"])
        .current_dir(folder.path())
        .output()
        .expect("starts");
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    let read = |path: &Path, layer: &str| {
        exr_file::read(path).expect("an EXR file").image(layer, 3).expect("its layer")
    };
    let frames = std::fs::read_dir(folder.path().join("again")).expect("a report");
    let mut files = frames.filter_map(|entry| Some(entry.ok()?.path().join("fxaa-low.exr")));
    let made = files.find(|file| file.is_file()).expect("the method's image");
    let [mean, same, shifted] =
        apart(&read(&folder.path().join("kept/fxaa.exr"), "fxaa"), &read(&made, "aa"));
    assert!(same < 0.02 * mean && shifted > 0.08 * mean, "{mean} {same} {shifted}");
    let figures = figures(folder.path());
    assert_eq!(figures["minimised"], 1.0, "the window manager puts it away");
    assert!(figures["fps_gi_ssgi"].as_f64().expect("measured") > 0.0);
    assert!(figures["refusals"].as_f64().expect("counted") >= 2.0);
    assert!(figures["seconds_to_first_picture"].as_f64().expect("measured") > 0.0);
}

#[test]
fn a_file_that_was_written_anew_is_read_anew_and_has_truth_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let floor = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3\nf 1 3 2\n";
    let wall = "v -2 2 -2\nv 2 2 -2\nf 1 2 6 5\n";
    std::fs::write(path("corner.obj"), format!("{floor}{wall}")).expect("written");
    let script = "wait truth 8\nsave one\nwait 3\nopen corner.obj\nwait truth 8\nsave two\n\
        open still-life:1\nwait picture\nopen corner.obj\nwait truth 8\nsave three\nquit\n";
    let options = "--scene corner.obj --eye 0,1.5,3 --look-at 0,0.3,-1 --radius 1 --methods hbao";
    let screen = Screen::new();
    let window =
        screen.command(folder.path(), options, script).stderr(Stdio::piped()).spawn().expect("starts");
    wait_for(&path("one/compare.toml"));
    std::fs::write(path("corner.obj"), floor).expect("written");
    let output = window.wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    let image = |name: &str| image::open(path(name)).expect("a picture").to_luma8();
    for method in ["truth", "hbao"] {
        let [one, two, three] = ["one", "two", "three"].map(|name| image(&format!("{name}/{method}.png")));
        let off = |a: &image::GrayImage, b: &image::GrayImage| {
            let pairs = a.pixels().zip(b.pixels());
            pairs.map(|(a, b)| f64::from(a.0[0].abs_diff(b.0[0]))).sum::<f64>() / a.pixels().len() as f64
        };
        // Where the wall was, and the shade before it.
        assert!(
            off(&one, &two) > 1.0 + 4.0 * off(&two, &three),
            "{method}: {} {}",
            off(&one, &two),
            off(&two, &three)
        );
    }
}

/// Waits for a file that the window writes.
fn wait_for(file: &Path) {
    let began = Instant::now();
    while !file.exists() {
        assert!(began.elapsed() < Duration::from_secs(120), "{} does not come", file.display());
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A file in which a tile goes over another one within half a second.
fn write_moving_tile(folder: &Path) {
    let corners: [[f32; 3]; 6] =
        [[-1., 0., -1.], [1., 0., -1.], [1., 0., 1.], [-1., 0., -1.], [1., 0., 1.], [-1., 0., 1.]];
    let raised = corners.map(|[x, y, z]| [0.3 * x, y + 0.5, 0.3 * z]);
    let floats = corners.iter().chain(&raised).flatten().copied();
    let moves = [0.0f32, 0.5, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let bytes: Vec<u8> = floats.chain(moves).flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.join("tile.bin"), bytes).expect("written");
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],"scene":0,
        "nodes":[{"mesh":0},{"mesh":1}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},{"primitives":[{"attributes":{"POSITION":1}}]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
            "samplers":[{"input":2,"output":3}]}],
        "accessors":[
            {"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]},
            {"bufferView":1,"componentType":5126,"count":6,"type":"VEC3","min":[-0.3,0.5,-0.3],"max":[0.3,0.5,0.3]},
            {"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[0.5]},
            {"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":72},
            {"buffer":0,"byteOffset":144,"byteLength":8},{"buffer":0,"byteOffset":152,"byteLength":24}],
        "buffers":[{"byteLength":176,"uri":"tile.bin"}]}"#;
    std::fs::write(folder.join("tile.gltf"), text).expect("written");
}

#[test]
fn an_animation_is_recorded_at_its_own_times_with_and_without_a_program_for_videos() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    write_moving_tile(folder.path());
    let script = "truth off\nwait picture\narrange tiles\nrecord film 10\nscreenshot film.png\nquit\n";
    let options = "--scene tile.gltf --eye 1,2,2 --look-at 0,0,0 --methods gtao,hbao --radius 1";
    let screen = Screen::new();
    let film = |path: Option<&Path>| {
        let mut command = screen.command(folder.path(), options, script);
        if let Some(path) = path {
            command.env("PATH", path);
        }
        let output = command.output().expect("starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !said.contains("panicked"), "{said}");
    };
    film(Some(Path::new("/nowhere")));
    assert!(!path("film/film.mp4").exists());
    let frames: Vec<_> = (0..5)
        .map(|frame| image::open(path(&format!("film/{frame:05}.png"))).expect("a frame").to_rgb8())
        .collect();
    assert!(!path("film/00005.png").exists(), "half a second at 10 frames a second");
    // How far to the right it is dark, on the whole: the shade goes with the tile.
    let shade = |frame: &image::RgbImage| {
        assert_eq!(frame.dimensions(), (128, 48), "two methods in a row");
        let dark = |x: u32| (0..48).map(|y| f64::from(255 - frame.get_pixel(x, y)[0])).sum::<f64>();
        (0..64).map(|x| f64::from(x) * dark(x)).sum::<f64>() / (0..64).map(dark).sum::<f64>()
    };
    let shades: Vec<f64> = frames.iter().map(shade).collect();
    assert!(shades.windows(2).all(|pair| pair[1] > pair[0] + 0.2), "{shades:?}");
    assert!(colours(&path("film.png")).len() > 40);
    if Command::new("ffmpeg").arg("-version").output().is_ok() {
        film(None);
        let video = std::fs::read(path("film/film.mp4")).expect("a video");
        assert_eq!(&video[4..8], b"ftyp");
    }
}

#[test]
fn time_that_has_no_end_is_recorded_as_long_as_hands_choose() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "truth off\nwait picture\nlength 0.2\nrecord film 10\nquit\n";
    let options = "--effect phosphor --methods rate-equation";
    let output = Screen::new().view(folder.path(), options, script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    let frames = [0, 1, 2].map(|frame| folder.path().join(format!("film/{frame:05}.png")).is_file());
    assert_eq!(frames, [true, true, false], "0.2 seconds at 10 frames a second");
}

#[test]
fn a_method_is_held_against_another_one_and_seen_pixel_by_pixel() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let script = "truth off\nsee difference\nwait picture\nscreenshot unjudged.png\nagainst hbao\nwait verdict\nwait 0.1\n\
        screenshot judged.png\nsee image\nwait 0.1\nscreenshot far.png\nzoom 16 0.5 0.5\nexpose\nwait picture\nwait 0.1\n\
        screenshot near.png\nsave kept\nagainst surfel\n";
    let output = Screen::new().view(folder.path(), "--methods gtao,hbao", script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("method `surfel` is not shown") && !said.contains("panicked"), "{said}");
    let [unjudged, judged, far] = ["unjudged.png", "judged.png", "far.png"].map(|name| coloured(&path(name)));
    // A legend has colours, too.
    assert!(unjudged < 0.01 && judged > 0.015 && far < 0.01, "{unjudged} {judged} {far}");
    let [far, near] = ["far.png", "near.png"].map(|name| canvas(&path(name)));
    assert_ne!(far, near);
    // A pixel is as wide as 16 times 13 points: neighbours in a row are alike.
    let alike = |canvas: &[[u8; 3]]| canvas.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert!(alike(&near) > alike(&far));
    let layers = exr_file::read(&path("kept/gbuffer.exr")).expect("an EXR file").layers();
    assert!(["normal", "depth"].iter().all(|name| layers.iter().any(|layer| layer == name)), "{layers:?}");
}

#[test]
fn layers_of_a_file_are_seen_beside_methods_and_a_save_that_fails_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("broken.exr"), b"no EXR file at all").expect("written");
    std::fs::write(path("taken"), b"a file where a folder should be").expect("written");
    let script = "truth off\nwait picture\nrecord film 10\nwait refusal\nsave kept\narrange tiles\nopen broken.exr\nwait refusal\nopen kept/hbao.exr\nlayer hbao\n\
        wait picture\nwait 0.1\nscreenshot layer.png\nsave taken\nwait refusal\nsize 37 23\nwait picture\nquit\n";
    let screen = Screen::new();
    let output = screen.view(folder.path(), "--methods hbao", script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    assert!(figures(folder.path())["refusals"].as_f64().expect("counted") >= 3.0);
    assert!(colours(&path("layer.png")).len() > 40);
    for (script, named) in [
        ("open kept/hbao.exr\nlayer shadow\n", "no layer `shadow`; there are hbao"),
        ("layer hbao\n", "no EXR file is open"),
    ] {
        let output = screen.view(folder.path(), "--methods hbao", script);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(named), "{script}: {said}");
    }
}

#[test]
fn closing_does_not_wait_for_a_slow_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let options = "--scene room:7 --methods aov --height 288 --width 448";
    let began = Instant::now();
    let output = Screen::new().view(folder.path(), options, "wait 3\nquit\n");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    assert_eq!(figures(folder.path())["pictures"], 0.0, "it was still at it");
    assert!(began.elapsed() < Duration::from_secs(40), "{:?}", began.elapsed());
}

#[test]
fn a_number_of_a_method_is_set_and_saved_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "truth off\nwait picture\nsave usual\nset hbao strength 0.2\nwait picture\nsave set\n\
        set hbao strength 1.3\nwait picture\nsave back\nset hbao strength 99\n";
    let output = Screen::new().view(folder.path(), "--methods hbao", script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("line 10 of the script: parameter `strength`: 99 is not within 0 to 4"), "{said}");
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("written");
    assert!(text("set/compare.toml").contains("strength = 0.2"), "{}", text("set/compare.toml"));
    assert!(!text("back/compare.toml").contains("strength"), "{}", text("back/compare.toml"));
    // Noise is another in every picture.
    let brightness = |name: &str| {
        let picture = image::open(folder.path().join(name)).expect("a picture").to_luma8();
        picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / picture.pixels().len() as f64
    };
    let [usual, set, back] = ["usual/hbao.png", "set/hbao.png", "back/hbao.png"].map(brightness);
    assert!(set - usual > 10.0 * (usual - back).abs(), "{usual} {set} {back}");
}

#[test]
fn what_cannot_be_is_said_and_ends_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let screen = Screen::new();
    for (options, script, named) in [
        ("", "dance\n", "line 1, `dance`"),
        ("", "wait picture\nmethods hbao, shadows\n", "line 2 of the script"),
        ("--methods shadows", "quit\n", "shadows"),
        ("--model nowhere --methods learned", "wait picture\n", "line 1 of the script: no picture"),
        ("--effect path --radius 1", "quit\n", "--radius"),
        ("", "truth off\nwait picture\nsave /proc/x\nquit\n", "line 3 of the script: "),
        ("", "truth off\nwait picture\nopen nosuch.glb\nquit\n", "nosuch.glb"),
        (
            "",
            "truth off\nwait picture\nopen nosuch.glb\nwait refusal\nopen nosuch.glb\nwait 60\n",
            "of the script: ",
        ),
    ] {
        let output = screen.view(folder.path(), options, script);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && !said.contains("panicked"), "{options} {script}: {said}");
        assert!(said.contains(named), "{options} {script}: no `{named}` in {said}");
    }
    let output = Command::new(PROGRAM)
        .args(["view", "--scene", "still-life:1"])
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("no window") && !said.contains("panicked"), "{said}");
    assert!(said.contains("`xvfb-run -a deepshade view`") && !said.contains(".rs:"), "{said}");
}
