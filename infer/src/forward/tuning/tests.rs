//! Measuring picks what is fast and right, and a file keeps it.

use super::*;
use crate::forward::InputKind;
use crate::{ChannelOrder, Reach};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; a software one will do")
}

fn spec() -> NetSpec {
    NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| (net.levels, net.u0) = (2, 4))
}

const SIZE: [usize; 2] = [32, 48];

fn chosen(tuning: &Tuning) -> Option<Variant> {
    let options = Options { input: InputKind::Textures, ..Options::default() };
    tuning.variant(&spec(), &options, SIZE).expect("there are kernels that work")
}

#[test]
fn what_is_measured_is_remembered_in_a_file() {
    let gpu = gpu();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new").join("tuning.json");
    let (mut tuning, note) = Tuning::load(&gpu.device, &path);
    assert_eq!((note, chosen(&tuning)), (None, None));
    let notes = tuning.measure(&gpu, &spec(), &Options::default(), SIZE).expect("runs");
    assert_eq!(notes, Vec::<String>::new(), "every kernel is right");
    tuning.save(&path).expect("written");
    let (loaded, note) = Tuning::load(&gpu.device, &path);
    assert_eq!(note, None);
    assert!(matches!(chosen(&loaded), Some(Variant::Gpu(_))));
    assert_eq!(chosen(&loaded), chosen(&tuning));
    let options = Options { variant: chosen(&loaded), ..Options::default() };
    Network::with(&gpu.device, &spec(), &Weights::random(&spec(), 2), &options).expect("compiles");

    let large = loaded.variant(&spec(), &Options::default(), [2160, 3840]).expect("nothing is known");
    assert_eq!(large, None, "small images' times mean nothing for large ones");
    let other = Tuning { device: "another adapter".to_owned(), ..loaded };
    assert_eq!(chosen(&other), None, "another device's times mean nothing");
}

#[test]
fn a_useless_file_is_noted_and_made_anew() {
    let device = gpu().device;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tuning.json");
    let empty = Tuning::new(&device);
    empty.save(&path).expect("written");
    let whole = std::fs::read_to_string(&path).expect("read");
    let foreign = whole.replace(env!("CARGO_PKG_VERSION"), "0.0.0-older");
    for useless in ["", "nonsense", &whole[..whole.len() / 2], &foreign, "{\"version\": 1}"] {
        std::fs::write(&path, useless).expect("written");
        let (tuning, note) = Tuning::load(&device, &path);
        assert!(note.expect("a note").ends_with("it will be made anew"), "{useless}");
        tuning.save(&path).expect("written");
        assert_eq!(Tuning::load(&device, &path).1, None);
    }
}

#[test]
fn shapes_that_no_kernel_has_are_not_taken_from_a_file() {
    let device = gpu().device;
    let mut tuning = Tuning::new(&device);
    let nonsense = Timed { outputs: 5, pixels: [7, 0], staged: true, milliseconds: 1.0 };
    let measured = LayerTimes { software: Some(0.5), fastest: Some(nonsense) };
    tuning.remember(&spec(), Precision::F32, SIZE, &[measured; 3]);
    assert_eq!(chosen(&tuning), Some(Variant::gpu(&device.limits(), &spec(), OutputKind::Buffer)));
    let buffers = tuning.variant(&spec(), &Options::default(), SIZE);
    assert_eq!(buffers.expect("works"), Some(Variant::Software), "which is faster");
}

#[test]
fn a_wrong_kernel_is_never_chosen() {
    let gpu = gpu();
    let spec = spec();
    let weights = Weights::random(&spec, 1);
    let mut wrong = weights.clone();
    wrong.0[1].weight.reverse();
    let input = noise(spec.input_channels(), PROOF[0], PROOF[1], 1);
    let expected = reference::layers(&spec, &weights, &input);
    let precision = Precision::F32;
    let trial =
        Trial { gpu: &gpu, spec: &spec, weights: wrong, expected, size: [16, 16], precision, cache: None };
    let mut notes = Vec::new();
    let layers = trial.layers(&mut notes).expect("runs");
    assert_eq!([0, 1, 2].map(|index: usize| layers[index].fastest.is_some()), [true, false, false]);
    assert!(notes.iter().all(|note| note.contains("layer `down1` is wrong")), "{notes:?}");
    assert!(!notes.is_empty());
}

#[test]
fn that_no_kernel_works_is_remembered_and_an_error_that_names_the_file() {
    let gpu = gpu();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tuning.json");
    let (mut tuning, _) = Tuning::load(&gpu.device, &path);
    tuning.remember(&spec(), Precision::F32, SIZE, &[LayerTimes::default(); 3]);
    tuning.save(&path).expect("written");
    let (loaded, _) = Tuning::load(&gpu.device, &path);
    let error = loaded.variant(&spec(), &Options::default(), SIZE).expect_err("none works");
    assert!(matches!(&error, ForwardError::NoKernel { layer, .. } if layer == "down0"), "{error}");
    assert!(error.to_string().contains(&format!("as {} remembers", path.display())), "{error}");
}

