//! A picture of some pairs or frames of a test set: one row a pair, one column a channel, for looking at with
//! one's own eyes. Red, green and blue share a column, and so do the direction and the length of a movement.

mod paint;

use crate::generate::target_layer;
use crate::{Dataset, DatasetError, Pair, TestSet, Variation, font};
use deepshade_shaders::atomic_file;
use deepshade_shaders::{Attribute, AttributeKind, GBuffer, shows_surface};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use paint::{Paint, Rgb};
use std::path::Path;

/// The longest edge of a channel's picture has at least so many pixels, and less than twice as many.
const EDGE: usize = 128;
/// Around every picture, pixels.
const GAP: usize = 8;
/// Height of a line of text, pixels.
const LINE: usize = 12;
const BACKGROUND: Rgb = [32; 3];
const INK: Rgb = [255; 3];

/// Draws some pairs into a PNG file: above each row where the pair comes from, under each column the channel
/// and the range that is shown. Scalars go from black to white; numbers that may be negative are blue below 0
/// and orange above; colours are themselves, as sRGB; movements have the hue of their direction and the
/// brightness of their length.
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
        let time = time(record.variation.as_ref());
        let title = format!("{}, view {}{time}, {:?}", record.scene, record.view, record.part).to_lowercase();
        rows.push((title, columns(&dataset.pair(*index)?, &target_layer(dataset.recipe()))));
    }
    write(&Sheet::drawn(&rows), path)
}

/// [`contact_sheet`] of some frames of a test set, as [`TestSet::pair`] gives them.
///
/// # Errors
/// If a frame cannot be had again or the picture cannot be written.
///
/// # Panics
/// If there is no frame of an index.
pub fn test_sheet(set: &TestSet, frames: &[usize], path: &Path) -> Result<(), DatasetError> {
    let props = set.props()?;
    let target = format!("truth.{}", set.recipe().effect);
    let mut rows = Vec::new();
    for index in frames {
        let record = &set.frames()[*index];
        let time = time(record.variation.as_ref());
        let title = format!("{}, view {}{time}, testing", record.scene, record.view).to_lowercase();
        rows.push((title, columns(&set.pair(*index, &props)?, &target)));
    }
    write(&Sheet::drawn(&rows), path)
}

/// The moment of a frame of a timeline, as titles have it.
fn time(variation: Option<&Variation>) -> String {
    let moment = variation.and_then(|variation| variation.moment);
    moment.map_or_else(String::new, |moment| format!(", {} s", moment.time))
}

/// Writes a PNG file.
fn write(sheet: &Sheet, path: &Path) -> Result<(), DatasetError> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(
            sheet.pixels.as_flattened(),
            sheet.width as u32,
            sheet.height as u32,
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| DatasetError::invalid(path, error.to_string()))?;
    atomic_file::write(path, &png).map_err(|source| DatasetError::io(path, source))
}

/// A channel as it is shown.
struct Column {
    label: String,
    height: usize,
    width: usize,
    pixels: Vec<Rgb>,
}

/// All channels of a pair.
fn columns(pair: &Pair, target: &str) -> Vec<Column> {
    let gbuffer = &pair.gbuffer;
    let size = (gbuffer.height(), gbuffer.width());
    let mut columns = Vec::new();
    let mut first = 0;
    for attribute in gbuffer.attributes() {
        let planes: Vec<&[f32]> =
            (first..first + attribute.width()).map(|plane| gbuffer.planes().plane(plane)).collect();
        first += attribute.width();
        match attribute.kind() {
            AttributeKind::Colour | AttributeKind::Motion => {
                let paint =
                    if attribute.kind() == AttributeKind::Colour { Paint::Colour } else { Paint::Motion };
                columns.push(Column::new(
                    attribute.name(),
                    &planes,
                    size,
                    paint,
                    range(&planes, *attribute, gbuffer),
                ));
            }
            _ => columns.extend(attribute.channels().zip(&planes).map(|(channel, plane)| {
                let planes = std::slice::from_ref(plane);
                let paint = if *attribute == Attribute::Blurriness { Paint::Signed } else { Paint::Grey };
                Column::new(&channel.to_string(), planes, size, paint, range(planes, *attribute, gbuffer))
            })),
        }
    }
    let planes: Vec<&[f32]> = (0..pair.target.channels()).map(|channel| pair.target.plane(channel)).collect();
    let (paint, range) = match planes.len() {
        1 => (Paint::Grey, (0.0, 1.0)),
        _ => (Paint::Colour, (0.0, bright(&planes))),
    };
    columns.push(Column::new(target, &planes, size, paint, range));
    columns
}

/// The range that an attribute's planes are shown in.
fn range(planes: &[&[f32]], attribute: Attribute, gbuffer: &GBuffer) -> (f32, f32) {
    match attribute {
        Attribute::Normal | Attribute::WorldNormal | Attribute::ToCamera => (-1.0, 1.0),
        Attribute::Valid | Attribute::Diffuse | Attribute::Specular | Attribute::Glossiness => (0.0, 1.0),
        Attribute::Motion => (0.0, planes[1].iter().copied().fold(1.0, f32::max)),
        Attribute::Blurriness => {
            let (low, high) = seen_range(planes[0], gbuffer);
            let largest = if low <= high { low.abs().max(high.abs()).max(f32::MIN_POSITIVE) } else { 1.0 };
            (-largest, largest)
        }
        _ if attribute.kind() == AttributeKind::Colour => (0.0, bright(planes)),
        _ => shown_range(seen_range(planes[0], gbuffer)),
    }
}

