//! `deepshade compare --config`: several scenes, effects and methods from a file, again from the file that it
//! writes, and again into the folder that has them.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// Two scenes, two effects with two methods each.
const FILE: &str = "scenes = [\"room:1\", \"stairs:7\"]\n\
    effects = [\"fog-direct\", \"ao\"]\n\
    methods = [\"ray-march\", \"epipolar\", \"hbao\", \"gtao\"]\n\
    qualities = [\"low\"]\n\
    samples = 8\n\
    resolution = { height = 24, width = 32 }\n";

/// A folder with the file in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("both.toml"), FILE).expect("written");
    folder
}

fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.arg("compare").args(line.split(' ')).current_dir(folder);
    command
}

fn compare(folder: &Path, line: &str) -> Output {
    command(folder, line).output().expect("starts")
}

/// Runs it, which must succeed, and gives what it said on stderr.
fn said(folder: &Path, line: &str) -> String {
    let output = compare(folder, line);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {said}");
    said
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("read")).expect("JSON")
}

/// All images below a report's folder, by their way from there.
fn images(report: &Path) -> BTreeMap<PathBuf, PathBuf> {
    let mut found = BTreeMap::new();
    for folder in std::fs::read_dir(report).expect("listed").flatten().filter(|entry| entry.path().is_dir()) {
        for file in std::fs::read_dir(folder.path()).expect("listed").flatten() {
            let path = file.path();
            if path.extension().is_some_and(|ending| ending == "png" || ending == "exr") {
                found.insert(path.strip_prefix(report).expect("below").to_owned(), path);
            }
        }
    }
    found
}

fn bytes(report: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    images(report).into_iter().map(|(name, path)| (name, std::fs::read(path).expect("read"))).collect()
}

fn times(report: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let time = |path: PathBuf| path.metadata().and_then(|metadata| metadata.modified()).expect("a time");
    images(report).into_iter().map(|(name, path)| (name, time(path))).collect()
}

/// Figures but for times, which are never the same.
fn errors(figures: &Value) -> BTreeMap<String, Value> {
    let all = figures["figures"].as_object().expect("figures").clone();
    all.into_iter().filter(|(name, _)| !name.starts_with("ms_")).collect()
}

#[test]
fn several_scenes_effects_and_methods_come_from_a_file_and_again_from_the_one_that_is_written() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    said(folder.path(), "--config both.toml --out first --json first.json");
    let first = json(&path("first.json"));
    assert_eq!(first["figures"]["frames"], 4.0);
    for name in [
        "ssim_ao_gtao",
        "relmse_ao_hbao",
        "flip_fog_direct_epipolar",
        "ms_fog_direct_ray_march",
        "ssim_ao_white",
    ] {
        assert!(first["figures"][name].is_number(), "{name}: {first}");
    }
    let frames = first["details"]["frames"].as_array().expect("frames");
    let effects: Vec<&str> = frames.iter().filter_map(|frame| frame["effect"].as_str()).collect();
    assert_eq!(effects, ["fog-direct", "fog-direct", "ao", "ao"], "those of an effect stand together");
    // Four images of a frame's truth and of each of its two methods' are three pictures and their values.
    assert_eq!(images(&path("first")).len(), 4 * 3 * 4);
    assert!(path("first/frame-room-1-view-0-ao/gtao-low.exr").is_file(), "{:?}", images(&path("first")));
    let page = std::fs::read_to_string(path("first/index.html")).expect("a page");
    for text in [
        "frame-stairs-7-view-0-fog-direct/epipolar-low.exr",
        "SSIM against milliseconds on",
        "Scene by scene",
    ] {
        assert!(page.contains(text), "{text}");
    }

    // Every shown digit of the Markdown file is that of the JSON file.
    let text = std::fs::read_to_string(path("first/compare.md")).expect("a table");
    let (_, ao) = text.split_once("## Ambient occlusion").expect("its effect");
    let gtao = ao.lines().find(|line| line.starts_with("| gtao")).expect("its line");
    let ssim = first["figures"]["ssim_ao_gtao"].as_f64().expect("a number");
    assert_eq!(gtao.split('|').nth(2).map(str::trim), Some(format!("{ssim:.3}").as_str()), "{text}");

    said(folder.path(), "--config first/compare.toml --out deep/second --json second.json");
    assert!(bytes(&path("first")) == bytes(&path("deep/second")), "the same images");
    assert_eq!(errors(&first), errors(&json(&path("second.json"))));
    let description = |name: &str| std::fs::read_to_string(path(name)).expect("a description");
    assert_eq!(description("first/compare.toml"), description("deep/second/compare.toml"));
}

