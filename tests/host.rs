//! What `deepshade export --wgsl` writes of shipped networks, run by a host that knows nothing else: the
//! passes of the methods whose images networks read are among the files.
#![cfg(feature = "train")]

#[path = "../infer/tests/common/host.rs"]
mod host;

use deepshade_shaders::gpu::Gpu;
use host::{Contents, Host, number};
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

fn exported(model: &str, folder: &Path) -> Vec<(String, Vec<u8>)> {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.arg("export").arg("--model").arg(models.join(model)).arg("--wgsl").arg(folder);
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let read = |path: &Path| std::fs::read(path).expect("a file");
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    entries.map(|path| (name(&path), read(&path))).collect()
}

fn planes(files: &[(String, Vec<u8>)], name: &str) -> Vec<f32> {
    let (_, bytes) =
        files.iter().find(|(file, _)| *file == format!("check.{name}.bin")).expect("it is there");
    bytemuck::pod_collect_to_vec(bytes)
}

/// Share of values that are further apart than `HOST.md` has it.
fn stray(expected: &[f32], made: &[f32]) -> f64 {
    let apart = expected.iter().zip(made).filter(|(a, b)| (*a - *b).abs().total_cmp(&1e-3).is_gt());
    apart.count() as f64 / expected.len() as f64
}

#[test]
fn a_host_makes_the_image_of_the_frame_that_is_exported_with_a_network() {
    let gpu = Gpu::new().expect("an adapter; a software one will do");
    for model in ["ao-small", "gi", "gi-paper"] {
        let scratch = tempfile::tempdir().expect("a folder");
        let files = exported(model, scratch.path());
        let json = |name: &str| -> Value {
            let (_, bytes) = files.iter().find(|(file, _)| file == name).expect("it is there");
            serde_json::from_slice(bytes).expect("JSON")
        };
        let (network, check) = (json("network.json"), json("check.json"));
        let names = network["attributes"].as_array().expect("names").iter();
        let names: Vec<&str> = names.map(|name| name.as_str().expect("a name")).collect();
        let filled: Contents = names.iter().map(|name| ((*name).to_owned(), planes(&files, name))).collect();
        let size = ["height", "width"].map(|name| number(&check[name]) as usize);
        let numbers = ["radius", "focal_length", "exposure", "seed"];
        let frame: HashMap<&str, f64> =
            numbers.into_iter().map(|name| (name, check[name].as_f64().expect("a number"))).collect();
        let expected = planes(&files, "image");
        let made = Host::new(&gpu, &files, size, frame.clone()).run(&filled, "image");
        let share = stray(&expected, &made);
        assert!(share < 0.01, "{model}: {:.1} % of the values stray", 100.0 * share);
        let twice = HashMap::from_iter(frame.into_iter().map(|(name, number)| (name, 2.0 * number)));
        let wrong = Host::new(&gpu, &files, size, twice).run(&filled, "image");
        assert!(stray(&expected, &wrong) >= 0.01, "{model}: at another radius it is the same");
    }
}
