//! A model folder survives writing and reading, and every damaged one is an error that names what is wrong.

use super::*;
use crate::{ChannelOrder, Reach};
use std::fs;
use tempfile::TempDir;

const REACH: Reach = Reach { radius: 0.3, diagonal_share: 0.05, height: 512 };

fn saved() -> (TempDir, Model) {
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| (net.levels, net.u0) = (3, 4));
    let model = Model { weights: Weights::random(&spec, 5), spec };
    let folder = tempfile::tempdir().expect("a folder");
    model.save(folder.path()).expect("saves");
    (folder, model)
}

/// What loading says after `damage` was done to the folder.
fn message_after(damage: impl FnOnce(&Path, &Model)) -> String {
    let (folder, model) = saved();
    damage(folder.path(), &model);
    Model::load(folder.path()).expect_err("the folder is damaged").to_string()
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn a_saved_model_loads_bit_for_bit_and_leaves_nothing_else_behind() {
    let (folder, model) = saved();
    assert_eq!(Model::load(folder.path()).expect("loads"), model);
    let mut names: Vec<_> = fs::read_dir(folder.path())
        .expect("lists")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    names.sort();
    assert_eq!(names, [SPEC, WEIGHTS]);
}

#[test]
fn a_missing_file_is_named() {
    assert_says(&message_after(|f, _| fs::remove_file(f.join(SPEC)).expect("removes")), &["net.json"]);
    let message = message_after(|f, _| fs::remove_file(f.join(WEIGHTS)).expect("removes"));
    assert_says(&message, &["cannot read", "weights.safetensors"]);
}

#[test]
fn every_truncation_of_the_weights_is_an_error() {
    let (folder, _) = saved();
    let path = folder.path().join(WEIGHTS);
    let whole = fs::read(&path).expect("reads");
    for length in (0..whole.len()).step_by(97).chain([whole.len() - 1]) {
        fs::write(&path, &whole[..length]).expect("writes");
        let message = Model::load(folder.path()).expect_err("truncated").to_string();
        assert_says(&message, &["weights.safetensors is not a whole safetensors file"]);
    }
}

#[test]
fn an_absurd_header_allocates_nothing() {
    let message = message_after(|folder, _| {
        let mut bytes = u64::MAX.to_le_bytes().to_vec();
        bytes.extend([b' '; 64]);
        fs::write(folder.join(WEIGHTS), bytes).expect("writes");
    });
    assert_says(&message, &["weights.safetensors"]);
}

#[test]
fn a_file_far_too_large_is_not_read() {
    let message = message_after(|folder, _| {
        let file = fs::File::create(folder.join(WEIGHTS)).expect("creates");
        file.set_len(1 << 40).expect("grows");
    });
    assert_says(&message, &["weights.safetensors has 1099511627776 bytes"]);
}

#[test]
fn the_weights_of_another_network_name_tensor_and_shapes() {
    let message = message_after(|folder, model| {
        let spec = model.spec.clone().reshaped(|net| net.kernel = 5);
        let other = Model { weights: Weights::random(&spec, 1), spec };
        let spec = fs::read(folder.join(SPEC)).expect("reads");
        other.save(folder).expect("saves");
        fs::write(folder.join(SPEC), spec).expect("writes");
    });
    assert_says(&message, &["weights.safetensors"]);
    let message = message_after(|folder, model| {
        let spec = model.spec.clone().reshaped(|net| net.kernel = 1);
        let other = Model { weights: Weights::random(&spec, 1), spec };
        let spec = fs::read(folder.join(SPEC)).expect("reads");
        other.save(folder).expect("saves");
        fs::write(folder.join(SPEC), spec).expect("writes");
    });
    assert_says(&message, &["`down0.weight` has shape [4, 6, 1, 1], expected [4, 6, 3, 3]"]);
}

#[test]
fn missing_unknown_foreign_and_poisoned_tensors_are_named() {
    let rewritten = |tensors: &[(String, Vec<usize>, &[f32])]| {
        message_after(|folder, _| file::write_tensors(&folder.join(WEIGHTS), tensors).expect("writes"))
    };
    let message = rewritten(&[("down0.bias".to_owned(), vec![4], &[0.0; 4])]);
    assert_says(&message, &["no tensor `down0.weight`", "it holds down0.bias"]);
    let message = rewritten(&[("down9.bias".to_owned(), vec![1], &[0.0])]);
    assert_says(&message, &["tensor `down9.bias`, which the network"]);
    let message = message_after(|folder, model| {
        let mut model = model.clone();
        model.weights.0[0].weight[17] = f32::NAN;
        model.save(folder).expect("saves");
    });
    assert_says(&message, &["`down0.weight`", "not finite, at index 17"]);
    let message = message_after(|folder, _| {
        let whole = TensorBytes::half("down0.weight");
        fs::write(folder.join(WEIGHTS), whole.0).expect("writes");
    });
    assert_says(&message, &["`down0.weight` holds F16, expected F32"]);
}

/// A safetensors file with one half-float tensor.
struct TensorBytes(Vec<u8>);

impl TensorBytes {
    fn half(name: &str) -> Self {
        let view =
            safetensors::tensor::TensorView::new(safetensors::Dtype::F16, vec![2], &[0; 4]).expect("a view");
        Self(safetensors::serialize([(name, view)], None).expect("serialises"))
    }
}

#[test]
fn a_wrong_spec_is_named() {
    let edited = |from: &str, to: &str| {
        message_after(|folder, _| {
            let path = folder.join(SPEC);
            let json = fs::read_to_string(&path).expect("reads");
            assert!(json.contains(from), "{json}");
            fs::write(path, json.replace(from, to)).expect("writes");
        })
    };
    assert_says(&edited("\"leak\"", "\"colours\": 1, \"leak\""), &["net.json", "unknown field `colours`"]);
    assert_says(&edited("\"outputs\": 16", "\"outputs\": 17"), &["net.json", "layer `down2`"]);
    assert_says(&edited("\"kernel\": 3", "\"kernel\": 4000000000"), &["net.json", "`kernel` is 4000000000"]);
    assert_says(&edited("{", ""), &["net.json"]);
}

#[test]
fn a_model_that_was_replaced_by_half_does_not_load() {
    let (folder, model) = saved();
    let weights = folder.path().join(WEIGHTS);
    fs::remove_file(&weights).expect("removes");
    fs::create_dir(&weights).expect("in the way");
    assert!(model.save(folder.path()).is_err());
    fs::remove_dir(&weights).expect("removes");
    let error = Model::load(folder.path()).expect_err("no model").to_string();
    assert_says(&error, &["net.json"]);
}

#[test]
fn what_does_not_fit_is_not_saved() {
    let (_, model) = saved();
    let folder = tempfile::tempdir().expect("a folder");
    let mut unfit = model;
    unfit.weights.0[1].bias.pop();
    let error = unfit.save(folder.path()).expect_err("does not fit");
    assert_says(&error.to_string(), &["do not fit"]);
    assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), 0);
}
