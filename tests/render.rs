//! `deepshade render`: a picture, its values with their variance, and figures.

use deepshade_render::exr_file;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn render(folder: &Path, args: &[&str]) -> Output {
    let common = ["render", "--scene", "still-life:1", "--height", "24", "--width", "32", "--json", "f.json"];
    let program = env!("CARGO_BIN_EXE_deepshade");
    Command::new(program).args(common).args(args).current_dir(folder).output().expect("starts")
}

fn figures(folder: &Path) -> Value {
    let json = std::fs::read(folder.join("f.json")).expect("figures");
    serde_json::from_slice::<Value>(&json).expect("JSON")["figures"].clone()
}

#[test]
fn a_picture_comes_with_its_values_their_variance_and_figures() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = render(folder.path(), &["--effect", "gi", "--spp", "30", "--out", "a.png"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let figures = figures(folder.path());
    let figure = |name: &str| figures[name].as_f64().unwrap_or(f64::NAN);
    assert_eq!(figure("samples"), 32.0, "rounded up to a multiple of the scramblings");
    assert!(figure("seconds") > 0.0 && figure("mean") > 0.0 && figure("noise_relmse") > 0.0, "{figures}");
    let image = exr_file::read(&folder.path().join("a.exr")).expect("read");
    let (mean, variance) = (image.image("gi", 3).expect("gi"), image.image("variance", 3).expect("variance"));
    assert_eq!((mean.height(), mean.width()), (24, 32));
    assert!((mean.mean() - figure("mean")).abs() < 1e-6);
    assert!(variance.data().iter().any(|value| *value > 0.0));
    assert_eq!(image.metadata()["scene"], "still-life:1");
    let picture = std::fs::read(folder.path().join("a.png")).expect("a picture");
    assert!(picture.starts_with(b"\x89PNG"));
}

#[test]
fn an_error_that_is_asked_for_is_reached_and_needs_no_more_samples() {
    let folder = tempfile::tempdir().expect("a folder");
    let rendered = |error: &str| {
        let output = render(folder.path(), &["--effect", "ao", "--error", error, "--out", "a.exr"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let figures = figures(folder.path());
        let figure = |name: &str| figures[name].as_f64().unwrap_or(f64::NAN);
        assert!(figure("noise_relmse").sqrt() <= error.parse().unwrap_or(f64::NAN), "{figures}");
        figure("samples")
    };
    assert!(rendered("0.1") < rendered("0.02"));
}

#[test]
fn what_cannot_be_done_is_named_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    for (args, named) in [
        (["--out", "a.jpg", "--spp", "8"], "a.jpg"),
        (["--out", "a.exr", "--camera", "left"], "no camera `left`"),
        (["--out", "a.exr", "--environment", "none.hdr"], "none.hdr"),
        (["--out", "a.exr", "--error", "0"], "not above 0"),
        (["--effect", "gi", "--part", "direct"], "no part `direct`"),
        (["--effect", "path", "--focus", "1"], "--focus"),
        (["--effect", "path", "--medium", "none.vol"], "none.vol"),
    ] {
        let output = render(folder.path(), &args);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            !output.status.success() && message.contains(named) && !message.contains("panicked"),
            "{message}"
        );
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 0);
}
