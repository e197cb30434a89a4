//! The window through the program, under a screen that is none (Xvfb). What is clicked in it is tested in
//! `src/view/tests`.

#![cfg(all(feature = "view", target_os = "linux"))]

use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// Runs `deepshade view` in a folder under a screen of its own.
fn view(folder: &Path, options: &str) -> Output {
    Command::new("xvfb-run")
        .args(["-a", "-s", "-screen 0 1600x1000x24", PROGRAM, "view", "--scene", "still-life:1"])
        .args(["--quality", "low", "--height", "48", "--width", "64", "--spp", "8"])
        .args(["--screenshot", "window.png", "--json", "view.json"])
        .args(options.split_whitespace())
        .env("XDG_RUNTIME_DIR", folder)
        .current_dir(folder)
        .output()
        .expect("xvfb-run, which `cargo xtask test` installs")
}

#[test]
fn a_screenshot_shows_the_window_when_all_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = view(folder.path(), "--methods gtao,hbao");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    let picture = image::open(folder.path().join("window.png")).expect("a screenshot").to_rgb8();
    let colours: HashSet<[u8; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(picture.width() >= 1000 && colours.len() > 100, "{} colours", colours.len());
    let bytes = std::fs::read(folder.path().join("view.json")).expect("written");
    let figures = serde_json::from_slice::<Value>(&bytes).expect("JSON")["figures"].clone();
    assert!(figures["pictures"].as_f64() >= Some(1.0) && figures["refusals"] == 0.0, "{figures}");
    assert!(figures["seconds_to_first_picture"].as_f64() > Some(0.0), "{figures}");
}

#[test]
fn what_cannot_be_is_said_and_ends_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    for (options, named) in [
        ("--methods shadows", "shadows"),
        ("--model nowhere --methods learned", "nowhere"),
        ("--effect path --radius 1", "--radius"),
        ("--exr none.exr", "none.exr"),
    ] {
        let output = view(folder.path(), options);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && !said.contains("panicked"), "{options}: {said}");
        assert!(said.contains(named), "{options}: no `{named}` in {said}");
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
