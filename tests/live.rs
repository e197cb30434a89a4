//! Live methods through the program: sequences, the frame's benchmark, and an effect's methods on a test set.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// A folder in which the program runs.
struct Case(tempfile::TempDir);

impl Case {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, line: &str) -> Output {
        Command::new(PROGRAM)
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .output()
            .expect("starts")
    }

    /// Runs the program, which must succeed, and gives its figures.
    fn figures(&self, line: &str) -> Value {
        let output = self.run(&format!("{line} --json figures.json"));
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        let bytes = std::fs::read(self.path("figures.json")).expect("written");
        let json: Value = serde_json::from_slice(&bytes).expect("JSON");
        json["figures"].clone()
    }

    /// Runs the program, which must refuse and say `named`.
    fn assert_refused(&self, line: &str, named: &str) {
        let output = self.run(line);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && !message.contains("panicked"), "{line}: {message}");
        assert!(message.contains(named), "{line}: no `{named}` in {message}");
    }
}

/// What of a frame is measured, among others.
const PASSES: [&str; 10] = [
    "surface",
    "light",
    "gtao",
    "ssdo",
    "ssgi",
    "prefiltered",
    "separable",
    "ring_gather",
    "reconstruction",
    "fxaa",
];

/// Folder of the network that is shipped.
fn model() -> String {
    format!("{}/models/ao", env!("CARGO_MANIFEST_DIR"))
}

fn number(figures: &Value, name: &str) -> f64 {
    assert!(figures[name].is_number(), "no `{name}` in {figures}");
    figures[name].as_f64().expect("a number")
}

#[test]
fn a_sequence_is_a_picture_a_frame_and_reprojection_calms_it() {
    let case = Case::new();
    let line = "render --animate --scene playground:3 --orbit 4 --frames 4 --height 48 --width 64 --effect ao \
        --method hbao --quality low --out";
    let plain = case.figures(&format!("{line} plain"));
    let calm = case.figures(&format!("{line} calm --temporal"));
    for folder in ["plain", "calm"] {
        let frames: Vec<_> = std::fs::read_dir(case.path(folder)).expect("a folder").collect();
        assert_eq!(frames.len(), 4, "{folder}");
    }
    let frame = |folder: &str, name: &str| std::fs::read(case.path(folder).join(name)).expect("a picture");
    assert_ne!(frame("plain", "00000.png"), frame("plain", "00003.png"), "the camera moves");
    assert!(number(&calm, "ms_hbao_temporal") > 0.0);
    let (restless, calm) = (number(&plain, "flicker"), number(&calm, "flicker"));
    assert!(calm > 0.0 && calm < 0.7 * restless, "{calm} with, {restless} without");
    let of_network = format!(
        "{} learned --temporal --model {}",
        line.replace("--method hbao --quality low", "--method learned"),
        model()
    );
    let of_network = case.figures(&of_network);
    assert!(number(&of_network, "ms_learned") > 0.0 && number(&of_network, "ms_learned_temporal") > 0.0);
    for pass in ["pose", "shadows", "surface", "attributes", "light", "movement", "hbao"] {
        assert!(number(&plain, &format!("ms_{pass}")) >= 0.0);
    }
    assert!(plain["ms_hbao_temporal"].is_null());
    case.figures("render --animate --scene room:1 --frames 1 --height 16 --width 16 --out plain");
    assert!(case.path("plain").join("00000.png").is_file());
    assert!(!case.path("plain").join("00003.png").exists(), "frames of the sequence before");
}

#[test]
fn every_effect_has_a_method_that_runs_live() {
    let case = Case::new();
    let figures = case.figures("bench frame --scene room:1 --sizes 48x32 --frames 2 --quality low");
    for pass in PASSES.into_iter().chain(["rate-equation", "lpv", "volume-shell"]) {
        let ms = number(&figures, &format!("ms_{}", pass.replace('-', "_")));
        assert!(ms > 0.0, "{pass}");
    }
    assert!(figures["fps_720p"].is_null(), "no such size was measured");
}

#[test]
fn memory_stays_what_it_is_from_frame_to_frame() {
    let methods = "ao:gtao,do:ssdo,gi:ssgi,ibl:prefiltered,sss:separable,dof:ring-gather,\
        motion-blur:reconstruction,aa:fxaa";
    let line = "bench frame --scene room:1 --sizes 96x64 --frames 30 --quality low --methods";
    let figures = Case::new().figures(&format!("{line} {methods}"));
    if cfg!(target_os = "linux") {
        // A g-buffer of this size takes 1 MB; one leaked in every frame would show.
        assert!(number(&figures, "memory_growth_mb") < 12.0, "{figures}");
    }
}

#[test]
fn a_network_is_measured_beside_other_methods() {
    let case = Case::new();
    let line =
        "bench frame --scene room:1 --sizes 96x64 --frames 3 --quality low --methods ao:learned,aa:fxaa";
    let figures = case.figures(&format!("{line} --model {}", model()));
    assert!(number(&figures, "ms_learned") > 0.0 && number(&figures, "ms_fxaa") > 0.0);
    // The program's own, where no folder has another one; of some effects it has none.
    assert!(number(&case.figures(line), "ms_learned") > 0.0);
    let other = line.replace("ao:learned", "ibl:learned");
    case.assert_refused(&other, "no network in models/ibl: --model names one");
    case.assert_refused("bench frame --scene room:1 --methods ao:learned,ao:learned", "several networks");
    let without = "bench frame --scene room:1 --methods aa:fxaa --model models/ao";
    case.assert_refused(without, "--model means nothing");
}

