//! Blocks of pixels, and what of them belongs to the channels that are wanted.

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::error::{Error, Result};
use exr::meta::MetaData;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};

/// A chunk's values, by what its part truly is, which `exr` was not told of parts with subsampled channels.
pub fn unpacked(chunk: Chunk, meta: &MetaData, headers: &[Header]) -> Result<UncompressedBlock> {
    let header = headers.get(chunk.layer_index).ok_or_else(|| Error::Invalid("chunk layer index".into()))?;
    if header.channels.list.iter().all(|channel| channel.sampling.area() == 1) {
        return UncompressedBlock::decompress_chunk(chunk, meta, false);
    }
    let tile = header.get_block_data_indices(&chunk.compressed_block)?;
    let section = header.get_absolute_block_pixel_coordinates(tile)?;
    section.validate(Some(header.layer_size))?;
    let index = exr::block::BlockIndex {
        layer: chunk.layer_index,
        pixel_position: section.position.to_usize("block")?,
        pixel_size: section.size,
        level: tile.level_index,
    };
    let CompressedBlock::ScanLine(block) = chunk.compressed_block else {
        return Err(Error::Invalid("only scan lines may be subsampled".into()));
    };
    let (header, section) = as_bytes(header, section)?;
    let bytes = block.compressed_pixels_le;
    let data = header.compression.decompress_image_section_from_le(&header, bytes, section, false)?;
    Ok(UncompressedBlock { index, data })
}

/// A header and a section of it that make `exr` expect as many bytes as the section truly has.
fn as_bytes(header: &Header, section: IntegerBounds) -> Result<(Header, IntegerBounds)> {
    let bytes: usize = (0..section.size.height())
        .map(|row| {
            let of_row =
                |channel| samples(header, channel, section.position.y() as usize + row, section.size);
            header.channels.list.iter().map(|channel| of_row(channel) * bytes_of(channel)).sum::<usize>()
        })
        .sum();
    let mut header = header.clone();
    match header.compression {
        // These do not look at what the bytes mean.
        Compression::Uncompressed | Compression::RLE | Compression::ZIP1 | Compression::ZIP16 => {
            header.channels.bytes_per_pixel = 1;
            header.layer_size = Vec2(bytes, 1);
            Ok((header, IntegerBounds::new(Vec2(0, 0), Vec2(bytes, 1))))
        }
        // The others do, and know of subsampling. Only the sum of the bytes is not right.
        _ if bytes.is_multiple_of(section.size.area()) => {
            header.channels.bytes_per_pixel = bytes / section.size.area();
            Ok((header, section))
        }
        other => Err(Error::NotSupported(format!("subsampled channels in the compression {other}").into())),
    }
}

/// How many values a channel has in a row of the data window, of blocks as wide as the window where it is
/// subsampled: those whose column and row, counted from the origin, are multiples of the sampling.
fn samples(header: &Header, channel: &ChannelDescription, row: usize, size: Vec2<usize>) -> usize {
    let Vec2(across, down) = channel.sampling;
    if (across, down) == (1, 1) {
        return size.width();
    }
    let position = header.own_attributes.layer_position;
    let (left, y) = (i64::from(position.x()), i64::from(position.y()) + row as i64);
    let below = |x: i64| (x - 1).div_euclid(across as i64);
    let count = below(left + size.width() as i64) - below(left);
    if y.rem_euclid(down as i64) == 0 { count as usize } else { 0 }
}

fn bytes_of(channel: &ChannelDescription) -> usize {
    channel.sample_type.bytes_per_sample()
}

/// Puts a block's values into the planes of the channels that are wanted, which are of full resolution.
///
/// # Errors
/// If the block has fewer values than its header says.
pub fn put(block: &UncompressedBlock, header: &Header, planes: &mut [Option<Vec<f32>>]) -> Result<()> {
    let (position, size) = (block.index.pixel_position, block.index.pixel_size);
    let mut rest = &block.data[..];
    for row in position.y()..position.y() + size.height() {
        let start = row * header.layer_size.width() + position.x();
        for (channel, plane) in header.channels.list.iter().zip(&mut *planes) {
            let count = samples(header, channel, row, size);
            let line = rest.split_at_checked(count * bytes_of(channel));
            let (line, after) = line.ok_or_else(|| Error::Invalid("a block with too few values".into()))?;
            rest = after;
            if let Some(plane) = plane {
                let plane = plane.get_mut(start..start + count);
                decode(
                    line,
                    channel.sample_type,
                    plane.ok_or_else(|| Error::Invalid("block position".into()))?,
                );
            }
        }
    }
    Ok(())
}

/// Numbers of any kind, in the order of the machine's bytes, as 32-bit floats.
fn decode(line: &[u8], kind: SampleType, values: &mut [f32]) {
    match kind {
        SampleType::F16 => {
            let halves = line.as_chunks::<2>().0.iter().map(|bytes| f16::from_ne_bytes(*bytes).to_f32());
            values.iter_mut().zip(halves).for_each(|(value, half)| *value = half);
        }
        SampleType::F32 => {
            let floats = line.as_chunks::<4>().0.iter().map(|bytes| f32::from_ne_bytes(*bytes));
            values.iter_mut().zip(floats).for_each(|(value, float)| *value = float);
        }
        SampleType::U32 => {
            let numbers = line.as_chunks::<4>().0.iter().map(|bytes| u32::from_ne_bytes(*bytes) as f32);
            values.iter_mut().zip(numbers).for_each(|(value, number)| *value = number);
        }
    }
}