#[test]
fn networks_and_runs_are_told_apart() {
    let folder = folder();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao");
    for name in ["a/net", "b/net"] {
        std::fs::create_dir_all(folder.path().join(name)).expect("made");
        let entries = std::fs::read_dir(&shipped).expect("a model").flatten();
        for file in entries.filter(|entry| entry.path().is_file()) {
            std::fs::copy(file.path(), folder.path().join(name).join(file.file_name())).expect("copied");
        }
    }
    let text = "scenes = [\"room:1\"]\nmethods = [\"learned\"]\nsamples = 8\nviews = 2\n\
                [[runs]]\nmodel = \"a/net\"\nresolution = { height = 32, width = 32 }\n\
                [[runs]]\nmodel = \"b/net\"\nresolution = { height = 32, width = 64 }\n";
    std::fs::write(folder.path().join("networks.toml"), text).expect("written");
    said(folder.path(), "--config networks.toml --out report --json report.json --height 48");
    let report = json(&folder.path().join("report.json"));
    let figure = |name: &str| report["figures"][name].is_number();
    assert!(figure("ssim_learned_net") && figure("ssim_learned_net_2"), "{report}");
    assert!(!figure("ssim_learned"), "one name would be the mean of two networks: {report}");
    for (name, width) in [("frame-room-1-view-0-ao", 32), ("frame-room-1-run-2-view-1-ao", 64)] {
        let path = folder.path().join("report").join(name).join("truth.image.png");
        assert_eq!(image::image_dimensions(&path).expect("a picture"), (width, 48), "{}", path.display());
    }
}

#[test]
fn a_network_that_nobody_named_is_found_again_from_elsewhere() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao");
    std::fs::create_dir_all(path("models/ao")).expect("made");
    let entries = std::fs::read_dir(&shipped).expect("a model").flatten();
    for file in entries.filter(|entry| entry.path().is_file()) {
        std::fs::copy(file.path(), path("models/ao").join(file.file_name())).expect("copied");
    }
    let line = "--scene room:1 --effect aa,ao --methods fxaa,learned --samples 8 --height 24 --width 32";
    said(folder.path(), &format!("{line} --out report"));
    let text = std::fs::read_to_string(path("report/compare.toml")).expect("a description");
    assert!(text.contains("model = \"../models/ao\"") && text.contains("time = 0.0"), "{text}");
    // Where no network of its own lies.
    let elsewhere = path("elsewhere");
    std::fs::create_dir(&elsewhere).expect("made");
    said(&elsewhere, "--config ../report/compare.toml --out again");
    assert!(elsewhere.join("again/frame-room-1-view-0-ao/learned.exr").is_file());
    let own = elsewhere.join("again/frame-room-1-view-0-aa/learned.exr");
    assert!(own.is_file(), "a network that the program brings");
    // A comparison of one effect of several names what it has for that one.
    let more = said(&elsewhere, "--config ../report/compare.toml --effect ao --out again");
    assert!(more.contains("1 of 1 frames are there"), "{more}");
}

#[test]
fn a_method_takes_part_with_numbers_set_by_hand_beside_itself() {
    let folder = folder();
    let write = |parameters: &str| {
        let text = format!(
            "scenes = [\"room:1\"]\nsamples = 8\nresolution = {{ height = 24, width = 32 }}\n\
            methods = [\"hbao\", {{ name = \"hbao\", parameters = {{ {parameters} }} }}]\n"
        );
        std::fs::write(folder.path().join("set.toml"), text).expect("written");
    };
    write("strength = 0.2");
    said(folder.path(), "--config set.toml --out report --json report.json");
    let figures = json(&folder.path().join("report.json"))["figures"].clone();
    let ssim = |name: &str| figures[name].as_f64().unwrap_or(f64::NAN);
    assert!(ssim("ssim_hbao") > ssim("ssim_hbao_strength_0_2") + 0.01, "a fifth of the shadow is too little");
    said(folder.path(), "--config report/compare.toml --out again --json again.json");
    assert_eq!(
        json(&folder.path().join("again.json"))["figures"]["ssim_hbao_strength_0_2"],
        figures["ssim_hbao_strength_0_2"]
    );

    for (parameters, named) in [
        ("strenght = 1", "no parameter `strenght` (did you mean `strength`?); there are: bias"),
        ("steps = 2.5", "`steps`: 2.5 is not a whole number"),
        ("strength = 1e9", "`strength`: 1000000000 is not within"),
    ] {
        write(parameters);
        let output = compare(folder.path(), "--config set.toml --out refused");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(named), "{said}");
    }
}

