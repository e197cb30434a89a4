//! The values of the pixel under the pointer.

use super::canvas::CanvasImage;
use super::zoom::ImageRect;
use deepshade_shaders::Planes;
use eframe::egui::{Color32, FontId, Rect, Response, Ui, vec2};

/// Digits of a value that are said.
const DIGITS: i32 = 4;

/// Says the values of the pixel under the pointer: of all images, or of one.
pub fn show(ui: &Ui, response: &Response, place: ImageRect, shown: &[CanvasImage<'_>], only: Option<usize>) {
    let Some(at) = response.hover_pos().filter(|at| place.seen.contains(*at)) else { return };
    let share = place.share(at);
    let mut lines = Vec::new();
    for (index, image) in shown.iter().enumerate() {
        if only.is_some_and(|only| only != index) {
            continue;
        }
        let (height, width) = (image.values.height(), image.values.width());
        let x = ((share.x * width as f32) as usize).min(width - 1);
        let y = ((share.y * height as f32) as usize).min(height - 1);
        if lines.is_empty() {
            lines.push(format!("pixel {x}, {y}"));
        }
        lines.push(format!("{}  {}", image.name, values(image.values, y, x)));
    }
    let text = lines.join("\n");
    let font = FontId::monospace(12.0);
    let galley = ui.painter().layout_no_wrap(text, font, Color32::WHITE);
    let corner = place.seen.left_bottom() + vec2(6.0, -6.0 - galley.size().y);
    let back = Rect::from_min_size(corner, galley.size()).expand(4.0);
    ui.painter().rect_filled(back, 3.0, Color32::from_black_alpha(170));
    ui.painter().galley(corner, galley, Color32::WHITE);
}

/// A pixel's values as text.
fn values(image: &Planes, y: usize, x: usize) -> String {
    let values: Vec<String> = (0..image.channels()).map(|c| number(image.at(c, y, x))).collect();
    values.join("  ")
}

/// A value, however large or small, by its first digits.
fn number(value: f32) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return value.to_string();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.*e}", (DIGITS - 1) as usize);
    }
    let after = (DIGITS - 1 - size.log10().floor() as i32).max(0);
    format!("{value:.*}", after as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dim_and_bright_values_have_as_many_digits() {
        for (value, said) in [
            (0.0, "0"),
            (0.5, "0.5000"),
            (-12.345_67, "-12.35"),
            (0.001_234_5, "0.001234"),
            (4.321e-7, "4.321e-7"),
            (98_765.4, "98765"),
            (1.5e9, "1.500e9"),
            (f32::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), said);
        }
    }
}
