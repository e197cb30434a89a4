//! Whether what a file's headers promise is sane, before memory is taken for it.

use exr::meta::BlockDescription;
use exr::meta::header::Header;

/// The most pixels along an edge.
pub const MAX_EDGE: usize = 32_768;

/// The most values of all channels together: 1 GiB of f32.
pub const MAX_VALUES: usize = 1 << 28;

/// The most bytes of a block of pixels, which readers take memory for before they have read it.
const MAX_BLOCK: usize = 1 << 28;

/// The most that a byte of a compressed file stands for: DEFLATE repeats 258 bytes with two bits, and
/// nothing else repeats more.
const MAX_RATIO: usize = 1032;

/// Refuses headers that promise too much in the channels that are wanted, whose number is given for each
/// part. Parts of which none is wanted are not read, and may be whatever they are.
pub fn headers(headers: &[Header], wanted: &[usize], file_bytes: u64) -> Result<(), String> {
    let (mut values, mut bytes) = (0usize, 0usize);
    for (header, wanted) in headers.iter().zip(wanted) {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        if *wanted > 0 {
            edges(width, height)?;
        }
        // Every chunk has eight bytes in the offset table, which is read for all parts.
        if header.chunk_count as u64 * 8 > file_bytes {
            return Err(format!("{} chunks in {file_bytes} bytes", header.chunk_count));
        }
        if *wanted == 0 {
            continue;
        }
        let block = block_bytes(header);
        if block > MAX_BLOCK {
            return Err(format!("its blocks are of {block} bytes, where at most {MAX_BLOCK} are accepted"));
        }
        values = values.saturating_add((width * height).saturating_mul(*wanted));
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

/// Refuses rectangles that are empty or too large.
pub fn edges(width: usize, height: usize) -> Result<(), String> {
    if width == 0 || height == 0 || width > MAX_EDGE || height > MAX_EDGE {
        return Err(format!("{width} x {height} pixels, where 1 to {MAX_EDGE} an edge are accepted"));
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
