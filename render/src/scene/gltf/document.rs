//! A glTF file as a whole: its validated JSON and the bytes of its buffers.

use super::super::{SceneError, file};
use super::{check, compressed};
use gltf::{
    Document, Gltf, Semantic,
    json::{Path as JsonPath, Root, validation},
};
use std::path::Path;
use validation::{Checked, Error, Validate};

/// Extensions that a file may require. Unlit materials are drawn as if lit, which that extension allows.
pub(super) const SUPPORTED_EXTENSIONS: [&str; 14] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// A validated glTF file with its buffers.
#[derive(Debug)]
pub(super) struct File<'a> {
    pub path: &'a Path,
    pub document: Document,
    /// The bytes of each buffer, as many as it declares; none of one that is not read.
    pub buffers: Vec<Vec<u8>>,
}

impl<'a> File<'a> {
    /// Reads and validates a file, reads its buffers and decodes what is compressed in them.
    pub fn open(path: &'a Path) -> Result<Self, SceneError> {
        let bytes = file::read(path)?;
        let (root, blob) = parse(&bytes).map_err(|what| SceneError::invalid(path, what))?;
        validate(&root).map_err(|what| SceneError::invalid(path, what))?;
        let document = Document::from_json_without_validation(root);
        let file = Self { path, document, buffers: Vec::new() };
        let buffers = file.read_buffers(blob)?;
        let (root, buffers) = compressed::unpack(file.document.into_json(), buffers)
            .map_err(|what| SceneError::invalid(path, what))?;
        Ok(Self { path, document: Document::from_json_without_validation(root), buffers })
    }

    /// An error about something in this file.
    pub fn invalid(&self, what: impl Into<String>) -> SceneError {
        SceneError::invalid(self.path, what)
    }

