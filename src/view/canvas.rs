//! Where images are seen: over each other or beside each other, under hands that move the camera.

use super::lights;
use super::state::Arrangement;
use super::window::Window;
use deepshade_shaders::Planes;
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Key, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui,
    pos2, vec2,
};
use glam::{Vec2, Vec3};

/// An image on the canvas.
pub struct Shown<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Its values.
    pub values: &'a Planes,
    /// What is seen of it.
    pub texture: egui::TextureId,
}

/// Radians that the camera turns while the pointer goes through a window's height.
const TURN: f32 = 2.5;
/// Share of the scene's diagonal that keys fly a second.
const SPEED: f32 = 0.15;
/// How near to a border the pointer takes hold of it, points.
const GRIP: f32 = 6.0;

/// Shows the images and moves the camera.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let area = ui.available_rect_before_wrap();
    let response = ui.interact(area, ui.scope_id().with("canvas"), Sense::click_and_drag());
    ui.painter().rect_filled(area, 0.0, Color32::from_gray(24));
    let shown = window.shown();
    let count = shown.len();
    let Some(first) = shown.first() else {
        let text = window.message.clone().unwrap_or_else(|| "reading the scene".to_owned());
        ui.painter().text(
            area.center(),
            Align2::CENTER_CENTER,
            text,
            FontId::proportional(16.0),
            Color32::GRAY,
        );
        return;
    };
    let aspect = first.values.width() as f32 / first.values.height() as f32;
    let held = match window.state.arrangement {
        Arrangement::Wipe => {
            let place = fitted(area, aspect);
            let names: Vec<String> = shown.iter().map(|image| image.name.to_owned()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            wipe(ui, place, &window.state.borders(&names), &shown);
            probe(ui, &response, place, &shown, None);
            drag_border(ui, &response, place, window, &names)
                || lights::handles(ui, &response, &[place], window)
        }
        Arrangement::Tiles => {
            let places = tiles(area, aspect, count);
            for (place, image) in places.iter().zip(&shown) {
                picture(ui, *place, *place, image);
                label(ui, *place, image.name);
            }
            let under =
                response.hover_pos().and_then(|at| places.iter().position(|place| place.contains(at)));
            if let Some(index) = under {
                probe(ui, &response, places[index], &shown, Some(index));
            }
            lights::handles(ui, &response, &places, window)
        }
    };
    if !held {
        steer(ui, &response, window);
    }
}

/// The largest place of an aspect ratio within an area.
fn fitted(area: Rect, aspect: f32) -> Rect {
    let width = area.width().min(area.height() * aspect);
    Rect::from_center_size(area.center(), vec2(width, width / aspect))
}

/// Places beside each other, in the number of columns that leaves images largest.
fn tiles(area: Rect, aspect: f32, count: usize) -> Vec<Rect> {
    let cell = |columns: usize| {
        let rows = count.div_ceil(columns);
        vec2(area.width() / columns as f32, area.height() / rows as f32)
    };
    let width = |columns: &usize| fitted(Rect::from_min_size(area.min, cell(*columns)), aspect).width();
    let columns = (1..=count.max(1)).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(1);
    let size = cell(columns);
    let place = |index: usize| {
        let corner = area.min + vec2((index % columns) as f32 * size.x, (index / columns) as f32 * size.y);
        fitted(Rect::from_min_size(corner, size).shrink(1.0), aspect)
    };
    (0..count).map(place).collect()
}

/// The part of an image at `place` that lies within `seen`.
fn picture(ui: &Ui, place: Rect, seen: Rect, image: &Shown<'_>) {
    let share = |at: Pos2| pos2((at.x - place.left()) / place.width(), (at.y - place.top()) / place.height());
    let uv = Rect::from_min_max(share(seen.min), share(seen.max));
    ui.painter().image(image.texture, seen, uv, Color32::WHITE);
}

fn label(ui: &Ui, place: Rect, name: &str) {
    let at = place.left_top() + vec2(6.0, 4.0);
    let font = FontId::proportional(14.0);
    ui.painter().text(at + vec2(1.0, 1.0), Align2::LEFT_TOP, name, font.clone(), Color32::BLACK);
    ui.painter().text(at, Align2::LEFT_TOP, name, font, Color32::WHITE);
}

