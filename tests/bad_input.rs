//! What people give the program by mistake: it names what is wrong, ends with a code other than 0, does not
//! panic, and leaves no file behind. Every kind of damage to a file has tests in the crate that reads it;
//! here one of each kind goes through the program. What `infer` is given is in `infer.rs`.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// A folder in which the program runs.
struct Case(tempfile::TempDir);

impl Case {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), bytes).expect("written");
    }

    /// Runs the program, which must refuse, name all of `named`, and leave the folder as it is.
    fn assert_refused(&self, args: &[&str], named: &[&str]) {
        let before = files(self.0.path());
        let output = Command::new(PROGRAM).args(args).current_dir(self.0.path()).output().expect("starts");
        assert_message(&output, &args.join(" "), named);
        assert_eq!(files(self.0.path()), before, "{}", args.join(" "));
    }

    /// `deepshade scene` must refuse a file.
    fn assert_scene_refused(&self, file: &str, named: &[&str]) {
        self.assert_refused(&["scene", file, "--json", "scene.json"], named);
    }
}

fn assert_message(output: &Output, what: &str, named: &[&str]) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "{what}: accepted");
    assert!(output.status.code().is_some(), "{what}: killed by a signal: {message}");
    assert!(!message.contains("panicked"), "{what}: {message}");
    for name in named {
        assert!(message.contains(name), "{what}: no `{name}` in: {message}");
    }
}

/// What a folder holds, by path; folders are empty.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for path in std::fs::read_dir(folder).expect("listed").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            found.extend(files(&path));
            found.insert(path, Vec::new());
        } else {
            let bytes = std::fs::read(&path).expect("read");
            found.insert(path, bytes);
        }
    }
    found
}

/// A glTF file of some triangles, corner by corner, whose numbers are in `mesh.bin`; `more` is further JSON.
fn gltf(corners: &[[f32; 3]], nodes: &str, more: &str) -> String {
    let bytes = size_of_val(corners);
    let mesh = r#"[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}]"#;
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"mesh.bin","byteLength":{bytes}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{bytes}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}}],
        "meshes":{mesh},"nodes":[{{"mesh":0}}{nodes}]{more}}}"#,
        corners.len()
    )
}

/// What `mesh.bin` holds.
fn numbers(corners: &[[f32; 3]]) -> Vec<u8> {
    corners.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The same as a GLB file: 12 bytes of header, then two chunks with 8 bytes of header each.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.replace(r#""uri":"mesh.bin","#, "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |length: usize| (length as u32).to_le_bytes();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let header = [*b"glTF", word(2), word(length)].concat();
    let chunk = |kind: [u8; 4], bytes: &[u8]| [&word(bytes.len())[..], &kind, bytes].concat();
    [header, chunk(*b"JSON", &json), chunk(*b"BIN\0", binary)].concat()
}

const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const PLAIN: &str = r#","materials":[{}]"#;
const TEXTURED: &str = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"uri":"bark.png"}]"#;

#[test]
fn scene_files_that_are_missing_or_cut_off() {
    let case = Case::new();
    case.assert_scene_refused("gone.gltf", &["gone.gltf"]);
    case.assert_scene_refused("gone.obj", &["gone.obj"]);
    case.assert_scene_refused("gone.fbx", &["gone.fbx", ".gltf"]);
    let (text, binary) = (gltf(&CORNERS, "", PLAIN), numbers(&CORNERS));
    case.write("whole.gltf", &text);
    case.assert_scene_refused("whole.gltf", &["mesh.bin"]);
    case.write("mesh.bin", &binary[..20]);
    case.assert_scene_refused("whole.gltf", &["whole.gltf", "truncated"]);
    case.write("mesh.bin", &binary);
    case.write("half.gltf", &text[..text.len() / 2]);
    case.assert_scene_refused("half.gltf", &["half.gltf"]);
    let bytes = glb(&text, &binary);
    for length in [4, 15, 100, bytes.len() - 10] {
        case.write("half.glb", &bytes[..length]);
        case.assert_scene_refused("half.glb", &["half.glb"]);
    }
    for (name, whole) in [("whole.gltf", text.as_bytes()), ("whole.glb", &bytes)] {
        case.write(name, whole);
        let status = Command::new(PROGRAM).arg("scene").arg(case.0.path().join(name)).output();
        assert!(status.expect("starts").status.success(), "{name}: the damage is what is refused");
    }
}

#[test]
fn textures_that_are_missing_or_cut_off() {
    let case = Case::new();
    case.write("tree.gltf", gltf(&CORNERS, "", TEXTURED));
    case.write("mesh.bin", numbers(&CORNERS));
    case.assert_scene_refused("tree.gltf", &["bark.png"]);
    let mut png = Cursor::new(Vec::new());
    image::RgbImage::new(8, 8).write_to(&mut png, image::ImageFormat::Png).expect("a PNG");
    let png = png.into_inner();
    case.write("bark.png", &png[..png.len() / 2]);
    case.assert_scene_refused("tree.gltf", &["tree.gltf", "bark.png"]);
}

#[test]
fn meshes_without_sense() {
    let case = Case::new();
    for number in ["nan", "inf", "-inf", "1e39"] {
        case.write("wild.obj", format!("v 0 0 0\nv 1 {number} 0\nv 0 1 0\nf 1 2 3\n"));
        case.assert_scene_refused("wild.obj", &["wild", "finite"]);
    }
    case.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    case.assert_scene_refused("points.obj", &["points", "no triangle"]);
    case.write("needles.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n");
    case.assert_scene_refused("needles.obj", &["needles", "no triangle"]);
    let out = ["compare", "--scene", "needles.obj", "--methods", "truth", "--out", "report"];
    case.assert_refused(&out, &["needles", "no triangle"]);
}

