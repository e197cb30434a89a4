//! Networks that read other things than positions and normals, and skies that a file tells in its own way.

use super::*;
use deepshade_shaders::Effect;
use glam::Vec3;

const SIZE: [usize; 2] = [30, 40];

/// A network, and a folder for its g-buffer and its image.
struct Tried {
    folder: tempfile::TempDir,
    model: PathBuf,
}

/// What a right g-buffer holds at a pixel: rough surfaces that face the camera, and no surface in the first
/// four rows, where all is 0.
fn value(attribute: Attribute, y: usize, x: usize) -> Vec<f32> {
    let direction = Vec3::new((x as f32 - 19.5) / 30.0, (14.5 - y as f32) / 30.0, -1.0);
    let some = |step: usize| ((x * step + y * 7) % 11) as f32 / 10.0;
    let bump = Vec3::new(some(3) - 0.5, some(5) - 0.5, some(2) - 0.5);
    let depth = 2.0 + ((5 * x * x + 7 * y * y + 3 * x * y) % 9) as f32 / 4.0;
    if y < 4 {
        return vec![0.0; attribute.width()];
    }
    match attribute {
        Attribute::Position => (depth * direction).to_array().to_vec(),
        Attribute::Normal => (bump - direction.normalize()).normalize().to_array().to_vec(),
        // The camera stands turned in its world.
        Attribute::WorldNormal => turned(Vec3::from_slice(&value(Attribute::Normal, y, x))),
        Attribute::ToCamera => turned(-direction.normalize()),
        Attribute::Depth => vec![depth],
        Attribute::Motion => vec![some(4), 3.0],
        other => (1..=other.width()).map(|step| 0.1 + 0.8 * some(step)).collect(),
    }
}

fn turned(vector: Vec3) -> Vec<f32> {
    vec![-vector.z, vector.y, vector.x]
}

impl Tried {
    /// The paper's network for an effect, of random weights.
    fn of(effect: Effect) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 256 };
        let spec = NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one");
        let mut weights = Weights::random(&spec, 3);
        // An image of light.
        weights.0.last_mut().expect("a layer").bias.fill(2.0);
        let model = folder.path().join("model");
        Model { weights, spec }.save(&model).expect("saved");
        Self { folder, model }
    }

    /// One that is shipped.
    fn shipped(name: &str) -> Self {
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name);
        Self { folder: tempfile::tempdir().expect("a folder"), model }
    }

    /// Writes attributes in full, each changed by its name, row and column.
    fn write(&self, attributes: &[Attribute], change: impl Fn(Attribute, usize, Vec<f32>) -> Vec<f32>) {
        let pixel = |y, x| -> Vec<f32> {
            attributes.iter().flat_map(|attribute| change(*attribute, y, value(*attribute, y, x))).collect()
        };
        let channels = attributes.iter().map(|attribute| attribute.width()).sum();
        let planes = Planes::from_fn(channels, SIZE[0], SIZE[1], |c, y, x| pixel(y, x)[c]);
        let gbuffer = GBuffer::new(attributes.to_vec(), planes);
        let layer = Layer::gbuffer(&gbuffer).in_full();
        exr_file::write(&self.folder.path().join("in.exr"), &[layer], &Metadata::new()).expect("written");
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out.exr")
    }

    fn run(&self, more: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.arg("infer").arg("--model").arg(&self.model).args(["--radius", "1"]).arg("--gbuffer");
        command.arg(self.folder.path().join("in.exr")).arg("--out").arg(self.out()).args(more);
        command.output().expect("the program starts")
    }

    /// The image that comes out, and what was said.
    fn image(&self, more: &[&str]) -> (Vec<f32>, String) {
        let output = self.run(more);
        assert!(output.status.success(), "{}", message(&output));
        let file = exr_file::read(&self.out()).expect("reads");
        std::fs::remove_file(self.out()).expect("written");
        let layer = file.layers().swap_remove(0);
        (file.layer(&layer).expect("a layer").data().to_vec(), message(&output))
    }

    fn refused(&self, more: &[&str], named: &[&str]) {
        assert_refused(&self.run(more), &self.out(), named);
    }
}

fn assert_same(a: &[f32], b: &[f32]) {
    let largest = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let scale = a.iter().fold(1f32, |scale, value| scale.max(value.abs()));
    assert!(a.len() == b.len() && largest <= 2e-3 * scale, "largest difference {largest} of {scale}");
}

