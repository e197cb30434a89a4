//! The place that key frames are of, on the images: a ring, and the click that chooses another one.

use super::place::Target;
use crate::view::lights::{on_screen, pixels};
use crate::view::window::Window;
use crate::view::zoom::ImageRect;
use deepshade_render::scene::Camera;
use eframe::egui::{Color32, Pos2, Rect, Response, Stroke, Ui};
use glam::{Vec2, Vec3};

/// Shows the place on the images at `places`, and chooses the one that is clicked while the panel is open.
pub fn show(ui: &Ui, response: &Response, places: &[ImageRect], window: &mut Window) {
    let Some(camera) = window.state.controller.map(|controller| controller.camera) else { return };
    if !window.design.is_open || window.glow().is_none() {
        return;
    }
    let moment = window.state.time;
    let subject = window.results.subject.as_ref();
    if let Some(at) = subject.and_then(|subject| window.design.seen_at(&subject.animated, moment)) {
        places.iter().for_each(|image| ring(ui, image, &camera, at));
    }
    // Another place has no key frames yet: those that are there take more than a click to lose.
    let has_keys = window.design.wish.as_ref().is_some_and(|wish| !wish.keys().is_empty());
    let chooses = response.clicked() && (!has_keys || ui.input(|input| input.modifiers.command));
    let at = response.interact_pointer_pos().filter(|_| chooses);
    let clicked = at.and_then(|at| Some((at, places.iter().find(|image| image.seen.contains(at))?)));
    if let Some((at, image)) = clicked {
        window.choose_place(Target::Ray([camera.position, direction(&camera, image.whole, at)]));
    }
}

/// A ring around a point, metres, dark and light: one of them is seen on any image.
fn ring(ui: &Ui, image: &ImageRect, camera: &Camera, point: Vec3) {
    let at = on_screen(camera, point, image.whole);
    let Some(at) = at.filter(|at| image.seen.contains(*at)) else { return };
    ui.painter().circle_stroke(at, 7.0, Stroke::new(4.0, Color32::from_black_alpha(170)));
    ui.painter().circle_stroke(at, 7.0, Stroke::new(2.0, Color32::from_rgb(120, 230, 150)));
}

/// Where a camera looks whose image at `place` is clicked.
fn direction(camera: &Camera, place: Rect, at: Pos2) -> Vec3 {
    let [height, width] = pixels(place);
    let share = (at - place.min) / place.height() * height as f32;
    camera.direction(Vec2::new(share.x, share.y), height, width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    #[test]
    fn a_click_looks_at_what_is_seen_there() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO);
        let place = Rect::from_min_size(pos2(300.0, 20.0), vec2(600.0, 400.0));
        let point = Vec3::new(0.3, 0.4, -0.5);
        let seen = on_screen(&camera, point, place).expect("in the image");
        let towards = (point - camera.position).normalize();
        assert!(direction(&camera, place, seen).normalize().dot(towards) > 0.999_999);
        assert!(direction(&camera, place, seen + vec2(9.0, 0.0)).normalize().dot(towards) < 0.999_99);
    }
}
