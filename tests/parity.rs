//! The forms of a network agree: burn, the plain reference, WGSL, the CPU engine, and the exported file in
//! onnxruntime.
//!
//! Sizes are small here; `deepshade parity --model models/ao` checks large ones too.
#![cfg(feature = "train")]

use deepshade_infer::{
    AnalyticEstimate, ChannelOrder, Colour, Correction, Filter, Head, Model, NetSpec, Parity, Reach, Weights,
    parity, reference,
};
use deepshade_shaders::Effect;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn parity_of(model: Option<&Path>, sizes: &str, json: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.args(["parity", "--sizes", sizes, "--json"]).arg(json);
    if let Some(model) = model {
        command.arg("--model").arg(model);
    }
    command.output().expect("the program starts")
}

fn figures(json: &Path) -> Value {
    let bytes = std::fs::read(json).expect("a JSON file");
    let json: Value = serde_json::from_slice(&bytes).expect("JSON");
    json["figures"].clone()
}

#[test]
fn random_weights_agree_at_even_and_odd_sizes() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("parity.json");
    let output = parity_of(None, "16x16,64x48,67x45,33x102", &json);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let figures = figures(&json);
    for form in ["reference", "wgsl", "wgsl_gpu", "cpu", "burn", "onnxruntime"] {
        let max_abs = figures[format!("max_abs_{form}")].as_f64().expect("a number");
        assert!(max_abs <= 1e-4 * 1.5, "{form}: {max_abs}");
        assert!(max_abs > 0.0, "{form} is compared with itself");
    }
    let half = figures["max_abs_onnxruntime_half"].as_f64().expect("a number");
    assert!(half > 1e-4, "{half}: 32-bit floats");
}

#[test]
fn networks_of_other_kinds_agree() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("parity.json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.args(["parity", "--sizes", "33x22", "--networks", "aa,ibl,multi,real", "--json"]).arg(&json);
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(figures(&json)["max_abs_onnxruntime"].as_f64().expect("a number") > 0.0);
}

#[test]
fn networks_with_other_heads_than_the_image_agree() {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let published = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, reach).expect("it has one");
    let of_pixels = NetSpec { colour: Colour::Mono, ..published.clone() };
    let of_pixels = of_pixels.with_head(Head::Filter(Filter { levels: 5, kernel: 1, black: false }));
    let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, reach).expect("it has one");
    let [of_light, of_black] =
        [published, multi].map(|spec| spec.predicting_kernels().expect("it reads light"));
    let gtao = || AnalyticEstimate::new("gtao", "low");
    let corrected = NetSpec::corrected(Effect::Ao, 8, vec![gtao()], reach).expect("gtao estimates it");
    let surfel = AnalyticEstimate::new("surfel", "low");
    let gained = NetSpec::corrected(Effect::Gi, 8, vec![surfel, gtao().of(Effect::Ao)], reach)
        .expect("surfels estimate it");
    let reconstruction = AnalyticEstimate::new("reconstruction", "low");
    let gated =
        NetSpec::corrected(Effect::MotionBlur, 8, vec![reconstruction], reach).expect("it estimates it");
    let bias_alone = match gained.head {
        Head::Correction(correction) => Head::Correction(Correction { levels: 0, ..correction }),
        other => other,
    };
    let without_taps = gained.clone().with_head(bias_alone);
    for spec in [of_light, of_black, of_pixels, corrected, gained, gated, without_taps] {
        let folder = tempfile::tempdir().expect("a folder");
        let model = Model { weights: Weights::random(&spec, 5), spec };
        write(&model, folder.path());
        let json = folder.path().join("parity.json");
        let output = parity_of(Some(folder.path()), "16x16,64x48,67x45", &json);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let software = model.spec.u_net().map(|_| "wgsl");
        let forms = ["reference", "wgsl_gpu", "cpu", "burn", "onnxruntime", "onnxruntime_half"];
        for form in forms.into_iter().chain(software) {
            assert!(figures(&json)[format!("max_abs_{form}")].as_f64().expect("a number") > 0.0, "{form}");
        }
    }
}

/// Writes a model folder: spec, weights, an image to check a runtime with, and the exported file.
fn write(model: &Model, folder: &Path) {
    let bytes = deepshade_train::export::onnx::encode(model);
    std::fs::write(folder.join("model.onnx"), bytes).expect("written");
    model.save(folder).expect("saved");
    let input = parity::noise(model.spec.input_channels(), 20, 30, 1);
    let output = reference::forward(&model.spec, &model.weights, &input);
    Parity { input, output }.save(folder).expect("saved");
}

#[test]
fn the_trained_network_agrees() {
    let model = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("models/ao");
    let folder = tempfile::tempdir().expect("a folder");
    let output = parity_of(Some(&model), "64x48,67x45", &folder.path().join("parity.json"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A model folder whose exported file was made from other weights than it holds: one of a layer's differs.
fn folder_with_a_fault(folder: &Path, layer: usize) -> Model {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
    let mut model = Model { weights: Weights::random(&spec, 5), spec };
    let bytes = deepshade_train::export::onnx::encode(&model);
    model.weights.0[layer].weight.iter_mut().for_each(|weight| *weight += 0.2);
    write(&model, folder);
    std::fs::write(folder.join("model.onnx"), bytes).expect("written");
    model
}

#[test]
fn a_file_of_other_weights_is_found_out_and_its_layer_named() {
    for layer in [0, 4, 10] {
        let folder = tempfile::tempdir().expect("a folder");
        let json = folder.path().join("parity.json");
        let model = folder_with_a_fault(folder.path(), layer);
        let output = parity_of(Some(folder.path()), "40x24", &json);
        let name = &model.spec.layers()[layer].name;
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "layer {name}");
        let wanted = format!("onnxruntime differs from the reference first in layer `{name}`");
        assert!(message.contains(&wanted), "layer {name}: {message}");
        assert!(!message.contains("wgsl differs") && !message.contains("burn differs"), "{message}");
        assert!(figures(&json)["max_abs_wgsl"].as_f64().expect("a number") > 1e-3, "layer {name}");
    }
}

#[test]
fn a_stored_image_of_other_weights_is_found_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder_with_a_fault(folder.path(), 2);
    let bytes = deepshade_train::export::onnx::encode(&model);
    std::fs::write(folder.path().join("model.onnx"), bytes).expect("written");
    let mut stored = Parity::load(folder.path(), &model.spec).expect("reads");
    stored.output.data_mut()[17] += 0.01;
    stored.save(folder.path()).expect("saved");
    let output = parity_of(Some(folder.path()), "24x24", &folder.path().join("parity.json"));
    assert!(!output.status.success());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("parity.safetensors does not hold what these weights make"), "{message}");
}
