//! Small glTF files written by hand: numbers become accessors, the rest is JSON.

use deepshade_render::scene::{Scene, SceneError};
use std::{fmt::Write, fs, path::Path};

/// Collects the accessors of a file.
#[derive(Clone, Default)]
pub struct Builder {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Builder {
    /// Adds an accessor of floats; `kind` is SCALAR, VEC2, VEC3, VEC4 or MAT4. Returns its index.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len() / components(kind), &bytes, "")
    }

    /// Adds an accessor of unsigned 16-bit integers.
    pub fn shorts(&mut self, kind: &str, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, 5123, values.len() / components(kind), &bytes, "")
    }

    /// Adds an accessor of any type; `more` is further JSON in it, with a comma in front.
    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8], more: &str) -> usize {
        let view = self.view(bytes);
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"{more}}}"#
        ));
        self.accessors.len() - 1
    }

    /// Adds an accessor from its JSON.
    pub fn raw_accessor(&mut self, json: &str) -> usize {
        self.accessors.push(json.to_owned());
        self.accessors.len() - 1
    }

    /// Adds a buffer view of some bytes, aligned to four.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// The file with its buffer as a data URI; `rest` is all of its JSON but asset, buffers and accessors.
    pub fn gltf(&self, rest: &str) -> String {
        let uri = format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&self.bytes));
        self.json(rest, &uri)
    }

    /// The file with its buffer as a binary chunk.
    pub fn glb(&self, rest: &str) -> Vec<u8> {
        let mut json = self.json(rest, "").into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.bytes.len();
        let word = |value: usize| u32::try_from(value).expect("a small file").to_le_bytes();
        let header = [b"glTF".to_vec(), word(2).to_vec(), word(length).to_vec()].concat();
        let chunk = |kind: &[u8; 4], bytes: &[u8]| [&word(bytes.len()), kind.as_slice(), bytes].concat();
        [header, chunk(b"JSON", &json), chunk(b"BIN\0", &self.bytes)].concat()
    }

    fn json(&self, rest: &str, uri: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}{uri}}}],"bufferViews":[{}],"accessors":[{}],{rest}}}"#,
            self.bytes.len(),
            self.views.join(","),
            self.accessors.join(",")
        )
    }
}

fn components(kind: &str) -> usize {
    let vectors = ["SCALAR", "VEC2", "VEC3", "VEC4"];
    vectors.iter().position(|vector| *vector == kind).map_or(16, |index| index + 1)
}

/// One triangle in the xy plane that faces +z, with indices: accessors 0 (positions) and 1 (indices).
pub fn triangle() -> Builder {
    let mut builder = Builder::default();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    builder.shorts("SCALAR", &[0, 1, 2]);
    builder
}

/// JSON of a scene with one node for a mesh of the two accessors of [`triangle`].
pub const ONE_MESH: &str = r#""nodes":[{"mesh":0}],"meshes":[{"name":"corner","primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#;

/// Loads a file from its text at a time.
pub fn load(text: &str, time: f32) -> Result<Scene, SceneError> {
    load_bytes("test.gltf", text.as_bytes(), time)
}

/// Loads a file of a name from its bytes at a time.
pub fn load_bytes(name: &str, bytes: &[u8], time: f32) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), name, bytes);
    Scene::load(&folder.path().join(name), time)
}

/// Writes a file into a folder.
pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    fs::write(folder.join(name), bytes).expect("a writable temporary folder");
}

/// Base64 with padding (RFC 4648).
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0usize, |bits, i| bits << 8 | usize::from(chunk.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let code = char::from(DIGITS[bits >> (18 - 6 * digit) & 63]);
            write!(text, "{}", if digit <= chunk.len() { code } else { '=' }).expect("memory");
        }
    }
    text
}

/// A PNG image of RGB texels.
pub fn png(width: u32, height: u32, texels: &[[u8; 3]]) -> Vec<u8> {
    let image = image::RgbImage::from_raw(width, height, texels.concat()).expect("texels of that size");
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG in memory");
    bytes.into_inner()
}
