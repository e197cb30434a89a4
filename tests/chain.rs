//! The whole chain through the program, as small as it goes: data, training, export, running, comparing,
//! evaluating, measuring; and the figures that scripts ask for by name.
#![cfg(feature = "train")]

use deepshade_infer::Model;
use deepshade_train::export::onnx;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// A test recipe of two scenes.
const TEST_RECIPE: &str = r#"effect = "ao"
split = "test"
seed = 5
resolution = { height = 64, width = 64 }
samples = 8
radius = { diagonal = 0.1 }
views_per_scene = 1
tiles = { samples = 16, one_in = 2, whole_frames = 1 }
families = [{ name = "cave", scenes = 1 }, { name = "drapery", scenes = 1 }]
"#;

const TRAIN: &str = "train --dataset data --out run --network paper --steps 4 --batch 2 --crop 64 --validate-every 2 \
    --validation-pairs 2";

/// A folder in which the program runs.
struct Chain(tempfile::TempDir);

impl Chain {
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, program: &mut Command, line: &str) -> Output {
        program.args(line.split_whitespace()).current_dir(self.0.path()).output().expect("starts")
    }

    /// Runs the program, which must succeed and write all of these figures as finite numbers.
    fn figures(&self, line: &str, names: &[&str]) -> Value {
        let output = self.run(&mut Command::new(PROGRAM), &format!("{line} --json figures.json"));
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        let json: Value = serde_json::from_slice(&std::fs::read(self.path("figures.json")).expect("written"))
            .expect("JSON");
        let figures = json["figures"].clone();
        for name in names {
            assert!(figures[name].is_number(), "{line}: no `{name}` in {figures}");
        }
        figures
    }

    /// Runs the program where files beyond so many KiB fail, as on a full disk; it must name the file that
    /// did.
    #[cfg(target_os = "linux")]
    fn assert_full(&self, kib: u32, line: &str, named: &str) {
        let limit = format!("trap '' XFSZ; ulimit -f {kib}; exec \"$@\"");
        let output = self.run(Command::new("bash").args(["-c", &limit, "bash", PROGRAM]), line);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && !message.contains("panicked"), "{line}: {message}");
        assert!(message.contains(named) && message.contains("File too large"), "{line}: {message}");
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_network_that_the_program_brings_is_written_into_a_folder() {
    let chain = Chain(tempfile::tempdir().expect("a folder"));
    chain.figures("export --model ao-small --out own", &["weights"]);
    assert_eq!(names(&chain.path("own")), ["net.json", "weights.safetensors"]);
    let model = |folder: &Path| Model::load(folder).expect("a network");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao-small");
    assert!(model(&chain.path("own")) == model(&shipped), "another network");
    let output = chain.run(&mut Command::new(PROGRAM), "export --model ao --out own");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("own holds a network already"), "{message}");
    assert!(model(&chain.path("own")) == model(&shipped), "what was there");
}

#[test]
fn a_network_is_written_as_an_onnx_file_in_half_floats() {
    let chain = Chain(tempfile::tempdir().expect("a folder"));
    chain.figures("export --model ao-small --onnx-half half.onnx", &["weights"]);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao-small");
    let whole = onnx::encode(&Model::load(&shipped).expect("a network"));
    let half = std::fs::read(chain.path("half.onnx")).expect("a file");
    assert!(half == onnx::halved(&whole).expect("halves"), "another file");
    assert!(3 * half.len() < 2 * whole.len(), "{} of {} bytes", half.len(), whole.len());
}

