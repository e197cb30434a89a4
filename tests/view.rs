//! The window through the program, under a screen that is none (Xvfb) and hands that are a script.

#![cfg(all(feature = "view", target_os = "linux"))]

use serde_json::Value;
use std::collections::HashSet;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// A screen of its own for each test.
struct Screen {
    server: Child,
    number: String,
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
        Self { server, number: number.trim().to_owned() }
    }

    /// Runs `deepshade view` with a script in a folder.
    fn view(&self, folder: &Path, options: &str, script: &str) -> Output {
        std::fs::write(folder.join("script.txt"), script).expect("written");
        Command::new(PROGRAM)
            .args(["view", "--scene", "still-life:1", "--height", "48", "--width", "64", "--quality", "low"])
            .args(["--script", "script.txt", "--json", "view.json"])
            .args(options.split_whitespace())
            .env("DISPLAY", format!(":{}", self.number))
            .env("XDG_RUNTIME_DIR", folder)
            .current_dir(folder)
            .output()
            .expect("starts")
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn figures(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("view.json")).expect("written");
    serde_json::from_slice::<Value>(&bytes).expect("JSON")["figures"].clone()
}

/// Colours of the middle of a screenshot, right of the choices.
fn colours(path: &Path) -> HashSet<[u8; 3]> {
    let picture = image::open(path).expect("a screenshot").to_rgb8();
    let (width, height) = picture.dimensions();
    let canvas = picture.enumerate_pixels().filter(|(x, y, _)| *x > width / 3 && *y > height / 4);
    canvas.map(|(.., pixel)| pixel.0).collect()
}

#[test]
fn a_window_shows_methods_beside_truth_and_survives_what_is_done_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("broken.glb"), b"glTF, but not for long").expect("written");
    // Nothing shines here: effects that need a lamp add one, others do not.
    let floor = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3\nf 1 3 2\nv -2 2 -2\nv 2 2 -2\nf 1 2 6 5\n";
    std::fs::write(folder.path().join("dark.obj"), floor).expect("written");
    let script = "orbit 5 0\nwait truth 8\nscreenshot wipe.png\nsee difference\narrange tiles\nwait 0.1\nscreenshot tiles.png\n\
        orbit 20 -10\nfly 0 0.1 0\nwait truth 8\ntruth off\neffect gi\nmethods ssgi\nmeasure 2\n\
        effect path\nwait picture\neffect aa\nwait picture\ninspect normal\nwait picture\nscreenshot normal.png\nsave kept\n\
        size 37 23\nresize 333 217\nwait picture\nresize 1 1\nwait 0.2\nresize 900 700\nwait picture\n\
        minimise on\nwait 0.2\nminimise off\nopen broken.glb\nwait refusal\nwait picture\n\
        effect ao\ntruth on\ntemporal on\nwait truth 8\ntemporal off\ntruth off\nopen missing\nwait refusal\n\
        open playground:1\nwait picture\nopen dark.obj\nwait picture\neffect gi\nwait picture\neffect ao\nwait picture\n\
        effect gi\nwait picture\nquit\n";
    let output = Screen::new().view(folder.path(), "--methods gtao,hbao", script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    for name in ["wipe.png", "tiles.png", "normal.png"] {
        let found = colours(&folder.path().join(name)).len();
        assert!(found > 40, "{name}: {found} colours");
    }
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
    let figures = figures(folder.path());
    assert!(figures["fps_gi_ssgi"].as_f64().expect("measured") > 0.0);
    assert!(figures["refusals"].as_f64().expect("counted") >= 2.0);
    assert!(figures["seconds_to_first_picture"].as_f64().expect("measured") > 0.0);
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
}
