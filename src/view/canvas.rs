//! Where images are seen: over each other or beside each other, and the mouse and keys that move the camera.

use super::design::pick;
use super::legend;
use super::lights;
use super::probe;
use super::state::Arrangement;
use super::window::Window;
use super::zoom::{ImageRect, Zoom};
use deepshade_shaders::Planes;
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Key, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui,
    vec2,
};
use glam::{Vec2, Vec3};

/// An image on the canvas.
pub struct CanvasImage<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Its values.
    pub values: &'a Planes,
    /// What is seen of it.
    pub texture: egui::TextureId,
    /// Whether a map of it is wanted that is not there yet, so that it is seen itself.
    pub lacks_map: bool,
}

impl CanvasImage<'_> {
    /// What is said of it in its corner.
    fn title(&self) -> String {
        if self.lacks_map {
            format!("{}: itself, until it is measured", self.name)
        } else {
            self.name.to_owned()
        }
    }
}

/// Radians that the camera turns while the pointer goes through a window's height.
const TURN: f32 = 2.5;
/// Share of the scene's diagonal that keys fly a second.
const SPEED: f32 = 0.15;
/// How much larger a key makes images.
const STEP: f32 = 1.5;
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
        let text = window.messages.first().unwrap_or("reading the scene");
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
    let held = match window.state.look.arrangement {
        Arrangement::Wipe => {
            let place = fitted(area, aspect);
            let names: Vec<String> = shown.iter().map(|image| image.name.to_owned()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let place = window.state.look.zoom.place(place);
            wipe(ui, place, &window.state.look.borders(&names), &shown);
            probe::show(ui, &response, place, &shown, None);
            let held = enlarge(ui, &response, &[place], window)
                || drag_border(ui, &response, place.seen, window, &names);
            pick::show(ui, &response, &[place], window);
            lights::handles(ui, &response, &[place], window, held)
        }
        Arrangement::Tiles => {
            let zoom = window.state.look.zoom;
            let places: Vec<ImageRect> =
                tiles(area, aspect, count).into_iter().map(|place| zoom.place(place)).collect();
            for (place, image) in places.iter().zip(&shown) {
                picture(ui, *place, place.seen, image);
                label(ui, place.seen, &image.title());
            }
            let under =
                response.hover_pos().and_then(|at| places.iter().position(|place| place.seen.contains(at)));
            if let Some(index) = under {
                probe::show(ui, &response, places[index], &shown, Some(index));
            }
            let held = enlarge(ui, &response, &places, window);
            pick::show(ui, &response, &places, window);
            lights::handles(ui, &response, &places, window, held)
        }
    };
    legend::show(ui, area, window.state.look.map, window.state.reference());
    if !held {
        move_camera(ui, &response, window);
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
fn picture(ui: &Ui, place: ImageRect, seen: Rect, image: &CanvasImage<'_>) {
    let uv = Rect::from_min_max(place.share(seen.min), place.share(seen.max));
    ui.painter().image(image.texture, seen, uv, Color32::WHITE);
}

fn label(ui: &Ui, place: Rect, name: &str) {
    let at = place.left_top() + vec2(6.0, 4.0);
    let text = ui.painter().layout_no_wrap(name.to_owned(), FontId::proportional(14.0), Color32::WHITE);
    // Images may be white.
    let chip = Rect::from_min_size(at, text.size()).expand2(vec2(4.0, 2.0));
    ui.painter().rect_filled(chip, 3.0, Color32::from_black_alpha(170));
    ui.painter().galley(at, text, Color32::WHITE);
}

/// Images over each other, each from one border to the next.
fn wipe(ui: &Ui, place: ImageRect, borders: &[f32], shown: &[CanvasImage<'_>]) {
    let x = |share: f32| place.seen.left() + share * place.seen.width();
    let begins = std::iter::once(0.0).chain(borders.iter().copied());
    let ends = borders.iter().copied().chain(std::iter::once(1.0));
    for (image, (begin, end)) in shown.iter().zip(begins.zip(ends)) {
        let seen = Rect::from_x_y_ranges(x(begin)..=x(end), place.seen.y_range());
        picture(ui, place, seen, image);
        label(ui, seen, &image.title());
    }
    for border in borders {
        // Dark and light: one of them is seen on any image.
        for (width, colour) in [(4.0, Color32::from_black_alpha(170)), (2.0, Color32::from_white_alpha(220))]
        {
            ui.painter().vline(x(*border), place.seen.y_range(), Stroke::new(width, colour));
        }
    }
}

/// Moves the border under the pointer. Whether it has hold of one.
fn drag_border(ui: &Ui, response: &Response, place: Rect, window: &mut Window, names: &[&str]) -> bool {
    let held = ui.scope_id().with("border");
    let borders = window.state.look.borders(names);
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
    window.state.look.put_border(names, index, (at.x - place.left()) / place.width());
    true
}

/// Enlarges images as wheel and keys say, and moves what is enlarged. Whether it is moved.
fn enlarge(ui: &Ui, response: &Response, places: &[ImageRect], window: &mut Window) -> bool {
    let zoom = &mut window.state.look.zoom;
    let pointer = response.hover_pos().or(response.interact_pointer_pos());
    let under = pointer.and_then(|at| Some((at, *places.iter().find(|place| place.seen.contains(at))?)));
    if let Some((at, place)) = under {
        zoom.about(place, at, ui.input(|input| input.zoom_delta()));
    }
    if let (Some(first), false) = (places.first(), ui.ctx().egui_wants_keyboard_input()) {
        let (at, place) = under.unwrap_or((first.seen.center(), *first));
        let [nearer, whole, further] = ui.input(|input| {
            let bare = !input.modifiers.command && !input.modifiers.alt;
            let pressed = |key| bare && input.key_pressed(key);
            [pressed(Key::Plus) || pressed(Key::Equals), pressed(Key::Num0), pressed(Key::Minus)]
        });
        match (nearer, further, whole) {
            (true, ..) => zoom.about(place, at, STEP),
            (_, true, _) => zoom.about(place, at, STEP.recip()),
            (.., true) => *zoom = Zoom::default(),
            _ => {}
        }
    }
    let moves = zoom.is_in() && response.dragged_by(PointerButton::Middle);
    if let (true, Some(place)) = (moves, places.first()) {
        zoom.pan(*place, response.drag_delta());
    }
    moves
}

/// Moves the camera as pointer, wheel and keys say.
fn move_camera(ui: &Ui, response: &Response, window: &mut Window) {
    let diagonal = window.results.subject.as_ref().map_or(1.0, |subject| subject.diagonal);
    let Some(controller) = window.state.controller.as_mut() else { return };
    let drag = response.drag_delta() / response.rect.height().max(1.0);
    let drag = Vec2::new(drag.x, drag.y);
    if drag != Vec2::ZERO {
        let shift = ui.input(|input| input.modifiers.shift);
        if response.dragged_by(PointerButton::Middle) {
            controller.pan(drag);
        } else if response.dragged_by(PointerButton::Secondary) || shift {
            controller.look(TURN * Vec2::new(drag.x, -drag.y));
        } else {
            controller.orbit(TURN * Vec2::new(-drag.x, drag.y));
        }
    }
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta.y);
        if wheel != 0.0 {
            controller.approach((-wheel / 400.0).exp());
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
        controller.fly(way.normalize() * step);
        ui.ctx().request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

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