#[test]
fn from_a_recipe_to_a_network_that_is_compared() {
    let chain = Chain(tempfile::tempdir().expect("a folder"));
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
    std::fs::copy(recipe, chain.path("train.toml")).expect("copied");
    std::fs::write(chain.path("test.toml"), TEST_RECIPE).expect("written");

    let made = chain.figures("dataset generate train.toml --out data", &["pairs", "rendered", "seconds"]);
    assert_eq!(made["pairs"], 16.0);
    assert_eq!(chain.figures("dataset verify data", &["pairs", "faults"])["faults"], 0.0);
    chain.figures("dataset show data --out sheet.png --pairs 2", &["pairs", "shown"]);

    #[cfg(target_os = "linux")]
    {
        chain.assert_full(64, TRAIN, "checkpoint");
        assert!(
            !names(&chain.path("run")).iter().any(|name| name.contains("checkpoint")),
            "half a checkpoint"
        );
    }
    let output = chain.run(&mut Command::new(PROGRAM), "train --dataset data --out refused --crop 128");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("--crop 128"), "{message}");
    assert!(!chain.path("refused").exists(), "a folder that remembers what was refused");
    let trained = chain.figures(TRAIN, &["best_loss", "images_per_second"]);
    assert_eq!(trained["steps"], 4.0);

    #[cfg(target_os = "linux")]
    {
        chain.assert_full(64, "export --run run --out model", "model.onnx");
        assert_eq!(names(&chain.path("model")), [""; 0], "a model that is not whole");
    }
    std::fs::rename(chain.path("data"), chain.path("moved")).expect("moved");
    let output = chain.run(&mut Command::new(PROGRAM), "export --run run --out model");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("--dataset"), "{message}");
    let exported = chain.figures("export --run run --out model --dataset moved", &["weights"]);
    assert_eq!(exported["weights"], 71_089.0);

    chain.figures("dataset testset test.toml --out testset", &["frames", "hours", "hours_expected"]);
    chain.figures(
        "compare --scene stairs:7 --model model --out report --height 64 --width 64 --samples 8",
        &[
            "ssim_learned",
            "psnr_learned",
            "flip_learned",
            "relmse_learned",
            "ms_learned",
            "ssim_hbao",
            "psnr_hbao",
            "flip_hbao",
            "relmse_hbao",
            "ms_hbao",
            "ssim_ceiling",
            "ms_truth",
        ],
    );
    assert!(chain.path("report/index.html").is_file());
    let evaluated = chain.figures(
        "eval --model model --testset testset --results results.json",
        &["ssim_learned", "ssim_hbao", "ssim_ceiling", "ssim_white", "psnr_learned", "flip_learned"],
    );
    assert_eq!(evaluated["frames"], 2.0);
    let text = std::fs::read(chain.path("results.json")).expect("results");
    let results: Value = serde_json::from_slice(&text).expect("JSON");
    let network = &results["networks"]["model"];
    assert_eq!(network["figures"]["ssim_model"], evaluated["ssim_learned"]);
    assert!(network["confidence_95"]["ssim_model"][1].is_number() && network["parts"]["scenes"].is_null());
    std::fs::rename(chain.path("figures.json"), chain.path("eval.json")).expect("moved");
    chain.figures("export --model model --metrics eval.json", &["weights"]);
    let card = std::fs::read_to_string(chain.path("model/card.md")).expect("a card");
    assert!(card.contains("| frames | 2 |") && card.contains("| device_learned |"), "{card}");
    let steadiness = chain.figures(
        "eval --model model --testset testset --sequence 3 --frames 1 --methods learned,hbao --quality low \
         --temporal",
        &["flicker_learned", "flicker_hbao_low", "ghosts_hbao_low", "ssim_hbao_low_mixed", "flicker_truth"],
    );
    let figure = |name: &str| steadiness[name].as_f64().expect("a number");
    assert!(figure("flicker_hbao_low_mixed") < figure("flicker_hbao_low"), "{steadiness}");
    let output = chain.run(&mut Command::new(PROGRAM), "export --model model --metrics results.json");
    assert!(!output.status.success(), "figures of nobody in particular");
    let tuned =
        chain.figures("tune --dataset moved --method hbao --frames 2", &["radius_scale", "strength", "bias"]);
    let ssim = |name: &str| tuned[name].as_f64().expect("a number");
    assert!(ssim("ssim_tuned") >= ssim("ssim_default"));

    let net = "bench net --networks ao --sizes 768x512 --seconds 0.1 --runs 3 --page net.html";
    let measured = chain.figures(
        net,
        &["ms_wgsl_ao", "ms_cpu_ao", "ms_onnxruntime_ao", "ratio_cpu_onnxruntime_ao", "bytes_ao_1080p"],
    );
    let figure = |name: &str| measured[name].as_f64().expect("a number");
    assert!(
        (figure("ms_cpu_ao") / figure("ms_onnxruntime_ao") / figure("ratio_cpu_onnxruntime_ao") - 1.0).abs()
            < 1e-9
    );
    assert!(figure("bytes_ao_1080p") <= 120e6, "{}", figure("bytes_ao_1080p"));
    assert!(chain.path("net.html").is_file());
    // Within an hour even the largest network that is considered fits.
    let largest =
        chain.figures("bench net --networks aa --sizes 64x64 --budget 3600000", &["predicted", "actual"]);
    assert_eq!([&largest["u0"], &largest["levels"]], [450.0, 1.0]);
    chain.figures("export --model model --wgsl kernels", &["weights"]);
    for file in ["00_input0.wgsl", "up0.weights.bin", "network.json", "HOST.md"] {
        assert!(chain.path("kernels").join(file).is_file(), "{file}");
    }
    chain.figures("bench train --crop 64 --batch 1 --steps 1", &["images_per_second", "seconds_step_ao"]);
    let output = chain.run(
        &mut Command::new(PROGRAM),
        "bench train --crop 64 --batch 1 --steps 1 --python gone --json kept.json",
    );
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(!output.status.success() && said.contains("images a second"), "our own figures are kept: {said}");
    assert!(chain.path("kept.json").is_file());
    chain.figures(
        "bench rays --size 64 --runs 1",
        &[
            "mrays_primary",
            "mrays_primary_bundles",
            "mrays_ao",
            "mrays_ao_bundles",
            "mrays_diffuse",
            "diagonal",
        ],
    );
}