/// Images over each other, each from one border to the next.
fn wipe(ui: &Ui, place: Rect, borders: &[f32], shown: &[Shown<'_>]) {
    let x = |share: f32| place.left() + share * place.width();
    let begins = std::iter::once(0.0).chain(borders.iter().copied());
    let ends = borders.iter().copied().chain(std::iter::once(1.0));
    for (image, (begin, end)) in shown.iter().zip(begins.zip(ends)) {
        let seen = Rect::from_x_y_ranges(x(begin)..=x(end), place.y_range());
        picture(ui, place, seen, image);
        label(ui, seen, image.name);
    }
    for border in borders {
        ui.painter().vline(x(*border), place.y_range(), Stroke::new(2.0, Color32::from_white_alpha(180)));
    }
}

/// Moves the border under the pointer. Whether it has hold of one.
fn drag_border(ui: &Ui, response: &Response, place: Rect, window: &mut Window, names: &[&str]) -> bool {
    let held = ui.scope_id().with("border");
    let borders = window.state.borders(names);
    let x = |share: f32| place.left() + share * place.width();
    let near = |at: Pos2| borders.iter().position(|border| (x(*border) - at.x).abs() < GRIP);
    if let Some(at) = response.hover_pos()
        && near(at).is_some()
    {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if response.drag_started_by(PointerButton::Primary) {
        let taken = ui.input(|input| input.pointer.press_origin()).and_then(near);
        ui.data_mut(|data| data.insert_temp(held, taken));
    }
    if response.drag_stopped() {
        ui.data_mut(|data| data.insert_temp(held, None::<usize>));
    }
    let taken = ui.data(|data| data.get_temp::<Option<usize>>(held)).flatten();
    let (Some(index), Some(at)) =
        (taken.filter(|index| *index < borders.len()), response.interact_pointer_pos())
    else {
        return false;
    };
    window.state.put_border(names, index, (at.x - place.left()) / place.width());
    true
}

/// Says the values of the pixel under the pointer: of all images, or of one.
fn probe(ui: &Ui, response: &Response, place: Rect, shown: &[Shown<'_>], only: Option<usize>) {
    let Some(at) = response.hover_pos().filter(|at| place.contains(*at)) else { return };
    let share = (at - place.min) / place.size();
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
    let corner = place.left_bottom() + vec2(6.0, -6.0 - galley.size().y);
    let back = Rect::from_min_size(corner, galley.size()).expand(4.0);
    ui.painter().rect_filled(back, 3.0, Color32::from_black_alpha(170));
    ui.painter().galley(corner, galley, Color32::WHITE);
}

/// A pixel's values as text.
fn values(image: &Planes, y: usize, x: usize) -> String {
    let values: Vec<String> = (0..image.channels()).map(|c| format!("{:.4}", image.at(c, y, x))).collect();
    values.join("  ")
}

/// Moves the camera as pointer, wheel and keys say.
fn steer(ui: &Ui, response: &Response, window: &mut Window) {
    let diagonal = window.subject.as_ref().map_or(1.0, |subject| subject.diagonal);
    let Some(pilot) = window.state.pilot.as_mut() else { return };
    let drag = response.drag_delta() / response.rect.height().max(1.0);
    let drag = Vec2::new(drag.x, drag.y);
    if drag != Vec2::ZERO {
        let shift = ui.input(|input| input.modifiers.shift);
        if response.dragged_by(PointerButton::Middle) {
            pilot.pan(drag);
        } else if response.dragged_by(PointerButton::Secondary) || shift {
            pilot.look(TURN * Vec2::new(drag.x, -drag.y));
        } else {
            pilot.orbit(TURN * Vec2::new(-drag.x, drag.y));
        }
    }
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta.y);
        if wheel != 0.0 {
            pilot.approach((-wheel / 400.0).exp());
        }
    }
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let (way, step) = ui.input(|input| {
        let axis = |plus: Key, minus: Key| f32::from(input.key_down(plus)) - f32::from(input.key_down(minus));
        let way = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::S, Key::W));
        let fast = if input.modifiers.shift { 4.0 } else { 1.0 };
        (way, SPEED * diagonal * fast * input.stable_dt.min(0.1))
    });
    if way != Vec3::ZERO {
        pilot.fly(way.normalize() * step);
        ui.ctx().request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_do_not_overlap_and_keep_their_shape() {
        let area = Rect::from_min_size(pos2(10.0, 20.0), vec2(900.0, 500.0));
        for count in 1..8 {
            let places = tiles(area, 1.5, count);
            assert_eq!(places.len(), count);
            for (index, place) in places.iter().enumerate() {
                assert!(area.contains_rect(*place), "{count}: {place:?}");
                assert!((place.width() / place.height() - 1.5).abs() < 1e-3);
                for other in &places[..index] {
                    assert!(!other.shrink(0.1).intersects(place.shrink(0.1)), "{count}");
                }
            }
        }
        assert!(tiles(area, 1.5, 2)[0].width() > 440.0, "side by side where the window is wide");
    }
}
