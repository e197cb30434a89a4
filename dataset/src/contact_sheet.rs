//! A picture of some pairs: one row a pair, one column a channel, for looking at with one's own eyes.

use crate::generate::target_layer;
use crate::{Dataset, DatasetError, Pair, font};
use deepshade_shaders::atomic_file;
use deepshade_shaders::{Attribute, GBuffer, shows_surface};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::path::Path;

/// Longest edge of a channel's picture, pixels.
const EDGE: usize = 192;
/// Around every picture, pixels.
const GAP: usize = 8;
/// Height of a line of text, pixels.
const LINE: usize = 12;
const BACKGROUND: u8 = 32;
const INK: u8 = 255;

/// Draws some pairs into a PNG file: above each row where the pair comes from, under each column the channel and,
/// where values are stretched to black and white, the range that they are stretched from.
///
/// # Errors
/// If a pair cannot be read or the picture cannot be written.
///
/// # Panics
/// If there is no pair of an index.
pub fn contact_sheet(dataset: &Dataset, pairs: &[usize], path: &Path) -> Result<(), DatasetError> {
    let mut rows = Vec::new();
    for index in pairs {
        let record = dataset.record(*index);
        let title = format!("{}, view {}, {:?}", record.scene, record.view, record.part).to_lowercase();
        rows.push((title, columns(&dataset.pair(*index)?, &target_layer(dataset.recipe()))));
    }
    let sheet = Sheet::drawn(&rows);
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&sheet.pixels, sheet.width as u32, sheet.height as u32, ExtendedColorType::L8)
        .map_err(|error| DatasetError::invalid(path, error.to_string()))?;
    atomic_file::write(path, &png).map_err(|source| DatasetError::io(path, source))
}

/// A channel as it is shown.
struct Column {
    label: String,
    height: usize,
    width: usize,
    pixels: Vec<u8>,
}

/// All channels of a pair.
fn columns(pair: &Pair, target: &str) -> Vec<Column> {
    let (height, width) = (pair.gbuffer.height(), pair.gbuffer.width());
    let mut columns = Vec::new();
    let channels = pair.gbuffer.attributes().iter().flat_map(|attribute| attribute.channels());
    for (index, channel) in channels.enumerate() {
        let plane = pair.gbuffer.planes().plane(index);
        let range = match channel.attribute {
            Attribute::Normal | Attribute::WorldNormal | Attribute::ToCamera => (-1.0, 1.0),
            Attribute::Valid => (0.0, 1.0),
            _ => shown_range(seen_range(plane, &pair.gbuffer)),
        };
        columns.push(Column::new(&channel.to_string(), plane, height, width, range));
    }
    for channel in 0..pair.target.channels() {
        let label =
            if pair.target.channels() == 1 { target.to_owned() } else { format!("{target}.{channel}") };
        columns.push(Column::new(&label, pair.target.plane(channel), height, width, (0.0, 1.0)));
    }
    columns
}

/// Smallest and largest value where a surface is seen.
fn seen_range(plane: &[f32], gbuffer: &GBuffer) -> (f32, f32) {
    let valid = gbuffer.first_plane(Attribute::Valid).ok().map(|index| gbuffer.planes().plane(index));
    let seen = (0..plane.len()).filter(|pixel| valid.is_none_or(|valid| shows_surface(valid[*pixel])));
    seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), pixel| {
        (low.min(plane[pixel]), high.max(plane[pixel]))
    })
}

/// The range to stretch from: a plane of one value has none of its own and is shown by that value, beside 0 and 1.
const fn shown_range((low, high): (f32, f32)) -> (f32, f32) {
    if low < high { (low, high) } else { (low.min(0.0), high.max(1.0)) }
}

impl Column {
    /// Shrinks a plane by a whole factor, at most to one pixel across, and maps `low` to black and `high` to white.
    fn new(name: &str, plane: &[f32], height: usize, width: usize, (low, high): (f32, f32)) -> Self {
        let factor = height.max(width).div_ceil(EDGE).min(height).min(width);
        let (small_height, small_width) = (height / factor, width / factor);
        let mean = |y: usize, x: usize| {
            let rows =
                (y * factor..(y + 1) * factor).flat_map(|row| &plane[row * width + x * factor..][..factor]);
            rows.sum::<f32>() / (factor * factor) as f32
        };
        let grey = |value: f32| (255.0 * (value - low) / (high - low)).round() as u8;
        let pixels = (0..small_height * small_width).map(|i| grey(mean(i / small_width, i % small_width)));
        let label = format!("{} {low:.3} {high:.3}", name.to_lowercase());
        Self { label: shortened(&label), height: small_height, width: small_width, pixels: pixels.collect() }
    }
}

