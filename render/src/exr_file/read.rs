//! Reading, also what other programs wrote or damaged.

use super::image::{Channel, ExrImage, Values};
use super::plain::{self, PartContents};
use super::windows::{Window, Windows};
use super::{ExrError, Metadata, blocks, check, names};
use deepshade_shaders::{Attribute, Planes};
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, Vec2};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// Whether a channel of some name is to be read.
type Wants<'a> = &'a dyn Fn(&str) -> bool;

/// Reads all channels of a file at full resolution. Deep parts and subsampled channels are named and not
/// read.
///
/// # Errors
/// If the file is missing, damaged, truncated or absurdly large.
pub fn read(path: &Path) -> Result<ExrImage, ExrError> {
    read_where(path, None, &|_| true)
}

/// Reads the channels that may be those of some attributes, and no others. What a file holds beside them
/// does not matter, however large it is. Of several layers, such as a scene's view layers or the two views
/// of a stereo image, one may be chosen by its name, which is then left out of the channels' names.
///
/// # Errors
/// If the file is missing, damaged, truncated, absurdly large in what is wanted, or has no layer of that
/// name.
pub fn read_gbuffer(
    path: &Path,
    attributes: &[Attribute],
    layer: Option<&str>,
) -> Result<ExrImage, ExrError> {
    read_where(path, layer, &|name| names::may_be_of(name, attributes))
}

/// Reads a file's one picture, `[3, height, width]`, as large as its display window and black where its data
/// window does not reach: channels `R`, `G` and `B`, or else `Y` three times. Says where both windows lie.
///
/// # Errors
/// If it has neither, or as [`read`].
pub fn read_colour(path: &Path) -> Result<(Planes, Windows), ExrError> {
    read_where(path, None, &names::may_be_colour)?.colour()
}

fn read_where(path: &Path, layer: Option<&str>, wants: Wants<'_>) -> Result<ExrImage, ExrError> {
    let mut file = File::open(path).map_err(|source| ExrError::io(path, source))?;
    let bytes = file.metadata().map_err(|source| ExrError::io(path, source))?.len();
    let (plain, truly) = plain::described(&mut file).map_err(|source| ExrError::io(path, source))?;
    let from_exr = |error| ExrError::from_exr(path, error);
    let reader = exr::block::read(BufReader::new(plain), false).map_err(from_exr)?;
    let headers = true_headers(reader.headers(), &truly);
    let mut image = promised(path, &headers, &truly, layer, wants);
    if let Some(layer) = layer.filter(|_| image.channels.is_empty()) {
        let held = all_names(&headers).join(", ");
        return Err(ExrError::MissingLayer { path: path.to_owned(), layer: layer.to_owned(), held });
    }
    let mut planes = image.wanted(&headers);
    let counts: Vec<usize> = planes.iter().map(|part| part.iter().flatten().count()).collect();
    check::headers(&headers, &counts, bytes).map_err(|what| ExrError::invalid(path, what))?;
    let sizes: Vec<usize> = headers.iter().map(|header| header.layer_size.area()).collect();
    for (part, size) in planes.iter_mut().zip(sizes) {
        part.iter_mut().flatten().for_each(|plane| plane.resize(size, 0.0));
    }
    fill(reader, &headers, &mut planes).map_err(from_exr)?;
    image.fill(planes);
    Ok(image)
}

/// Headers with the sampling that their channels truly have.
fn true_headers(headers: &[Header], truly: &[PartContents]) -> Vec<Header> {
    let mut headers = headers.to_vec();
    for (header, part) in headers.iter_mut().zip(truly) {
        let channels = header.channels.list.iter_mut().zip(&part.sampling);
        channels.for_each(|(channel, sampling)| channel.sampling = *sampling);
    }
    headers
}

