//! Measuring picks what is fast and right, and a file keeps it.

use super::*;
use crate::forward::InputKind;
use crate::{ChannelOrder, Reach};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; a software one will do")
}

fn spec() -> NetSpec {
    NetSpec { levels: 2, u0: 4, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) }
}

fn chosen(tuning: &Tuning) -> Option<Variant> {
    tuning.variant(&spec(), &Options { input: InputKind::Textures, ..Options::default() })
}

#[test]
fn what_is_measured_is_remembered_in_a_file() {
    let gpu = gpu();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new").join("tuning.json");
    let (mut tuning, note) = Tuning::load(&gpu.device, &path);
    assert_eq!((note, chosen(&tuning)), (None, None));
    let notes = tuning.measure(&gpu, &spec(), [32, 48], Precision::F32).expect("runs");
    assert_eq!(notes, Vec::<String>::new(), "every kernel is right");
    tuning.save(&path).expect("written");
    let (loaded, note) = Tuning::load(&gpu.device, &path);
    assert_eq!(note, None);
    assert!(matches!(chosen(&loaded), Some(Variant::Gpu(_))));
    assert_eq!(chosen(&loaded), chosen(&tuning));
    let options = Options { variant: chosen(&loaded), ..Options::default() };
    Network::with(&gpu.device, &spec(), &Weights::random(&spec(), 2), &options).expect("compiles");

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
    let layers = (0..spec().layers().len()).map(|index| {
        (key(&spec(), index, Precision::F32), Measured { software: Some(0.5), fastest: Some(nonsense) })
    });
    let layers: Layers = layers.collect();
    tuning.file.devices.insert(tuning.device.clone(), layers);
    assert_eq!(chosen(&tuning), Some(Variant::gpu(&device.limits(), &spec(), OutputKind::Buffer)));
    let buffers = tuning.variant(&spec(), &Options::default());
    assert_eq!(buffers, Some(Variant::Software), "which is faster");
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
    let trial = Trial { gpu: &gpu, spec: &spec, weights: wrong, expected, size: [16, 16], precision };
    let (layers, notes) = trial.layers().expect("runs");
    let usable = |index| layers[&key(&spec, index, precision)].fastest.is_some();
    assert_eq!([0, 1, 2].map(usable), [true, false, false]);
    assert!(notes.iter().all(|note| note.contains("layer `down1` is wrong")), "{notes:?}");
    assert!(!notes.is_empty());
}