const AA: [Attribute; 2] = [Attribute::Depth, Attribute::Light];
const IBL: [Attribute; 5] = [
    Attribute::WorldNormal,
    Attribute::ToCamera,
    Attribute::Diffuse,
    Attribute::Specular,
    Attribute::Glossiness,
];

fn as_it_is(_: Attribute, _: usize, value: Vec<f32>) -> Vec<f32> {
    value
}

#[test]
fn world_normals_are_mended_as_normals_are() {
    let ibl = Tried::of(Effect::Ibl);
    ibl.write(&IBL, as_it_is);
    let (expected, said) = ibl.image(&[]);
    assert!(!said.contains("normals"), "{said}");
    let each = |change: fn(f32) -> f32| {
        move |attribute: Attribute, y: usize, value: Vec<f32>| match attribute {
            Attribute::WorldNormal if y >= 4 => value.into_iter().map(change).collect(),
            _ => value,
        }
    };
    ibl.write(&IBL, each(|v| 0.5 * v + 0.5));
    ibl.refused(&[], &["`world_normal`", "(--normals unsigned)"]);
    assert_same(&ibl.image(&["--normals", "unsigned"]).0, &expected);
    ibl.write(&IBL, each(|v| 3.0 * v));
    ibl.refused(&[], &["`world_normal`", "(--normals normalised)"]);
    assert_same(&ibl.image(&["--normals", "normalised"]).0, &expected);
    let reversed = |wanted: Attribute| {
        move |attribute: Attribute, _: usize, value: Vec<f32>| match attribute == wanted {
            true => value.into_iter().map(|v| -v).collect(),
            false => value,
        }
    };
    ibl.write(&IBL, reversed(Attribute::WorldNormal));
    ibl.refused(&[], &["(--normals turned"]);
    assert_same(&ibl.image(&["--normals", "turned"]).0, &expected);
    ibl.write(&IBL, reversed(Attribute::ToCamera));
    ibl.refused(&[], &["`to_camera` holds directions from the camera"]);
}

#[test]
fn an_estimate_that_a_file_holds_is_taken_and_else_made() {
    let aa = Tried::shipped("aa");
    let read = [Attribute::Normal, Attribute::Position, Attribute::Light];
    let with = [&read[..], &[Attribute::Estimate]].concat();
    aa.write(&read, as_it_is);
    let (made, _) = aa.image(&[]);
    let of = |factor: f32| {
        aa.write(&with, |attribute, _, value| match attribute {
            Attribute::Estimate => value.into_iter().map(|value| factor * value).collect(),
            _ => value,
        });
        aa.image(&[]).0
    };
    let mean = |image: &[f32]| image.iter().sum::<f32>() / image.len() as f32;
    let (held, brighter) = (of(1.0), of(3.0));
    assert!(mean(&brighter) > 1.2 * mean(&held), "{} of {}", mean(&brighter), mean(&held));
    assert!(made.iter().zip(&held).any(|(a, b)| (a - b).abs() > 0.1), "fxaa makes another");
}

#[test]
fn an_option_that_touches_nothing_that_is_read_is_refused() {
    let aa = Tried::of(Effect::Aa);
    aa.write(&AA, as_it_is);
    aa.refused(&["--normals", "unsigned"], &["--normals unsigned", "`normal`, `world_normal`", "`depth`"]);
    aa.refused(&["--forward", "z"], &["--forward z", "`position`"]);
    aa.image(&["--metres-per-unit", "1"]);
    let ibl = Tried::of(Effect::Ibl);
    ibl.write(&IBL, as_it_is);
    ibl.refused(&["--depth", "negative"], &["--depth negative", "`depth`", "`to_camera`"]);
    ibl.refused(&["--normals", "reversed-z"], &["--normals reversed-z"]);
}