/// What is shown as white of light: one value in a hundred of those above 0 is brighter.
fn bright(planes: &[&[f32]]) -> f32 {
    let mut lit: Vec<f32> = planes.concat().into_iter().filter(|value| *value > 0.0).collect();
    lit.sort_unstable_by(f32::total_cmp);
    lit.get((lit.len().saturating_sub(1) * 99).div_ceil(100)).copied().unwrap_or(1.0)
}

/// Smallest and largest value where a surface is seen.
fn seen_range(plane: &[f32], gbuffer: &GBuffer) -> (f32, f32) {
    let valid = gbuffer.first_plane(Attribute::Valid).ok().map(|index| gbuffer.planes().plane(index));
    let seen = (0..plane.len()).filter(|pixel| valid.is_none_or(|valid| shows_surface(valid[*pixel])));
    seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), pixel| {
        (low.min(plane[pixel]), high.max(plane[pixel]))
    })
}

/// The range to stretch from: a plane of one value has none of its own and is shown by that value, beside 0
/// and 1.
const fn shown_range((low, high): (f32, f32)) -> (f32, f32) {
    if low < high { (low, high) } else { (low.min(0.0), high.max(1.0)) }
}

impl Column {
    /// Shrinks planes by a whole factor, at most to one pixel across, or enlarges them by one, and paints
    /// what `range` spans.
    fn new(
        name: &str,
        planes: &[&[f32]],
        (height, width): (usize, usize),
        paint: Paint,
        range: (f32, f32),
    ) -> Self {
        let longest = height.max(width);
        let factor = (longest / EDGE).max(1).min(height).min(width);
        let larger = EDGE.div_ceil(longest / factor);
        let [shown_height, shown_width] = [height, width].map(|size| size / factor * larger);
        let shown = |pixel: usize| {
            let (y, x) = (pixel / shown_width / larger, pixel % shown_width / larger);
            let rows = (y * factor..(y + 1) * factor).map(|row| row * width + x * factor);
            paint.mean(planes, rows.flat_map(|first| first..first + factor), range)
        };
        let pixels = (0..shown_height * shown_width).map(shown).collect();
        let label = format!("{} {:.3} {:.3}", name.to_lowercase(), range.0, range.1);
        Self { label: shortened(&label), height: shown_height, width: shown_width, pixels }
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
    pixels: Vec<Rgb>,
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
        for [x, y] in font::pixels(text) {
            self.pixels[(top + y) * self.width + left + x] = INK;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Planes;

    fn column(plane: &[f32], height: usize, width: usize, range: (f32, f32)) -> Column {
        Column::new("a", &[plane], (height, width), Paint::Grey, shown_range(range))
    }

    #[test]
    fn narrow_images_give_a_picture_in_both_directions() {
        let ramp: Vec<f32> = (0..16 * 4096).map(|i| i as f32).collect();
        for (height, width, expected) in [
            (16, 4096, [1, 256]),
            (4096, 16, [256, 1]),
            (300, 200, [150, 100]),
            (200, 130, [200, 130]),
            (64, 48, [128, 96]),
        ] {
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
            let shown = column(&[value; 4], 2, 2, (value, value)).pixels;
            assert!(shown.iter().all(|pixel| *pixel == [grey; 3]), "{value}: {:?}", shown[0]);
        }
        // Nothing is seen.
        let shown = column(&[0.0; 4], 2, 2, (f32::INFINITY, f32::NEG_INFINITY)).pixels;
        assert!(shown.iter().all(|pixel| *pixel == [0; 3]));
        let halves = column(&[3.0, 4.0], 1, 2, (3.0, 4.0)).pixels;
        assert_eq!((halves.len(), halves[63], halves[64]), (128 * 64, [0; 3], [255; 3]));
    }

    /// Two pixels, of which the second shows nothing.
    fn pair(attribute: Attribute, first: &[f32]) -> Pair {
        let attributes = vec![attribute, Attribute::Valid];
        let planes = Planes::from_fn(attribute.width() + 1, 1, 2, |c, _, x| match x {
            0 => first.get(c).copied().unwrap_or(1.0),
            _ => 0.0,
        });
        let target = Planes::from_data(3, 1, 2, vec![4.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        Pair { gbuffer: GBuffer::new(attributes, planes), target, variance: None, radius: 1.0 }
    }

    #[test]
    fn colours_and_movements_have_one_column_and_signs_their_colours() {
        let shown = |attribute, first: &[f32]| {
            let columns = columns(&pair(attribute, first), "target.dof");
            assert_eq!(columns.len(), 3, "{attribute:?}: the attribute, the mask and the target");
            (columns[0].label.clone(), columns[0].pixels[0], columns[2].pixels[0])
        };
        let (label, light, target) = shown(Attribute::Light, &[0.0, 2.0, 0.0]);
        assert_eq!((label.as_str(), light), ("light 0 2", [0, 255, 0]));
        assert!(target[0] == 255 && target[1] > 120 && target[2] == 0, "{target:?}");
        let (_, below, _) = shown(Attribute::Blurriness, &[-30.0]);
        let (label, above, _) = shown(Attribute::Blurriness, &[30.0]);
        assert!(below[2] > below[0] && above[0] > above[2], "{below:?} {above:?}");
        assert_eq!(label, "blurriness -30 30");
        let across = shown(Attribute::Motion, &[0.0, 8.0]).1;
        let upwards = shown(Attribute::Motion, &[1.57, 8.0]).1;
        assert_ne!(across, upwards, "directions differ in hue");
        assert_eq!(shown(Attribute::Motion, &[1.57, 0.0]).1, [0; 3], "what stands still is black");
    }
}