/// Reads the blocks of parts of which a channel is wanted.
fn fill(
    reader: exr::block::reader::Reader<impl Read + Seek>,
    headers: &[Header],
    planes: &mut [Vec<Option<Vec<f32>>>],
) -> exr::error::Result<()> {
    let wanted: Vec<bool> = planes.iter().map(|part| part.iter().any(Option::is_some)).collect();
    let meta = reader.meta_data().clone();
    let is_whole = |level: Vec2<usize>| level == Vec2(0, 0);
    let chunks = reader.filter_chunks(false, |_, tile, block| {
        wanted.get(block.layer).copied().unwrap_or(false) && is_whole(tile.level_index)
    })?;
    for chunk in chunks {
        let block = blocks::unpacked(chunk?, &meta, headers)?;
        let part = block.index.layer;
        // A damaged table of offsets may lead to a chunk of another part or level.
        if let (Some(header), Some(planes), true) =
            (headers.get(part), planes.get_mut(part), is_whole(block.index.level))
        {
            blocks::put(&block, header, planes)?;
        }
    }
    Ok(())
}

/// What a file holds by its headers, before any value is read.
fn promised(
    path: &Path,
    headers: &[Header],
    truly: &[PartContents],
    layer: Option<&str>,
    wants: Wants<'_>,
) -> ExrImage {
    let display = headers.first().map(|header| header.shared_attributes.display_window);
    let mut image = ExrImage {
        path: path.to_owned(),
        display: display.map_or(Window::of_size(0, 0), window),
        parts: headers.iter().map(|header| window(header.data_window())).collect(),
        names: Vec::new(),
        channels: Vec::new(),
        metadata: Metadata::new(),
        world_to_camera: None,
    };
    for (part, header) in headers.iter().enumerate() {
        let own = &header.own_attributes;
        image.metadata.extend(texts(&header.shared_attributes.other));
        image.metadata.extend(texts(&own.other));
        image.metadata.extend(own.software_name.iter().map(|name| ("software".to_owned(), name.to_string())));
        image.world_to_camera = image.world_to_camera.or(own.world_to_camera);
        for (index, channel) in header.channels.list.iter().enumerate() {
            let Some(name) = name(header, index, layer) else { continue };
            let values = match channel.sampling.area() {
                _ if truly.get(part).is_some_and(|part| part.deep) => Values::Deep,
                1 if wants(&name) => Values::Read(Vec::new()),
                1 => Values::Left,
                _ => Values::Subsampled,
            };
            image.names.push(name);
            image.channels.push(Channel { part, index, values });
        }
    }
    image
}

/// A channel's name with its part's before it, without the name of a layer that was chosen; none if it is of
/// another one.
fn name(header: &Header, index: usize, layer: Option<&str>) -> Option<String> {
    let own = &header.own_attributes;
    let part = own.layer_name.as_ref().map(|part| format!("{part}.")).unwrap_or_default();
    let name = format!("{part}{}", header.channels.list[index].name);
    let Some(layer) = layer else { return Some(name) };
    let is_view = own.view_name.as_ref().is_some_and(|view| view.to_string().eq_ignore_ascii_case(layer));
    names::within_layer(&name, layer).or_else(|| is_view.then_some(name))
}

/// Names of all channels, whatever their layer.
fn all_names(headers: &[Header]) -> Vec<String> {
    let of_part = |header: &Header| -> Vec<String> {
        (0..header.channels.list.len()).filter_map(|index| name(header, index, None)).collect()
    };
    headers.iter().flat_map(of_part).collect()
}

fn window(bounds: IntegerBounds) -> Window {
    let IntegerBounds { position, size } = bounds;
    Window { left: position.x(), top: position.y(), width: size.width(), height: size.height() }
}

/// Those attributes of a file that are text or numbers, as text.
fn texts<'a, Name: ToString + 'a>(
    attributes: impl IntoIterator<Item = (&'a Name, &'a AttributeValue)>,
) -> Metadata {
    let text = |value: &AttributeValue| match value {
        AttributeValue::Text(value) => Some(value.to_string()),
        AttributeValue::F32(value) => Some(value.to_string()),
        AttributeValue::F64(value) => Some(value.to_string()),
        AttributeValue::I32(value) => Some(value.to_string()),
        _ => None,
    };
    let named = |(name, value): (&Name, &AttributeValue)| Some((name.to_string(), text(value)?));
    attributes.into_iter().filter_map(named).collect()
}
