//! What the colours of a map of differences mean.

use super::state::Map;
use crate::report::colour_map::{diverging, sequential};
use crate::report::images::DIFFERENCE_RANGE;
use deepshade_shaders::colour::srgb_byte;
use eframe::egui::{Align2, Color32, FontId, Rect, Ui, pos2, vec2};
use glam::Vec3;

/// Columns of the colour bar.
const COLUMNS: usize = 48;
/// Points of the colour bar.
const SIZE: [f32; 2] = [192.0, 10.0];

/// Shows which colour is which difference in the lower right corner of an area; nothing where images
/// themselves are seen.
pub fn show(ui: &Ui, area: Rect, map: Map, against: &str) {
    let (colours, [low, high], title): (fn(f32) -> Vec3, [f32; 2], String) = match map {
        Map::Image => return,
        Map::Difference => (diverging, [-1.0, 1.0], format!("darker than {against}, or lighter")),
        Map::Flip => (sequential, [0.0, 1.0], format!("FLIP against {against}")),
    };
    let range = if map == Map::Difference { DIFFERENCE_RANGE } else { 1.0 };
    let [width, height] = SIZE;
    let back = Rect::from_min_max(area.max - vec2(width + 28.0, height + 48.0), area.max - vec2(8.0, 8.0));
    let painter = ui.painter();
    painter.rect_filled(back, 3.0, Color32::from_black_alpha(170));
    let bar = Rect::from_min_size(back.min + vec2(10.0, 22.0), vec2(width, height));
    let column = width / COLUMNS as f32;
    for index in 0..COLUMNS {
        let share = index as f32 / (COLUMNS - 1) as f32;
        let [red, green, blue] = colours(low + share * (high - low)).to_array().map(srgb_byte);
        let corner = bar.min + vec2(index as f32 * column, 0.0);
        painter.rect_filled(
            Rect::from_min_size(corner, vec2(column, height)),
            0.0,
            Color32::from_rgb(red, green, blue),
        );
    }
    let font = FontId::proportional(11.0);
    let say = |at, align, text: String| painter.text(at, align, text, font.clone(), Color32::WHITE);
    say(pos2(bar.center().x, back.top() + 4.0), Align2::CENTER_TOP, title);
    let below = bar.bottom() + 2.0;
    say(pos2(bar.left(), below), Align2::LEFT_TOP, (low * range).to_string());
    say(pos2(bar.center().x, below), Align2::CENTER_TOP, (0.5 * (low + high) * range).to_string());
    say(pos2(bar.right(), below), Align2::RIGHT_TOP, (high * range).to_string());
}