#[test]
fn all_methods_of_an_effect_are_scored_against_truth() {
    let case = Case::new();
    let recipe = "effect = \"sss\"\nsplit = \"test\"\nseed = 5\nresolution = { height = 64, width = 64 }\nsamples = 8\n\
        radius = { diagonal = 0.1 }\nviews_per_scene = 1\ntiles = { samples = 16, one_in = 2, whole_frames = 2 }\n\
        vary = { light = true, mean_free_path = [0.01, 0.02] }\n\
        families = [{ name = \"cave\", scenes = 1 }, { name = \"drapery\", scenes = 1 }]\n";
    std::fs::write(case.path("recipe.toml"), recipe).expect("written");
    case.figures("dataset testset recipe.toml --out testset");
    let line = "eval --effect sss --methods all --testset testset --quality low,high --curve curve.svg";
    let figures = case.figures(line);
    for method in ["separable", "separable_low", "gather", "gather_low", "light"] {
        for metric in ["ssim", "flip", "relmse", "bias"] {
            number(&figures, &format!("{metric}_{method}"));
        }
    }
    assert!(number(&figures, "ms_gather") > 0.0);
    assert!(number(&figures, "ssim_gather") > number(&figures, "ssim_light"), "{figures}");
    assert!(number(&figures, "relmse_gather") < number(&figures, "relmse_gather_low"), "{figures}");
    let curve = std::fs::read_to_string(case.path("curve.svg")).expect("a curve");
    assert!(curve.contains("separable") && curve.contains("gather") && curve.contains("1 - SSIM"));
    let json: Value =
        serde_json::from_slice(&std::fs::read(case.path("figures.json")).expect("read")).expect("JSON");
    let devices = &json["details"]["devices"];
    assert!(
        devices["gather_low"].is_string() && devices["gather_low"] == json["details"]["adapter"],
        "{devices}"
    );
    case.assert_refused(
        "eval --effect sss --methods truth --testset testset",
        "is what others are scored against",
    );
    case.assert_refused("eval --effect sss --testset testset --curve curve.png", "of the kind .svg");
    case.assert_refused("eval --effect aa --methods all", "no test set in models/aa/testset");
    case.assert_refused("eval --effect gi --testset testset", "is for sss, not for gi");
    case.assert_refused("eval --effect sss --methods hbao --testset testset", "has no method `hbao`");
}

#[test]
fn pairs_can_aim_at_a_method_s_images() {
    let case = Case::new();
    let recipe = |target: &str| {
        format!(
            "effect = \"gi\"\nsplit = \"train\"\nseed = 5\ntarget = \"{target}\"\n\
             resolution = {{ height = 32, width = 32 }}\nsamples = 1\nradius = {{ diagonal = 0.2 }}\n\
             views_per_scene = 2\nvalidation_share = 0.5\nvary = {{ light = true }}\n\
             families = [{{ name = \"room\", scenes = 1 }}]\n"
        )
    };
    std::fs::write(case.path("ssgi.toml"), recipe("ssgi")).expect("written");
    std::fs::write(case.path("none.toml"), recipe("magic")).expect("written");
    let figures = case.figures("dataset generate ssgi.toml --out data");
    assert_eq!(number(&figures, "pairs"), 2.0);
    assert!(case.run("dataset verify data").status.success());
    case.assert_refused("dataset generate none.toml --out other", "no method `magic`");
    assert!(!case.path("other").exists());
}

#[test]
fn what_cannot_be_animated_is_refused_by_name() {
    let case = Case::new();
    let line = "render --animate --scene room:1 --frames 1 --height 16 --width 16";
    for (more, named) in [
        ("--effect ao --method magic", "no method `magic`"),
        ("--effect path --method hbao", "no method `hbao`"),
        ("--put fox.gltf", "SCENE@X,Y,Z"),
        ("--put fox.gltf@0,0,0", "fox.gltf"),
        ("--out picture.png", "goes into a folder"),
        ("--effect ibl --method learned", "models/ibl"),
        ("--eye 1,2,3", "--look-at"),
        ("--orbit nan", "is not within -36000 to 36000"),
        ("--fps 1e-9", "is not within 0.01 to 1000"),
        ("--eye=-1e30,0,0 --look-at 0,0,0", "is not within -1000000 to 1000000"),
        ("--put room:2@0,0,0,0", "scale 0 is not within"),
        ("--spp 4", "--spp is for truth"),
        ("--effect ao --method learned --quality low", "--quality means nothing"),
        ("--effect ao --model models/ao", "--model means nothing"),
        ("--shutter -1", "--shutter -1"),
        ("--method light --temporal", "--temporal means nothing to direct light"),
        ("--effect ao --method hbao --shutter 1", "--shutter means nothing to the effect ao"),
    ] {
        case.assert_refused(&format!("{line} {more}"), named);
    }
    case.assert_refused("render --scene room:1 --orbit 3", "--orbit means nothing without --animate");
    case.assert_refused("render --scene room:1 --temporal", "--temporal means nothing without --animate");
    std::fs::create_dir(case.path("holds")).expect("a folder");
    std::fs::write(case.path("holds/letter.txt"), "mine").expect("written");
    case.assert_refused(&format!("{line} --out holds"), "letter.txt");
    case.assert_refused("bench frame --methods ao", "EFFECT:METHOD");
    case.assert_refused("bench frame --scene room:1 --methods ao:fxaa --frames 1", "no method `fxaa`");
}
