//! Writing.

use super::windows::{Window, Windows};
use super::{ExrError, Metadata, PROGRAM};
use deepshade_shaders::atomic_file;
use deepshade_shaders::{GBuffer, Planes};
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::ImageAttributes;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image, LayerAttributes,
    LineOrder, Text, Vec2, WritableImage, f16,
};
use std::io::Cursor;
use std::path::Path;

/// Lossless, and of the lossless kinds the one with the smallest files; `compression` in the tests prints the
/// comparison.
pub(super) const COMPRESSION: Compression = Compression::ZIP16;

/// Some planes with the names of their channels. Values are written as half floats, and where a channel has
/// one that is too large for them, as 32-bit floats.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    names: Vec<String>,
    planes: &'a Planes,
    /// Whether values are written as 32-bit floats.
    full: bool,
}

impl<'a> Layer<'a> {
    /// All attributes of a g-buffer.
    pub fn gbuffer(gbuffer: &'a GBuffer) -> Self {
        let channels = gbuffer.attributes().iter().flat_map(|attribute| attribute.channels());
        Self {
            names: channels.map(|channel| channel.to_string()).collect(),
            planes: gbuffer.planes(),
            full: false,
        }
    }

    /// An image: one plane has the layer's name, three are red, green and blue.
    ///
    /// # Panics
    /// If there is another number of planes.
    pub fn image(name: &str, planes: &'a Planes) -> Self {
        Self { names: image_names(name, planes.channels()), planes, full: false }
    }

    /// The same layer with all its digits, in 32-bit floats: for what half floats round to 0, such as
    /// variances.
    #[must_use]
    pub fn in_full(self) -> Self {
        Self { full: true, ..self }
    }
}

/// Channel names of an image of one or three planes.
pub(super) fn image_names(name: &str, channels: usize) -> Vec<String> {
    match channels {
        1 => vec![name.to_owned()],
        3 => ["R", "G", "B"].iter().map(|component| format!("{name}.{component}")).collect(),
        other => unreachable!("an image has one or three channels, not {other}"),
    }
}

