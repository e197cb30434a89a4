//! Reading, also what other programs wrote or damaged.

use super::{ExrError, Metadata, names};
use deepshade_shaders::{Attribute, Channel, GBuffer, Planes};
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, FlatImage, FlatSamples, Layer, ReadChannels, ReadLayers,
};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// The most pixels along an edge.
const MAX_EDGE: usize = 32_768;

/// The most values of all channels together: 1 GiB of f32.
const MAX_VALUES: usize = 1 << 28;

/// The most bytes of a block of pixels, which readers take memory for before they have read it.
const MAX_BLOCK: usize = 1 << 28;

/// An EXR file in memory.
#[derive(Clone, Debug)]
pub struct ExrImage {
    path: PathBuf,
    height: usize,
    width: usize,
    pub(super) names: Vec<String>,
    planes: Vec<Vec<f32>>,
    metadata: Metadata,
}

/// Reads all channels of a file at full resolution.
///
/// # Errors
/// If the file is missing, damaged, truncated, absurdly large, deep, or its parts differ in size.
pub fn read(path: &Path) -> Result<ExrImage, ExrError> {
    let file = File::open(path).map_err(|source| ExrError::io(path, source))?;
    let bytes = file.metadata().map_err(|source| ExrError::io(path, source))?.len();
    let from_exr = |error| ExrError::from_exr(path, error);
    let reader = exr::block::read(BufReader::new(file), false).map_err(from_exr)?;
    check_headers(reader.headers(), bytes).map_err(|what| ExrError::invalid(path, what))?;
    let everything =
        exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let image = everything.all_attributes().non_parallel().from_chunks(reader).map_err(from_exr)?;
    ExrImage::new(path, image)
}

/// The most that a byte of a compressed file stands for: DEFLATE repeats 258 bytes with two bits, and nothing else repeats more.
const MAX_RATIO: usize = 1032;

/// Whether what the headers promise is sane, before memory is taken for it.
fn check_headers(headers: &[Header], file_bytes: u64) -> Result<(), String> {
    let (mut values, mut bytes) = (0usize, 0usize);
    for header in headers {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        if header.layer_size != headers[0].layer_size {
            return Err("its parts differ in size".to_owned());
        }
        if width == 0 || height == 0 || width > MAX_EDGE || height > MAX_EDGE {
            return Err(format!("{width} x {height} pixels, where 1 to {MAX_EDGE} an edge are accepted"));
        }
        if header.deep {
            return Err("deep data is not supported".to_owned());
        }
        if let Some(channel) = header.channels.list.iter().find(|c| c.sampling.area() != 1) {
            return Err(format!("channel `{}` is subsampled", channel.name));
        }
        // Every chunk has eight bytes in the offset table.
        if header.chunk_count as u64 * 8 > file_bytes {
            return Err(format!("{} chunks in {file_bytes} bytes", header.chunk_count));
        }
        let block = block_bytes(header);
        if block > MAX_BLOCK {
            return Err(format!("its blocks are of {block} bytes, where at most {MAX_BLOCK} are accepted"));
        }
        values = values.saturating_add((width * height).saturating_mul(header.channels.list.len()));
        bytes = bytes.saturating_add((width * height).saturating_mul(header.channels.bytes_per_pixel));
    }
    if bytes as u64 > file_bytes.saturating_mul(MAX_RATIO as u64) {
        return Err(format!("it promises {bytes} bytes of values in {file_bytes}"));
    }
    if values > MAX_VALUES {
        return Err(format!("{values} values, where at most {MAX_VALUES} are accepted"));
    }
    Ok(())
}

/// Bytes of a block of pixels: of a tile, whatever the image's size, or of some rows.
fn block_bytes(header: &Header) -> usize {
    let pixels = match header.blocks {
        BlockDescription::Tiles(tiles) => tiles.tile_size.width().saturating_mul(tiles.tile_size.height()),
        BlockDescription::ScanLines => header.compression.scan_lines_per_block() * header.layer_size.width(),
    };
    pixels.saturating_mul(header.channels.bytes_per_pixel)
}

impl ExrImage {
    fn new(path: &Path, image: FlatImage) -> Result<Self, ExrError> {
        let FlatImage { attributes, layer_data } = image;
        let size = layer_data.first().map(|layer| layer.size);
        let size = size.ok_or_else(|| ExrError::invalid(path, "it has no part"))?;
        let mut read = Self {
            path: path.to_owned(),
            height: size.height(),
            width: size.width(),
            names: Vec::new(),
            planes: Vec::new(),
            metadata: texts(attributes.other),
        };
        for layer in layer_data {
            read.add(layer);
        }
        Ok(read)
    }