/// Without zeros at the ends of numbers.
fn shortened(label: &str) -> String {
    let words = label.split(' ').map(|word| {
        if word.parse::<f32>().is_ok() { word.trim_end_matches('0').trim_end_matches('.') } else { word }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// The picture under the pen.
struct Sheet {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Sheet {
    fn drawn(rows: &[(String, Vec<Column>)]) -> Self {
        let columns = || rows.iter().flat_map(|(_, columns)| columns);
        let cell = columns().map(|column| column.width.max(font::ADVANCE * column.label.len()) + GAP).max();
        let cell = cell.unwrap_or(0);
        let row_height = |columns: &[Column]| {
            2 * LINE + GAP + columns.iter().map(|column| column.height).max().unwrap_or(0)
        };
        let row_width = |(title, columns): &(String, Vec<Column>)| {
            (columns.len() * cell).max(GAP + font::ADVANCE * title.len())
        };
        let width = GAP + rows.iter().map(row_width).max().unwrap_or(0);
        let height = GAP + rows.iter().map(|(_, columns)| row_height(columns)).sum::<usize>();
        let mut sheet = Self { width, height, pixels: vec![BACKGROUND; width * height] };
        let mut top = GAP;
        for (title, columns) in rows {
            sheet.text(GAP, top, title);
            for (index, column) in columns.iter().enumerate() {
                let left = GAP + index * cell;
                sheet.picture(left, top + LINE, column);
                sheet.text(left, top + LINE + column.height + 3, &column.label);
            }
            top += row_height(columns);
        }
        sheet
    }

    fn picture(&mut self, left: usize, top: usize, column: &Column) {
        for (y, row) in column.pixels.chunks_exact(column.width).enumerate() {
            self.pixels[(top + y) * self.width + left..][..column.width].copy_from_slice(row);
        }
    }

    fn text(&mut self, left: usize, top: usize, text: &str) {
        for (index, character) in text.chars().enumerate() {
            for (y, row) in font::rows(character).into_iter().enumerate() {
                for x in (0..5).filter(|x| row >> (4 - x) & 1 == 1) {
                    self.pixels[(top + y) * self.width + left + index * font::ADVANCE + x] = INK;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(plane: &[f32], height: usize, width: usize, range: (f32, f32)) -> Column {
        Column::new("a", plane, height, width, shown_range(range))
    }

    #[test]
    fn narrow_images_give_a_picture_in_both_directions() {
        let ramp: Vec<f32> = (0..16 * 4096).map(|i| i as f32).collect();
        for (height, width, expected) in [(16, 4096, [1, 256]), (4096, 16, [256, 1]), (300, 200, [150, 100])]
        {
            let plane = &ramp[..height * width];
            let column = column(plane, height, width, (0.0, plane.len() as f32));
            assert_eq!([column.height, column.width], expected);
            let (first, last) = (column.pixels[0], column.pixels[column.pixels.len() - 1]);
            assert!(column.pixels.len() == column.height * column.width && first < last);
            let sheet = Sheet::drawn(&[("a row".to_owned(), vec![column])]);
            assert!(sheet.pixels.len() == sheet.width * sheet.height && sheet.pixels.contains(&last));
        }
    }

    #[test]
    fn a_plane_of_one_value_is_shown_by_it() {
        for (value, grey) in [(0.0, 0), (0.5, 128), (1.0, 255), (7.0, 255), (-2.0, 0)] {
            assert_eq!(column(&[value; 4], 2, 2, (value, value)).pixels, [grey; 4], "{value}");
        }
        // Nothing is seen.
        assert_eq!(column(&[0.0; 4], 2, 2, (f32::INFINITY, f32::NEG_INFINITY)).pixels, [0; 4]);
        assert_eq!(column(&[3.0, 4.0], 1, 2, (3.0, 4.0)).pixels, [0, 255]);
    }
}