/// A closed cube around the origin whose triangles face outwards.
fn cube(half: f32) -> Vec<[f32; 3]> {
    let mut corners = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, -half), (axis, half)]) {
        let corner = |u: f32, v: f32| {
            let mut corner = [side; 3];
            corner[(axis + 1) % 3] = u * half;
            corner[(axis + 2) % 3] = v * half;
            corner
        };
        let mut square = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        if side < 0.0 {
            square.reverse();
        }
        corners.extend([0, 1, 2, 0, 2, 3].map(|index| square[index]));
    }
    corners
}

#[test]
fn a_camera_inside_of_a_wall() {
    let case = Case::new();
    // Far away, so that the cube is small in the scene.
    let far = [[20.0, 0.0, 0.0], [21.0, 0.0, 0.0], [20.0, 1.0, 0.0]];
    let corners = [cube(0.2), far.to_vec()].concat();
    let eye = r#",{"camera":0,"name":"eye"}"#;
    let camera =
        r#","materials":[{}],"cameras":[{"type":"perspective","perspective":{"yfov":0.9,"znear":0.01}}]"#;
    case.write("wall.gltf", gltf(&corners, eye, camera));
    case.write("mesh.bin", numbers(&corners));
    let compare = ["compare", "--scene", "wall.gltf", "--methods", "truth", "--out", "report"];
    case.assert_refused(&compare, &["camera `eye`", "inside of geometry"]);
    case.assert_refused(&[&compare[..], &["--camera", "ear"]].concat(), &["camera `ear`", "eye"]);
}

/// The tiny recipe with a part replaced.
fn recipe(from: &str, to: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
    let text = std::fs::read_to_string(path).expect("a recipe");
    assert!(text.contains(from), "`{from}` is not in the recipe");
    text.replacen(from, to, 1)
}

#[test]
fn recipes_with_unknown_keys_and_absurd_sizes() {
    let case = Case::new();
    let cases = [
        ("seed = 3", "seed = 3\ncolour = 1", "colour"),
        ("height = 64", "height = 1000000000", "resolution.height"),
        ("height = 64", "height = -1", "height"),
        ("views_per_scene = 4", "views_per_scene = 9000000000000000000", "views_per_scene"),
        ("samples = 16", "samples = 4000000000", "samples"),
        ("{ diagonal = ", "{ diagonal = inf } # ", "radius.diagonal"),
        ("name = \"room\"", "name = \"drapery\"", "drapery"),
        ("effect = \"ao\"", "effect = \"ao", "recipe.toml"),
    ];
    for (from, to, named) in cases {
        case.write("recipe.toml", recipe(from, to));
        let generate = ["dataset", "generate", "recipe.toml", "--out", "data", "--json", "data.json"];
        case.assert_refused(&generate, &["recipe.toml", named]);
    }
}

#[test]
fn settings_that_make_no_sense() {
    let case = Case::new();
    let refused = |line: &str, named: &str| {
        case.assert_refused(&line.split(' ').collect::<Vec<_>>(), &[named]);
    };
    refused("compare --scene stairs:7 --out report --height 1000000000", "--height");
    refused("compare --scene stairs:7 --out report --radius nan", "--radius");
    refused("compare --scene stairs:x --out report", "stairs:x");
    refused("compare --scene stares:7 --out report", "stares");
    refused("compare --scene stairs:7 --out report --model gone", "`gone`; there are aa, ao,");
    refused("dataset verify gone", "gone");
    refused("eval --model gone", "gone");
    refused("eval --all --methods learned,gtoa", "`gtoa`");
    case.write("file", "x");
    refused("scene stairs:7 --json file/scene.json", "--json");
    #[cfg(feature = "train")]
    {
        for minutes in ["0", "-1", "nan", "1e300", "soon"] {
            refused(&format!("demo --out demo --minutes={minutes}"), "--minutes");
            refused(&format!("train --dataset data --out run --minutes={minutes}"), "--minutes");
        }
        refused("train --dataset gone --out run", "gone");
        refused("train --dataset data --out run --optimiser adadelta --weight-decay 0.1", "--weight-decay");
        refused("export --run gone --out model", "gone");
        refused("bench train --crop 8000000", "--crop");
        refused("bench train --crop 8192 --batch 1000", "`batch`");
        refused("bench train --crop 12", "`crop`");
        refused("bench net --seconds 1e20", "--seconds");
        refused("bench net --networks aa --models gone", "--models gone");
        refused("bench net --networks aa --onnxruntime gone.so", "gone.so");
        refused("export", "--model");
        refused("export --model aos --out model", "did you mean `ao`?");
        refused("export --model ao", "--out");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full() {
    let case = Case::new();
    case.assert_refused(&["scene", "stairs:7", "--json", "/dev/full"], &["/dev/full", "No space left"]);

    // As a full disk, but for one process: files beyond so many KiB fail, where the signal of that is
    // ignored. That is room for the journal, and not for a pair.
    case.write("recipe.toml", recipe("seed = 3", "seed = 3"));
    let generate = ["dataset", "generate", "recipe.toml", "--out", "data"];
    let output = Command::new("bash")
        .args(["-c", "trap '' XFSZ; ulimit -f 4; exec \"$@\"", "bash", PROGRAM])
        .args(generate)
        .current_dir(case.0.path())
        .output()
        .expect("bash starts");
    assert_message(&output, "a full disk", &["pairs", "File too large"]);
    let left: Vec<PathBuf> = files(&case.0.path().join("data")).into_keys().filter(|p| p.is_file()).collect();
    assert_eq!(left, [case.0.path().join("data/unfinished.jsonl")], "only the journal");
}