#[test]
fn a_pair_takes_milliseconds_to_minutes_and_its_parts_are_all_of_it() {
    let chain = Chain(tempfile::tempdir().expect("a folder"));
    let recipes = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes");
    // The median of three: what another program takes from the tiles that are timed, one in 64, counts 64
    // times.
    let bench = format!("bench dataset --recipes {} --effects do --pairs 3 --one-in 64", recipes.display());
    let made = chain.figures(&bench, &["pairs_per_hour_core_do"]);
    let pairs = made["pairs_per_hour_core_do"].as_f64().expect("a number");
    // Whatever the machine: in seconds, or in milliseconds, it would be far outside.
    assert!((1.0..1e6).contains(&pairs), "{pairs} pairs an hour");
    let share = |part: &str| made[format!("share_{part}_do")].as_f64().expect("a number");
    let shares = ["scene", "rays", "shading", "exr"].map(share);
    assert!(shares.iter().all(|share| (0.0..1.0).contains(share)), "{shares:?}");
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{shares:?}");
    assert!(shares[1] > 0.01, "rays take time: {shares:?}");
}

#[test]
fn the_help_of_training_states_its_defaults() {
    let output = Command::new(PROGRAM).args(["train", "--help"]).output().expect("starts");
    let help = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    for stated in [
        "[default: 0.002 for adamw, 1 for adadelta]",
        "[default: 0.05 where kernels are predicted, else 0.0001]",
        "[default: 4]",
        "[default: 256, or the largest that fits into the pairs]",
        "[default: as many as fit into --minutes, else 20000]",
        "[default: 32]",
        "[default: 500]",
        "[default: 20]",
        "[default: 1]",
        "[default: 4096]",
        "decay 0.9",
        "epsilon 0.000001",
    ] {
        assert!(help.contains(stated), "no `{stated}` in {help}");
    }
}
