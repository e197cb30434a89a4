//! `deepshade infer` on g-buffers as other renderers write them, and on damaged input.

use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights, reference};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const HEIGHT: usize = 36;
const WIDTH: usize = 50;

/// A folder with a model of random weights, and paths in it.
struct Case {
    folder: tempfile::TempDir,
    model: Model,
}

impl Case {
    fn new() -> Self {
        let reach = Reach { radius: 2.0, diagonal_share: 0.05, height: HEIGHT };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let mut weights = Weights::random(&spec, 8);
        // An image most of which is within the effect's range, to which the program cuts it.
        let last = weights.0.last_mut().expect("a layer");
        last.weight.iter_mut().for_each(|weight| *weight *= 0.1);
        last.bias.fill(0.5);
        let model = Model { weights, spec };
        let case = Self { folder: tempfile::tempdir().expect("a folder"), model };
        case.model.save(&case.path("model")).expect("saved");
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a g-buffer whose first row shows nothing, and gives it with its validity. Where the file has a mask, all
    /// other channels of that row are `left`, and 0 where it has none.
    fn write(&self, attributes: &[Attribute], left: f32, metadata: &Metadata) -> GBuffer {
        let value = |attribute: Attribute, c: usize, y: usize, x: usize| match (attribute, y) {
            (Attribute::Valid, y) => f32::from(u8::from(y > 0)),
            (_, 0) => left,
            _ => ((7 * c + 3 * y + 5 * x) % 31) as f32 / 16.0 - 0.75,
        };
        let gbuffer = |attributes: &[Attribute]| {
            let channels: Vec<Attribute> =
                attributes.iter().flat_map(|attribute| vec![*attribute; attribute.width()]).collect();
            let value = |c: usize, y: usize, x: usize| value(channels[c], c, y, x);
            GBuffer::new(attributes.to_vec(), Planes::from_fn(channels.len(), HEIGHT, WIDTH, value))
        };
        let file = gbuffer(attributes);
        exr_file::write(&self.path("in.exr"), &[Layer::gbuffer(&file)], metadata).expect("written");
        match attributes.contains(&Attribute::Valid) {
            true => file,
            false => gbuffer(&[attributes, &[Attribute::Valid]].concat()),
        }
    }

    fn run(&self, more: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.arg("infer").arg("--model").arg(self.path("model")).arg("--gbuffer").arg(self.path("in.exr"));
        command.arg("--out").arg(self.path("out.exr")).args(more);
        command.output().expect("the program starts")
    }

    /// The image that must come out, at a radius.
    fn expected(&self, gbuffer: &GBuffer, radius: f32) -> Planes {
        let scaling = self.model.spec.scaling(gbuffer, radius).expect("all inputs");
        let input = self.model.spec.input(gbuffer, scaling, 0).expect("all inputs");
        let image = reference::forward(&self.model.spec, &self.model.weights, &input);
        let mut image = image.map(|value| value.clamp(0.0, 1.0));
        let inside = image.data().iter().filter(|value| (0.01..0.99).contains(*value)).count();
        assert!(4 * inside > image.data().len(), "an image of blacks and whites proves little");
        image.plane_mut(0)[..WIDTH].fill(1.0);
        image
    }

    fn assert_image(&self, output: &Output, expected: &Planes) {
        assert!(output.status.success(), "{}", message(output));
        let image =
            exr_file::read(&self.path("out.exr")).expect("reads").image("ao", 1).expect("a layer `ao`");
        let largest =
            image.data().iter().zip(expected.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let scale = expected.data().iter().fold(1f32, |scale, value| scale.max(value.abs()));
        assert!(largest <= 1e-3 * scale, "largest difference {largest}, half floats of up to {scale}");
    }
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn assert_refused(output: &Output, out: &Path, named: &[&str]) {
    let message = message(output);
    assert!(!output.status.success(), "accepted");
    assert!(!message.contains("panicked"), "{message}");
    for name in named {
        assert!(message.contains(name), "no `{name}` in: {message}");
    }
    assert!(!out.exists(), "something was written");
}

const INPUTS: [Attribute; 2] = [Attribute::Position, Attribute::Normal];
const MASKED: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];

#[test]
fn the_radius_asked_for_scales_positions() {
    let case = Case::new();
    let gbuffer = case.write(&MASKED, 0.0, &Metadata::new());
    let (near, far) = (case.expected(&gbuffer, 0.5), case.expected(&gbuffer, 3.0));
    assert_ne!(near, far);
    case.assert_image(&case.run(&["--radius", "0.5"]), &near);
    case.assert_image(&case.run(&["--radius", "3"]), &far);
}

#[test]
fn what_a_renderer_leaves_where_nothing_is_seen_changes_nothing() {
    let case = Case::new();
    let expected = case.expected(&case.write(&MASKED, 0.0, &Metadata::new()), 2.0);
    // As far away as half floats reach.
    case.write(&MASKED, -65_504.0, &Metadata::new());
    case.assert_image(&case.run(&["--radius", "2"]), &expected);
    let by_default = case.run(&[]);
    assert!(by_default.status.success(), "{}", message(&by_default));
    let radius = default_radius(&case.write(&MASKED, 0.0, &Metadata::new()));
    let said = format!("radius {radius} m");
    assert!(String::from_utf8_lossy(&by_default.stdout).contains(&said), "{said}: {by_default:?}");
}

#[test]
fn without_a_mask_pixels_of_zeros_show_nothing() {
    let case = Case::new();
    let gbuffer = case.write(&INPUTS, 0.0, &Metadata::new());
    case.assert_image(&case.run(&["--radius", "2"]), &case.expected(&gbuffer, 2.0));
}

#[test]
fn the_files_radius_is_used_before_the_default() {
    let case = Case::new();
    let stated = Metadata::from([("radius_metres".to_owned(), "0.75".to_owned())]);
    let gbuffer = case.write(&INPUTS, 0.0, &stated);
    case.assert_image(&case.run(&[]), &case.expected(&gbuffer, 0.75));
}

/// The network's share of the diagonal of what is seen, and at most a quarter of its median depth.
fn default_radius(gbuffer: &GBuffer) -> f32 {
    let mut square = 0.0;
    for axis in 0..3 {
        let seen = &gbuffer.planes().plane(axis)[WIDTH..];
        let (low, high) =
            seen.iter().fold((f32::MAX, f32::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
        square += (high - low).powi(2);
    }
    let z = &gbuffer.planes().plane(2)[WIDTH..];
    let mut depths: Vec<f32> = z.iter().filter(|z| **z < 0.0).map(|z| -z).collect();
    depths.sort_unstable_by(f32::total_cmp);
    (0.05 * square.sqrt()).min(0.25 * depths[depths.len() / 2])
}

#[test]
fn the_default_radius_is_a_share_of_what_is_seen() {
    let case = Case::new();
    let gbuffer = case.write(&INPUTS, 0.0, &Metadata::new());
    case.assert_image(&case.run(&[]), &case.expected(&gbuffer, default_radius(&gbuffer)));
}

#[test]
fn a_size_that_cannot_be_told_and_a_radius_too_small_are_refused() {
    let case = Case::new();
    let point = GBuffer::new(INPUTS.to_vec(), Planes::filled(6, HEIGHT, WIDTH, 0.5));
    exr_file::write(&case.path("in.exr"), &[Layer::gbuffer(&point)], &Metadata::new()).expect("written");
    let out = case.path("out.exr");
    assert_refused(&case.run(&[]), &out, &["in.exr", "a diagonal of 0 m", "--radius"]);
    assert_refused(&case.run(&["--radius", "1e-45"]), &out, &["radius", "too small"]);
    assert!(case.run(&["--radius", "1"]).status.success());
}

#[test]
fn a_missing_layer_is_named_with_what_there_is() {
    let case = Case::new();
    case.write(&[Attribute::Position, Attribute::Depth], 0.0, &Metadata::new());
    assert_refused(&case.run(&[]), &case.path("out.exr"), &["in.exr", "normal.X", "position.X", "depth"]);
}

#[test]
fn damaged_input_is_refused() {
    let case = Case::new();
    let out = case.path("out.exr");
    assert_refused(&case.run(&[]), &out, &["in.exr"]);
    case.write(&INPUTS, 0.0, &Metadata::new());
    let whole = std::fs::read(case.path("in.exr")).expect("a file");
    std::fs::write(case.path("in.exr"), &whole[..whole.len() / 2]).expect("written");
    assert_refused(&case.run(&[]), &out, &["in.exr"]);
    case.write(&INPUTS, 0.0, &Metadata::new());
    assert_refused(&case.run(&["--radius=-1"]), &out, &["--radius"]);
    let weights = case.path("model/weights.safetensors");
    let whole = std::fs::read(&weights).expect("a file");
    std::fs::write(&weights, &whole[..whole.len() - 100]).expect("written");
    assert_refused(&case.run(&["--radius", "1"]), &out, &["weights.safetensors"]);
    let spec = case.model.spec.clone().reshaped(|net| net.kernel = 1);
    let other = Model { weights: Weights::random(&spec, 8), spec };
    let json = std::fs::read(case.path("model/net.json")).expect("a file");
    other.save(&case.path("model")).expect("saved");
    std::fs::write(case.path("model/net.json"), json).expect("written");
    let shapes = ["weights.safetensors", "`down0.weight`", "[8, 6, 1, 1]", "[8, 6, 3, 3]"];
    assert_refused(&case.run(&["--radius", "1"]), &out, &shapes);
    std::fs::remove_file(case.path("model/net.json")).expect("removed");
    assert_refused(&case.run(&["--radius", "1"]), &out, &["net.json"]);
}

#[test]
fn a_file_that_states_a_wrong_radius_is_refused() {
    let case = Case::new();
    case.write(&INPUTS, 0.0, &Metadata::from([("radius_metres".to_owned(), "wide".to_owned())]));
    assert_refused(&case.run(&[]), &case.path("out.exr"), &["in.exr", "radius_metres", "wide"]);
}