#[test]
fn where_no_half_floats_work_a_network_has_32_bits() {
    let gpu = gpu();
    assert!(
        gpu.device.features().contains(wgpu::Features::SHADER_F16),
        "lavapipe and GPUs of today have them"
    );
    let mut tuning = Tuning::new(&gpu.device);
    tuning.remember(&spec(), Precision::F16, SIZE, &[LayerTimes::default(); 3]);
    let model = Model { weights: Weights::random(&spec(), 2), spec: spec() };
    let options = Options { precision: Precision::F16, ..Options::default() };
    let (network, notes) = tuning.network(&gpu, &model, &options, SIZE).expect("32 bits do");
    assert_eq!(network.precision(), Precision::F32);
    assert!(notes[0].starts_with("no kernel of layer `down0` works in F16"), "{notes:?}");
}

#[test]
fn a_network_that_fails_spoils_no_other() {
    let gpu = gpu();
    let mut tuning = Tuning::new(&gpu.device);
    let shape = shapes(&spec(), 0, OutputKind::Buffer, tuning.limits.max_compute_workgroup_storage_size)[0];
    let Shape { outputs, pixels, staged } = shape;
    let works = LayerTimes {
        software: Some(0.5),
        fastest: Some(Timed { outputs, pixels, staged, milliseconds: 1.0 }),
    };
    tuning.remember(&spec(), Precision::F32, SIZE, &[works; 3]);
    let before = chosen(&tuning);
    // It begins with the same layer.
    let deeper = spec().reshaped(|net| net.levels = 3);
    let layers = |spec: &NetSpec| keys(spec, Precision::F32, SIZE, &tuning.limits);
    assert_eq!(layers(&deeper)[0], layers(&spec())[0]);
    tuning.remember(&deeper, Precision::F32, SIZE, &[LayerTimes::default(); 5]);
    assert_eq!(chosen(&tuning), before);
    let buffers = tuning.variant(&spec(), &Options::default(), SIZE);
    assert_eq!(buffers.expect("works"), Some(Variant::Software));
    tuning.variant(&deeper, &Options::default(), SIZE).expect_err("it does not work");
    // Measured again, such as by another driver of the same name.
    tuning.remember(&deeper, Precision::F32, SIZE, &[works; 5]);
    assert_eq!(tuning.variant(&deeper, &Options::default(), SIZE).expect("works"), Some(Variant::Software));
}

#[test]
fn a_device_that_allows_too_little_is_an_error_and_nothing_to_remember() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.expect("an adapter");
    let default = wgpu::Limits::default();
    let invocations = wgpu::Limits { max_compute_invocations_per_workgroup: 32, ..default.clone() };
    for (required_limits, name) in [
        (invocations, "`max_compute_invocations_per_workgroup` is 32; the network's kernels need 64"),
        (
            wgpu::Limits::downlevel_defaults(),
            "`max_storage_buffers_per_shader_stage` is 4; the network's kernels need 5",
        ),
    ] {
        let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
        let gpu = Gpu { device, queue, info: adapter.get_info() };
        let mut tuning = Tuning::new(&gpu.device);
        let error = tuning.measure(&gpu, &spec(), &Options::default(), SIZE).expect_err("too little");
        assert!(error.to_string().contains(name), "{error}");
        assert!(tuning.file.devices.is_empty());
    }
}

#[test]
fn a_refused_candidate_does_not_end_the_trial() {
    let gpu = gpu();
    // Too wide for the software kernels' uniform buffers.
    let spec = spec().reshaped(|net| (net.levels, net.u0) = (3, 128));
    let weights = Weights::random(&spec, 1);
    let expected = reference::layers(&spec, &weights, &noise(spec.input_channels(), PROOF[0], PROOF[1], 1));
    let precision = Precision::F32;
    let trial = Trial { gpu: &gpu, spec: &spec, weights, expected, size: [4, 4], precision, cache: None };
    let mut notes = Vec::new();
    let layers = trial.layers(&mut notes).expect("the others run");
    assert!(layers.iter().all(|layer| layer.software.is_none() && layer.fastest.is_some()), "{layers:?}");
    assert!(notes[0].contains("layer `up1`: eight of its outputs"), "{notes:?}");
}

#[test]
fn every_candidate_is_tried_before_a_failure_is_an_error() {
    let gpu = gpu();
    let (spec, weights) = (spec(), Weights::random(&spec(), 1));
    let expected = reference::layers(&spec, &weights, &noise(spec.input_channels(), PROOF[0], PROOF[1], 1));
    let candidates = Variant::candidates(&gpu.device.limits(), &spec, OutputKind::Buffer).len();
    let precision = Precision::F32;
    // All compile and are right, but none can be timed on images of no size.
    let trial = Trial { gpu: &gpu, spec: &spec, weights, expected, size: [0, 0], precision, cache: None };
    let mut notes = Vec::new();
    let error = trial.layers(&mut notes).expect_err("nothing is measured");
    assert!(matches!(error, ForwardError::Size { .. }), "{error}");
    assert_eq!(notes.len(), 1 + candidates, "{notes:?}");
}