/// Writes a file of some layers of one size, so that the name never stands for half a file.
///
/// # Errors
/// If a value is not finite, or the file cannot be written.
///
/// # Panics
/// If there is no layer or the layers differ in size.
pub fn write(path: &Path, layers: &[Layer<'_>], metadata: &Metadata) -> Result<(), ExrError> {
    let bytes = encode(path, layers, metadata)?;
    atomic_file::write(path, &bytes).map_err(|source| ExrError::io(path, source))
}

/// As [`write()`], of layers whose pixels lie somewhere in a frame.
///
/// # Errors
/// As [`write()`].
///
/// # Panics
/// As [`write()`], and if the layers are not of the data window's size.
pub fn write_within(
    path: &Path,
    layers: &[Layer<'_>],
    metadata: &Metadata,
    windows: &Windows,
) -> Result<(), ExrError> {
    let bytes = encode_with(path, layers, metadata, windows, COMPRESSION)?;
    atomic_file::write(path, &bytes).map_err(|source| ExrError::io(path, source))
}

/// The bytes of a file: the same for the same layers and metadata. `path` is only named in errors.
///
/// # Errors
/// If a value is not finite.
///
/// # Panics
/// If there is no layer or the layers differ in size.
pub fn encode(path: &Path, layers: &[Layer<'_>], metadata: &Metadata) -> Result<Vec<u8>, ExrError> {
    let windows = Windows::of(layers[0].planes);
    encode_with(path, layers, metadata, &windows, COMPRESSION)
}

/// [`encode`] with any windows and compression.
pub(super) fn encode_with(
    path: &Path,
    layers: &[Layer<'_>],
    metadata: &Metadata,
    windows: &Windows,
    compression: Compression,
) -> Result<Vec<u8>, ExrError> {
    let size = (windows.data.width, windows.data.height);
    let is_of_size = |layer: &Layer<'_>| (layer.planes.width(), layer.planes.height()) == size;
    assert!(layers.iter().all(is_of_size), "layers of one size");
    let mut channels = Vec::new();
    for layer in layers {
        for (index, name) in layer.names.iter().enumerate() {
            let plane = layer.planes.plane(index);
            channels.push(AnyChannel::new(name.as_str(), samples(path, name, plane, layer.full)?));
        }
    }
    let encoding =
        Encoding { compression, blocks: exr::prelude::Blocks::ScanLines, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort(channels.into());
    let layer = exr::prelude::Layer::new(size, attributes(metadata, windows.data), encoding, channels);
    let image = Image { attributes: ImageAttributes::new(bounds(windows.display)), layer_data: layer };
    let mut bytes = Vec::new();
    // One thread: images are written side by side, and each would start a pool of its own.
    let written = image.write().non_parallel().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|error| ExrError::from_exr(path, error))?;
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Values as half floats, or in full where that is asked for or one of them is too large for a half float.
fn samples(path: &Path, channel: &str, plane: &[f32], full: bool) -> Result<FlatSamples, ExrError> {
    if full {
        return Ok(FlatSamples::F32(plane.to_vec()));
    }
    if let Some(value) = plane.iter().copied().find(|value| !value.is_finite()) {
        return Err(ExrError::NotHalf { path: path.to_owned(), channel: channel.to_owned(), value });
    }
    let halves: Vec<f16> = plane.iter().map(|value| f16::from_f32(*value)).collect();
    // The largest half float is no distance: it stands for "no surface".
    let is_held =
        |(half, value): (&f16, &f32)| half.to_f32().abs() < f16::MAX.to_f32() || half.to_f32() == *value;
    Ok(match halves.iter().zip(plane).all(is_held) {
        true => FlatSamples::F16(halves),
        false => FlatSamples::F32(plane.to_vec()),
    })
}

fn bounds(window: Window) -> IntegerBounds {
    IntegerBounds::new(Vec2(window.left, window.top), Vec2(window.width, window.height))
}

fn attributes(metadata: &Metadata, data: Window) -> LayerAttributes {
    LayerAttributes {
        layer_position: bounds(data).position,
        software_name: Some(text(PROGRAM)),
        other: metadata.iter().map(|(name, value)| (text(name), AttributeValue::Text(text(value)))).collect(),
        ..LayerAttributes::default()
    }
}

/// EXR text is one byte a character, so that characters above U+00FF are written as `\u{20ac}`.
fn text(value: &str) -> Text {
    let mut narrow = String::with_capacity(value.len());
    for character in value.chars() {
        match u8::try_from(character) {
            Ok(_) => narrow.push(character),
            Err(_) => narrow.extend(character.escape_unicode()),
        }
    }
    Text::new_or_panic(narrow)
}

/// Puts the attributes of a file's only header into the order of their names. The crate `exr` writes them in
/// the random order of a hash map, and the same image must give the same bytes. No offset changes.
fn sort_attributes(file: &mut [u8]) {
    const MAGIC_AND_VERSION: usize = 8;
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while file[at] != 0 {
        let length = attribute_length(&file[at..]);
        attributes.push(file[at..at + length].to_vec());
        at += length;
    }
    attributes.sort();
    file[MAGIC_AND_VERSION..at].copy_from_slice(&attributes.concat());
}

/// Bytes of an attribute: name, zero, type, zero, size of the value, value.
fn attribute_length(bytes: &[u8]) -> usize {
    let text_end = |from: usize| {
        let zero = bytes[from..].iter().position(|byte| *byte == 0);
        from + zero.expect("a header that was just written has terminated names") + 1
    };
    let size_at = text_end(text_end(0));
    let size: [u8; 4] = std::array::from_fn(|i| bytes[size_at + i]);
    size_at + 4 + u32::from_le_bytes(size) as usize
}
