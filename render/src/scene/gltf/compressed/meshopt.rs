//! Buffer views compressed by EXT_meshopt_compression, and by KHR_meshopt_compression, which has a filter and
//! a version of the coding more.

use super::Unpacking;
use gltf::json::{Root, buffer::View};
use meshoptimizer_rs::{Error, Limits, Workspace, codec};
use serde::Deserialize;

const EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Where the bytes of a view are, and what they become: `count` elements of `byte_stride` bytes.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Packed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: Mode,
    #[serde(default)]
    filter: Filter,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

/// Which buffers are not read. Where views are compressed, some only stand for what those decode to, and may
/// be without a URI.
pub(in crate::scene::gltf) fn unread(root: &Root) -> Result<Vec<bool>, String> {
    let packed = root.buffer_views.iter().enumerate().map(|(index, view)| packed(index, view));
    let packed: Vec<_> = packed.collect::<Result<_, _>>()?;
    let mut unread = vec![packed.iter().any(Option::is_some); root.buffers.len()];
    for (view, packed) in root.buffer_views.iter().zip(packed) {
        let read = packed.map_or(view.buffer.value(), |packed| packed.buffer);
        if let Some(unread) = unread.get_mut(read) {
            *unread = false;
        }
    }
    Ok(unread)
}

/// Decodes all compressed views, each into a buffer of its own.
pub(super) fn unpack(unpacking: &mut Unpacking) -> Result<(), String> {
    for index in 0..unpacking.root.buffer_views.len() {
        let view = &unpacking.root.buffer_views[index];
        let Some(packed) = packed(index, view)? else { continue };
        let length = view.byte_length.0;
        let bytes = unpacked(unpacking, &packed, length)
            .map_err(|what| format!("bufferViews[{index}], compressed: {what}"))?;
        let buffer = unpacking.add_buffer(bytes);
        let view = &mut unpacking.root.buffer_views[index];
        (view.buffer, view.byte_offset) = (buffer, None);
    }
    Ok(())
}

/// What the extension says of a view, if it has it.
fn packed(index: usize, view: &View) -> Result<Option<Packed>, String> {
    let said = view.extensions.as_ref().map(|extensions| &extensions.others);
    let said = said.and_then(|said| EXTENSIONS.iter().find_map(|name| Some((name, said.get(*name)?))));
    let packed = said.map(|(name, value)| {
        Packed::deserialize(value).map_err(|error| format!("bufferViews[{index}]: {name}: {error}"))
    });
    packed.transpose()
}

/// The bytes of a view of a length.
fn unpacked(unpacking: &mut Unpacking, packed: &Packed, length: u64) -> Result<Vec<u8>, String> {
    let Packed { buffer, byte_offset, byte_length, byte_stride, count, .. } = *packed;
    let whole = count.checked_mul(byte_stride).filter(|whole| *whole as u64 == length);
    let whole =
        whole.ok_or_else(|| format!("{count} elements of {byte_stride} bytes in a view of {length}"))?;
    if packed.filter != Filter::None && packed.mode != Mode::Attributes {
        return Err(format!("the filter {:?} for {:?}", packed.filter, packed.mode));
    }
    unpacking.take(whole)?;
    let bytes = unpacking.bytes(buffer, byte_offset, byte_length)?;
    decoded(bytes, packed).map_err(|error| error.to_string())
}

/// What compressed bytes become. How many these are was counted.
fn decoded(bytes: &[u8], packed: &Packed) -> Result<Vec<u8>, Error> {
    let (count, size) = (packed.count, packed.byte_stride);
    let mut work = Workspace::new(Limits { max_bytes: usize::MAX, max_work: u64::MAX });
    let mut bytes = match packed.mode {
        Mode::Attributes => codec::decode_vertex_buffer(count, size, bytes, &mut work),
        Mode::Triangles => codec::decode_index_buffer(count, size, bytes, &mut work),
        Mode::Indices => codec::decode_index_sequence(count, size, bytes, &mut work),
    }?;
    match packed.filter {
        Filter::None => Ok(()),
        Filter::Octahedral => codec::decode_filter_oct(&mut bytes, count, size, &mut work),
        Filter::Quaternion => codec::decode_filter_quat(&mut bytes, count, size, &mut work),
        Filter::Exponential => codec::decode_filter_exp(&mut bytes, count, size, &mut work),
        Filter::Color => codec::decode_filter_color(&mut bytes, count, size, &mut work),
    }?;
    Ok(bytes)
}