    fn add(&mut self, layer: Layer<AnyChannels<FlatSamples>>) {
        let part = layer.attributes.layer_name.map(|name| format!("{name}.")).unwrap_or_default();
        for AnyChannel { name, sample_data, .. } in layer.channel_data.list {
            self.names.push(format!("{part}{name}"));
            self.planes.push(match sample_data {
                FlatSamples::F16(values) => values.into_iter().map(f32::from).collect(),
                FlatSamples::F32(values) => values,
                FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
            });
        }
        self.metadata.extend(texts(layer.attributes.other));
        self.metadata
            .extend(layer.attributes.software_name.map(|name| ("software".to_owned(), name.to_string())));
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Columns.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Text attributes.
    pub const fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The attributes of which all channels are there.
    pub fn attributes(&self) -> Vec<Attribute> {
        let whole =
            |attribute: &Attribute| attribute.channels().all(|c| names::find(&self.names, c).is_some());
        Attribute::ALL.into_iter().filter(whole).collect()
    }

    /// Some attributes as a g-buffer. A pixel where one of them is not finite counts as one where nothing is seen,
    /// which some renderers mark by an infinite depth: all its channels become 0.
    ///
    /// # Errors
    /// If one of them lacks a channel.
    pub fn gbuffer(&self, attributes: &[Attribute]) -> Result<GBuffer, ExrError> {
        let channels: Vec<Channel> = attributes.iter().flat_map(|attribute| attribute.channels()).collect();
        let found = channels.iter().map(|channel| (channel.to_string(), names::find(&self.names, *channel)));
        let mut planes = self.gathered(found.collect())?;
        clear_pixels_that_are_not_finite(&mut planes);
        Ok(GBuffer::new(attributes.to_vec(), planes))
    }

    /// An image of one or three channels by its layer's name, such as `target.ao`.
    ///
    /// # Errors
    /// If one of its channels is not there.
    ///
    /// # Panics
    /// If it is to have another number of channels.
    pub fn image(&self, name: &str, channels: usize) -> Result<Planes, ExrError> {
        let wanted = super::write::image_names(name, channels).into_iter();
        self.gathered(wanted.map(|name| (name.clone(), names::find_name(&self.names, &name))).collect())
    }

    /// The file's one picture, `[3, height, width]`: channels `R`, `G` and `B`, or else `Y` three times.
    ///
    /// # Errors
    /// If it has neither.
    pub fn colour(&self) -> Result<Planes, ExrError> {
        let found = |name: &str| (name.to_owned(), names::find_name(&self.names, name));
        let colours = ["R", "G", "B"].map(found);
        match found("Y") {
            grey @ (_, Some(_)) if colours.iter().any(|(_, index)| index.is_none()) => {
                self.gathered(vec![grey; 3])
            }
            _ => self.gathered(colours.to_vec()),
        }
    }

    /// Planes by index, or an error that names those that were not found.
    pub(super) fn gathered(&self, found: Vec<(String, Option<usize>)>) -> Result<Planes, ExrError> {
        let missing: Vec<String> =
            found.iter().filter(|(_, index)| index.is_none()).map(|(name, _)| format!("`{name}`")).collect();
        if !missing.is_empty() {
            return Err(ExrError::MissingChannels {
                path: self.path.clone(),
                missing: missing.join(", "),
                held: if self.names.is_empty() { "none".to_owned() } else { self.names.join(", ") },
            });
        }
        let planes = found.iter().filter_map(|(_, index)| *index).flat_map(|index| &self.planes[index]);
        Ok(Planes::from_data(found.len(), self.height, self.width, planes.copied().collect()))
    }
}

fn clear_pixels_that_are_not_finite(planes: &mut Planes) {
    let pixels = planes.pixels();
    let finite =
        |planes: &Planes, pixel: usize| (0..planes.channels()).all(|c| planes.plane(c)[pixel].is_finite());
    let cleared: Vec<usize> = (0..pixels).filter(|pixel| !finite(planes, *pixel)).collect();
    for channel in 0..planes.channels() {
        for pixel in &cleared {
            planes.plane_mut(channel)[*pixel] = 0.0;
        }
    }
}

/// Those attributes of a file that are text.
fn texts<Name: ToString>(attributes: impl IntoIterator<Item = (Name, AttributeValue)>) -> Metadata {
    let text = |(name, value): (Name, AttributeValue)| match value {
        AttributeValue::Text(value) => Some((name.to_string(), value.to_string())),
        _ => None,
    };
    attributes.into_iter().filter_map(text).collect()
}