    /// The bytes that a URI stands for: a data URI's own, or those of a file beside this one.
    pub fn resource(&self, uri: &str) -> Result<Vec<u8>, SceneError> {
        if uri.starts_with("data:") {
            // What comes before the data would else be taken for them (RFC 2397).
            if !uri.contains(',') {
                return Err(self.invalid("a data URI is damaged: it has no comma"));
            }
            let source = gltf::buffer::Source::Uri(uri);
            let data = gltf::buffer::Data::from_source(source, None);
            return data
                .map(|data| data.0)
                .map_err(|error| self.invalid(format!("a data URI is damaged: {error}")));
        }
        let name = percent_decoded(uri);
        if name.contains("://") || name.starts_with("file:") || name.contains('\0') {
            return Err(self.invalid(format!("`{name}` is not the name of a file beside this one")));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = file::beside(folder, Path::new(""), &name).map_err(|what| self.invalid(what))?;
        file::read(&path)
    }

    /// The bytes of all buffers. `blob` is the binary chunk of a .glb file, which a first buffer without URI
    /// stands for.
    fn read_buffers(&self, mut blob: Option<Vec<u8>>) -> Result<Vec<Vec<u8>>, SceneError> {
        let root = self.document.as_json();
        let unread = compressed::unread(root).map_err(|what| self.invalid(what))?;
        root.buffers
            .iter()
            .enumerate()
            .map(|(index, buffer)| {
                if unread[index] {
                    return Ok(Vec::new());
                }
                let mut bytes = match &buffer.uri {
                    Some(uri) => self.resource(uri)?,
                    None if index == 0 => blob
                        .take()
                        .ok_or_else(|| self.invalid("buffer 0 has no URI, and there is no binary chunk"))?,
                    None => return Err(self.invalid(format!("buffer {index} has no URI"))),
                };
                let declared = buffer.byte_length.0 as usize;
                if bytes.len() < declared {
                    let found = bytes.len();
                    return Err(self.invalid(format!(
                        "buffer {index} is truncated: {found} bytes where {declared} are declared"
                    )));
                }
                bytes.truncate(declared);
                Ok(bytes)
            })
            .collect()
    }
}

/// The JSON of a .gltf or .glb file, and the binary chunk of the latter.
fn parse(bytes: &[u8]) -> Result<(Root, Option<Vec<u8>>), String> {
    // The parser subtracts the header's 12 bytes from this length without a look at it.
    let declared =
        bytes.get(8..12).map_or(0, |length| u32::from_le_bytes([length[0], length[1], length[2], length[3]]));
    if bytes.starts_with(b"glTF") && declared < 12 {
        return Err("the binary glTF header is damaged".to_owned());
    }
    check::chunks(bytes)?;
    let gltf =
        Gltf::from_slice_without_validation(bytes).map_err(|error| format!("is not glTF 2.0: {error}"))?;
    Ok((gltf.document.into_json(), gltf.blob))
}

/// Checks that all indices are in range, all names known, and all required extensions supported.
fn validate(root: &Root) -> Result<(), String> {
    let needs = root.asset.min_version.as_deref().unwrap_or("2.0");
    if !root.asset.version.starts_with("2.") || needs != "2.0" {
        return Err(format!("is glTF {} and needs {needs}; 2.0 is supported", root.asset.version));
    }
    let unknown = root.extensions_required.iter().find(|name| !SUPPORTED_EXTENSIONS.contains(&name.as_str()));
    if let Some(name) = unknown {
        return Err(format!("requires the extension {name}, which is not supported"));
    }
    validate_positions(root)?;
    validate_channels(root)?;
    let mut problem = None;
    root.validate(root, JsonPath::new, &mut |path: &dyn Fn() -> JsonPath, error| {
        let path = path().0;
        // Extensions were checked above, nothing here reads the declared bounds of positions, an accessor
        // without a buffer view holds zeros (3.6.2.1), which the validator does not know, primitives without
        // positions are left out (3.7.2.1), and so are textures without a source (3.8.2).
        let zeros =
            path.starts_with("accessors[") && path.ends_with("].bufferView") && error == Error::Missing;
        let unplaced = path.ends_with("attributes[\"POSITION\"]") && error == Error::Missing;
        let imageless =
            path.starts_with("textures[") && path.ends_with("].source") && error == Error::Missing;
        let harmless = zeros
            || unplaced
            || imageless
            || error == Error::Unsupported
            || path.ends_with(".min")
            || path.ends_with(".max");
        if !harmless && problem.is_none() {
            problem = Some(format!("{path}: {error}"));
        }
    });
    problem.map_or_else(|| check::structure(root), Err)
}

/// Checks the accessors of positions, which the validator reads before it checks them.
fn validate_positions(root: &Root) -> Result<(), String> {
    for (index, mesh) in root.meshes.iter().enumerate() {
        for primitive in &mesh.primitives {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(accessor) = position.filter(|accessor| accessor.value() >= root.accessors.len()) {
                return Err(format!("mesh {index}: there is no accessor {accessor} for its positions"));
            }
        }
    }
    Ok(())
}

/// Checks the targets of animation channels, which the validator leaves out.
fn validate_channels(root: &Root) -> Result<(), String> {
    for (index, animation) in root.animations.iter().enumerate() {
        for (channel, target) in animation.channels.iter().map(|channel| &channel.target).enumerate() {
            if target.node.value() >= root.nodes.len() || target.path == Checked::Invalid {
                return Err(format!("animation {index}: channel {channel} moves what is not there"));
            }
        }
    }
    Ok(())
}

/// `%20` and its like replaced by what they stand for; text that is not well-formed stays as it is.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail.get(..2).filter(|_| first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        let code = hex.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(code.unwrap_or(first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_codes_are_decoded() {
        assert_eq!(percent_decoded("Box%20With%20Spaces.bin"), "Box With Spaces.bin");
        assert_eq!(percent_decoded("100%.bin"), "100%.bin");
        assert_eq!(percent_decoded("%C3%A9.png"), "é.png");
        assert_eq!(percent_decoded("%FF.png"), "%FF.png");
    }
}