#[test]
fn a_negative_depth_and_a_depth_buffer_are_told() {
    let aa = Tried::of(Effect::Aa);
    aa.write(&AA, as_it_is);
    let (expected, _) = aa.image(&[]);
    let depth = |change: fn(f32) -> f32| {
        move |attribute: Attribute, y: usize, value: Vec<f32>| match attribute {
            Attribute::Depth if y >= 4 => value.into_iter().map(change).collect(),
            _ => value,
        }
    };
    aa.write(&AA, depth(|depth| -depth));
    aa.refused(&[], &["negative", "(--depth negative)"]);
    assert_same(&aa.image(&["--depth", "negative"]).0, &expected);
    aa.write(&AA, depth(|depth| 1.0 - 0.1 / depth));
    aa.refused(&[], &["depth buffer", "--trusted"]);
    aa.image(&["--trusted"]);
    // Positions that are not read tell that depth is something else.
    let with_positions = [&AA[..], &[Attribute::Position]].concat();
    aa.write(&with_positions, as_it_is);
    assert_same(&aa.image(&[]).0, &expected);
    aa.write(&with_positions, depth(|depth| 1.0 / depth));
    aa.refused(&[], &["`depth` is not -position.Z"]);
}

#[test]
fn normals_alone_must_face_the_camera() {
    let real = Tried::of(Effect::Real);
    real.write(&[Attribute::Normal], as_it_is);
    let (expected, _) = real.image(&[]);
    real.write(&[Attribute::Normal], |_, _, value| value.into_iter().map(|v| -v).collect());
    real.refused(&[], &["face away", "(--normals turned"]);
    assert_same(&real.image(&["--normals", "turned"]).0, &expected);
}

#[test]
fn a_sky_that_depth_tells_is_none_of_the_surfaces() {
    let moving = [Attribute::Motion, Attribute::Light];
    for (effect, attributes) in [(Effect::Aa, &AA[..]), (Effect::MotionBlur, &moving)] {
        let tried = Tried::of(effect);
        let attributes = [attributes, &[Attribute::Depth]].concat();
        let attributes: Vec<Attribute> = (0..attributes.len())
            .filter(|at| !attributes[..*at].contains(&attributes[*at]))
            .map(|at| attributes[at])
            .collect();
        tried.write(&attributes, as_it_is);
        let (expected, said) = tried.image(&[]);
        assert!(!said.contains("no surface"), "{said}");
        for sky in [1e5, 1e6, 1e8, -1.0, f32::INFINITY] {
            tried.write(&attributes, |attribute, y, value| match (attribute, y) {
                (Attribute::Depth, 0..4) => vec![sky],
                (Attribute::Light, 0..4) => vec![0.5; 3],
                _ => value,
            });
            let (image, said) = tried.image(&[]);
            assert_same(&image, &expected);
            assert_eq!(said.contains(&format!("`depth` is {sky}")), sky.is_finite(), "{said}");
        }
    }
}

#[test]
fn a_sky_that_only_what_is_not_read_or_the_normals_tell_is_seen() {
    let ao = Tried::shipped("ao");
    let attributes = [Attribute::Position, Attribute::Normal, Attribute::Depth];
    ao.write(&attributes, as_it_is);
    let (expected, _) = ao.image(&[]);
    let with_sky = |position: [f32; 3], normal: [f32; 3], depth: f32| {
        move |attribute: Attribute, y: usize, value: Vec<f32>| match (attribute, y) {
            (Attribute::Position, 0..4) => position.to_vec(),
            (Attribute::Normal, 0..4) => normal.to_vec(),
            (Attribute::Depth, 0..4) => vec![depth],
            _ => value,
        }
    };
    let (far, up) = ([1.0, 2.0, -30.0], [0.0, 0.0, 1.0]);
    for depth in [1e10, 65_504.0, f32::INFINITY] {
        ao.write(&attributes, with_sky(far, up, depth));
        assert_same(&ao.image(&[]).0, &expected);
    }
    ao.write(&attributes, with_sky(far, [0.0; 3], 30.0));
    assert_same(&ao.image(&[]).0, &expected);
    for z in [-1e5, -1e6, -1e8] {
        ao.write(&INPUTS, with_sky([0.0, 0.0, z], up, 0.0));
        let (image, said) = ao.image(&[]);
        assert_same(&image, &expected);
        assert!(said.contains(&format!("`position.Z` is {z}")), "{said}");
    }
    // Thirty metres away is something.
    ao.write(&attributes, with_sky(far, up, 30.0));
    let (image, _) = ao.image(&["--trusted"]);
    assert!(image.iter().zip(&expected).any(|(a, b)| (a - b).abs() > 0.01));
}
