//! `deepshade infer` on g-buffers as other renderers write them, and on damaged input.

use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights, reference};
use deepshade_render::exr_file::{self, Layer, Metadata, Window, Windows};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

#[path = "infer/networks.rs"]
mod networks;

const HEIGHT: usize = 36;
const WIDTH: usize = 50;

/// A folder with a model of random weights, and paths in it.
struct Case {
    folder: tempfile::TempDir,
    model: Model,
}

/// What half floats hold exactly, as they do positions.
const NORMALS: [[f32; 3]; 3] = [[0.0, 0.0, 1.0], [0.5, -0.5, 0.707_031_25], [-0.5, 0.5, 0.707_031_25]];

/// What a pinhole camera sees at a pixel: a surface so rough that its normals may be any.
fn position(y: usize, x: usize) -> [f32; 3] {
    let depth = 2.0 + ((5 * x * x + 7 * y * y + 3 * x * y) % 9) as f32 / 4.0;
    let across = |at: usize, size: usize| (2 * at + 1) as f32 / 64.0 - size as f32 / 64.0;
    [depth * across(x, WIDTH), -depth * across(y, HEIGHT), -depth]
}

impl Case {
    fn new() -> Self {
        let reach = Reach { radius: 2.0, diagonal_share: 0.05, height: HEIGHT };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let mut weights = Weights::random(&spec, 8);
        // An image most of which is within the effect's range, to which the program cuts it.
        let last = weights.0.last_mut().expect("a layer");
        last.weight.iter_mut().for_each(|weight| *weight *= 0.02);
        last.bias.fill(0.5);
        let model = Model { weights, spec };
        let case = Self { folder: tempfile::tempdir().expect("a folder"), model };
        case.model.save(&case.path("model")).expect("saved");
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a g-buffer whose first row shows nothing, and gives it with its validity. Where the file has a
    /// mask, all other channels of that row are `left`, and 0 where it has none.
    fn write(&self, attributes: &[Attribute], left: f32, metadata: &Metadata) -> GBuffer {
        let value = |attribute: Attribute, c: usize, y: usize, x: usize| match (attribute, y) {
            (Attribute::Valid, y) => f32::from(u8::from(y > 0)),
            (_, 0) => left,
            (Attribute::Position, _) => position(y, x)[c % 3],
            (Attribute::Normal, _) => NORMALS[(y + 3 * x) % NORMALS.len()][c % 3],
            _ => -position(y, x)[2],
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
    let apart = near.data().iter().zip(far.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart > 0.05, "images of two radii differ by {apart}, no more than half floats may");
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
    let point = GBuffer::new(
        INPUTS.to_vec(),
        Planes::from_fn(6, HEIGHT, WIDTH, |c, _, _| [0.0, 0.0, -0.5, 0.0, 0.0, 1.0][c]),
    );
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

/// Writes a g-buffer in full, its first row showing nothing by `nothing` in its positions, and the others
/// made of what they were: position and normal.
fn write_changed(case: &Case, nothing: f32, change: impl Fn([f32; 3], [f32; 3]) -> [[f32; 3]; 2]) {
    write_below(case, [[nothing; 3], [0.0; 3]], change);
}

/// The same with a first row of some position and normal.
fn write_below(case: &Case, first: [[f32; 3]; 2], change: impl Fn([f32; 3], [f32; 3]) -> [[f32; 3]; 2]) {
    let value = |c: usize, y: usize, x: usize| match y {
        0 => first[c / 3][c % 3],
        _ => change(position(y, x), NORMALS[(y + 3 * x) % NORMALS.len()])[c / 3][c % 3],
    };
    let gbuffer = GBuffer::new(INPUTS.to_vec(), Planes::from_fn(6, HEIGHT, WIDTH, value));
    let layer = Layer::gbuffer(&gbuffer).in_full();
    exr_file::write(&case.path("in.exr"), &[layer], &Metadata::new()).expect("written");
}

#[test]
fn no_surface_may_be_written_as_a_large_number() {
    let case = Case::new();
    let expected = case.expected(&case.write(&INPUTS, 0.0, &Metadata::new()), 2.0);
    for nothing in [f32::INFINITY, 1e10, -1e10, 65_504.0, -65_504.0, 1e30] {
        write_changed(&case, nothing, |position, normal| [position, normal]);
        case.assert_image(&case.run(&["--radius", "2"]), &expected);
    }
    write_below(&case, [[1e4; 3], [0.0, 0.0, 1.0]], |position, normal| [position, normal]);
    case.run(&["--radius", "2", "--trusted"]);
    let image = exr_file::read(&case.path("out.exr")).expect("reads").image("ao", 1).expect("a layer `ao`");
    assert_ne!(image.plane(0)[..WIDTH], expected.plane(0)[..WIDTH], "ten kilometres away is something");
}

#[test]
fn the_image_lies_where_the_gbuffer_lies() {
    let case = Case::new();
    let expected = case.expected(&case.write(&INPUTS, 0.0, &Metadata::new()), 2.0);
    let file = exr_file::read(&case.path("in.exr")).expect("reads").gbuffer(&INPUTS).expect("both");
    let data = Window { left: -10, top: 20, width: WIDTH, height: HEIGHT };
    let windows = Windows { data, display: Window::of_size(120, 160) };
    let layers = [Layer::gbuffer(&file)];
    exr_file::write_within(&case.path("in.exr"), &layers, &Metadata::new(), &windows).expect("written");
    case.assert_image(&case.run(&["--radius", "2"]), &expected);
    let image = exr_file::read_gbuffer(&case.path("out.exr"), &[], None).expect("reads");
    assert_eq!(image.windows(&[]).expect("the image's"), windows);
}

#[test]
fn a_gbuffer_in_another_space_is_refused_with_the_option_that_mends_it() {
    let case = Case::new();
    let expected = case.expected(&case.write(&INPUTS, 0.0, &Metadata::new()), 2.0);
    let backwards = |v: [f32; 3]| [v[0], v[1], -v[2]];
    let down = |v: [f32; 3]| [v[0], -v[1], v[2]];
    // The world's x is the camera's y, its y z, its z x, and the camera stands at (3, 4, 5).
    let world = |v: [f32; 3]| [v[1], v[2], v[0]];
    let moved = |v: [f32; 3]| [v[1] + 3.0, v[2] + 4.0, v[0] + 5.0];
    let unsigned = |v: [f32; 3]| v.map(|value| 0.5 * value + 0.5);
    let matrix = case.path("camera.txt");
    std::fs::write(&matrix, "0 1 0 3\n0 0 1 4\n1 0 0 5\n0 0 0 1\n").expect("written");
    let matrix = matrix.display().to_string();
    type Change = Box<dyn Fn([f32; 3], [f32; 3]) -> [[f32; 3]; 2]>;
    let cases: [(Change, &str, Vec<&str>); 7] = [
        (Box::new(move |p, n| [backwards(p), backwards(n)]), "(--forward z)", vec!["--forward", "z"]),
        (Box::new(move |p, n| [down(p), down(n)]), "(--up -y)", vec!["--up", "-y"]),
        (Box::new(move |p, n| [p, unsigned(n)]), "(--normals unsigned)", vec!["--normals", "unsigned"]),
        (
            Box::new(move |p, n| [moved(p), world(n)]),
            "world space (--space world, with --camera FILE",
            vec!["--space", "world", "--camera", &matrix],
        ),
        (Box::new(|p, n| [p, n.map(|v| 3.0 * v)]), "(--normals normalised)", vec!["--normals", "normalised"]),
        (Box::new(|p, n| [p, n.map(|v| -v)]), "(--normals turned", vec!["--normals", "turned"]),
        (
            Box::new(|p, n| [p.map(|v| 1000.0 * v), n]),
            "--metres-per-unit states it",
            vec!["--metres-per-unit", "0.001"],
        ),
    ];
    for (change, said, options) in &cases {
        write_changed(&case, 0.0, change);
        let without = case.run(&["--radius", "2"]);
        assert!(message(&without).contains(said), "no `{said}` in: {}", message(&without));
        let is_doubt = said.starts_with("--metres");
        assert_eq!(without.status.success(), is_doubt);
        assert_eq!(case.path("out.exr").exists(), is_doubt);
        let output = case.run(&[&["--radius", "2"], &options[..]].concat());
        case.assert_image(&output, &expected);
        std::fs::remove_file(case.path("out.exr")).expect("written before");
        write_changed(&case, 0.0, change);
        assert!(case.run(&["--radius", "2", "--trusted"]).status.success());
        std::fs::remove_file(case.path("out.exr")).expect("written before");
    }
}

#[test]
fn of_several_layers_one_is_chosen() {
    let case = Case::new();
    let expected = case.expected(&case.write(&INPUTS, 0.0, &Metadata::new()), 2.0);
    let file = exr_file::read(&case.path("in.exr")).expect("reads");
    let names = INPUTS.iter().flat_map(|attribute| attribute.channels()).map(|channel| channel.to_string());
    let planes: Vec<(String, Planes)> =
        names.map(|name| (name.clone(), file.layer(&name).unwrap_or_else(|_| plane(&file, &name)))).collect();
    let named: Vec<(String, &Planes)> = ["left", "right"]
        .iter()
        .flat_map(|view| planes.iter().map(move |(name, plane)| (format!("{view}.{name}"), plane)))
        .collect();
    let layers: Vec<Layer<'_>> = named.iter().map(|(name, plane)| Layer::image(name, plane)).collect();
    exr_file::write(&case.path("in.exr"), &layers, &Metadata::new()).expect("written");
    let said = ["in.exr", "ambiguous", "`left.normal.X` or `right.normal.X`", "--layer"];
    assert_refused(&case.run(&["--radius", "2"]), &case.path("out.exr"), &said);
    let none = case.run(&["--radius", "2", "--layer", "middle"]);
    assert_refused(&none, &case.path("out.exr"), &["no layer `middle`", "left.position.X"]);
    case.assert_image(&case.run(&["--radius", "2", "--layer", "right"]), &expected);
}

/// One channel of a vector.
fn plane(file: &exr_file::ExrImage, channel: &str) -> Planes {
    let (layer, component) = channel.rsplit_once('.').expect("a vector's channel");
    let index = ["X", "Y", "Z"].iter().position(|name| *name == component).expect("a component");
    let layer = file.layer(layer).expect("a layer");
    Planes::from_data(1, layer.height(), layer.width(), layer.plane(index).to_vec())
}

#[test]
fn the_image_may_be_a_png_file() {
    let case = Case::new();
    let expected = case.expected(&case.write(&INPUTS, 0.0, &Metadata::new()), 2.0);
    let out = case.path("out.png");
    let run = |out: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.arg("infer").arg("--model").arg(case.path("model")).arg("--gbuffer").arg(case.path("in.exr"));
        command.arg("--out").arg(out).args(["--radius", "2"]).output().expect("the program starts")
    };
    let output = run(&out);
    assert!(output.status.success(), "{}", message(&output));
    let picture = image::open(&out).expect("a picture").into_rgb8();
    assert_eq!((picture.width() as usize, picture.height() as usize), (WIDTH, HEIGHT));
    for (pixel, value) in picture.pixels().zip(expected.data()) {
        let byte = f32::from(deepshade_shaders::colour::srgb_byte(*value));
        let [r, g, b] = pixel.0.map(f32::from);
        assert!(r == g && g == b && (r - byte).abs() <= 2.0, "{pixel:?}, {byte}");
    }
    let jpg = case.path("out.jpg");
    assert_refused(&run(&jpg), &jpg, &["--out", ".png or .exr"]);
}