#[test]
fn what_is_there_is_not_made_again() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    said(folder.path(), "--config both.toml --out report --json report.json");
    let (first, made) = (json(&path("report.json")), times(&path("report")));
    let again = said(folder.path(), "--config report/compare.toml --out report --json report.json");
    assert!(again.contains("4 of 4 frames are there"), "{again}");
    assert_eq!(times(&path("report")), made);
    assert_eq!(
        json(&path("report.json"))["figures"],
        first["figures"],
        "times, too, are those of the images"
    );

    // Of a frame that lacks an image that one is made, and so is a quality more; no truth is rendered again.
    let lost = Path::new("frame-room-1-view-0-ao/gtao-low.flip.png");
    std::fs::remove_file(path("report").join(lost)).expect("removed");
    let more = said(
        folder.path(),
        "--config both.toml --effect ao --quality low,high --out report --json report.json",
    );
    assert!(!more.contains("frames are there"), "{more}");
    let now = times(&path("report"));
    assert!(
        now.keys().all(|name| !name.display().to_string().contains("fog")),
        "other effects are gone: {now:?}"
    );
    let gtao = |name: &Path| {
        name.starts_with("frame-room-1-view-0-ao") && name.display().to_string().contains("gtao-low")
    };
    for (name, time) in &now {
        match made.get(name) {
            Some(before) => assert_eq!(time == before, !gtao(name), "{name:?}"),
            None => assert!(!name.display().to_string().contains("low"), "{name:?}"),
        }
    }
    let json = json(&path("report.json"));
    assert_eq!(json["figures"]["ssim_gtao_low"], first["figures"]["ssim_ao_gtao"], "to the last digit");
    assert!(json["figures"]["ssim_hbao"].is_number(), "{json}");

    // Another number of samples is another truth.
    said(folder.path(), "--config both.toml --effect ao --samples 16 --out report");
    assert!(times(&path("report")).iter().all(|(name, time)| made.get(name) != Some(time)));
}

/// Starts a comparison and ends it by force once a frame's record is there.
fn killed(folder: &Path) {
    let mut child: Child =
        command(folder, "--config both.toml --out report").stderr(Stdio::null()).spawn().expect("starts");
    let start = Instant::now();
    let begun = || images(&folder.join("report")).len() > 5;
    while start.elapsed() < Duration::from_secs(60) && !(folder.join("report").is_dir() && begun()) {
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = child.kill();
    child.wait().expect("ends");
}

#[test]
fn a_comparison_that_was_killed_goes_on_and_no_page_shows_half_of_it() {
    let folder = folder();
    let report = folder.path().join("report");
    killed(folder.path());
    let made = times(&report);
    assert!(!report.join("index.html").exists() && report.join("compare.toml").is_file());
    assert!(made.len() < 48, "it was ended in the middle");
    said(folder.path(), "--config report/compare.toml --out report");
    let whole = times(&report);
    let kept = made.iter().filter(|(name, time)| whole.get(*name) == Some(time)).count();
    assert!(kept >= 4, "the first truth at least: {kept}");
    said(folder.path(), "--config both.toml --out calm");
    assert!(bytes(&report) == bytes(&folder.path().join("calm")), "as if nothing had happened");
}

#[test]
fn what_is_wrong_with_a_file_is_said_before_any_work() {
    let folder = folder();
    let refused = |text: &str, line: &str, named: &[&str]| {
        std::fs::write(folder.path().join("wrong.toml"), text).expect("written");
        let output = compare(folder.path(), &format!("--config wrong.toml --out report{line}"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{text}");
        assert!(named.iter().all(|name| said.contains(name)), "{text}: {said}");
        assert!(!folder.path().join("report").exists(), "{text}");
    };
    refused("scenes = [\"room:1\"]\ncolour = 1", "", &["wrong.toml", "line 2", "`colour`"]);
    refused("scenes = [\"room:1\"]\nmethods = [\"ssao\"]", "", &["no method `ssao`", "hbao"]);
    refused("scenes = [\"room:1\", \"gone.gltf\"]\nmethods = [\"truth\"]", "", &["gone.gltf"]);
    refused("effects = [\"ao\"]", "", &["`scenes`"]);
    refused("scenes = [\"room:1\"]", " --config twice.toml", &["--config"]);
    let output = compare(folder.path(), "--config gone.toml --out report");
    assert!(String::from_utf8_lossy(&output.stderr).contains("gone.toml"));
    std::fs::create_dir(folder.path().join("mine")).expect("made");
    std::fs::rename(folder.path().join("both.toml"), folder.path().join("mine/compare.toml")).expect("moved");
    let output = compare(folder.path(), "--config mine/compare.toml --out mine");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("holds `compare.toml` and no report"), "{said}");
}
