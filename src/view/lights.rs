//! Lights that the user moves: their places and directions as numbers, and as handles on the images.

use super::window::Window;
use super::zoom::ImageRect;
use deepshade_render::scene::{Camera, Light};
use eframe::egui::{
    Color32, DragValue, Id, PointerButton, Pos2, Rect, Response, Slider, SliderClamping, Stroke, Ui, pos2,
};
use glam::{Mat3, Vec2, Vec3};
use std::ops::RangeInclusive;

/// How near to a light's handle the pointer takes hold of it, points.
const GRIP: f32 = 9.0;
/// How far a sun's handle is from what the camera goes around, as a share of the camera's distance from that.
const SUN: f32 = 0.3;
/// How far the user turns lights up and down, degrees.
const STEEPEST: f32 = 89.9;
/// Lights with numbers beside the images.
const LISTED: usize = 16;

/// Places, directions and powers as numbers.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let (Some(lights), Some(subject)) = (&mut window.state.lights, &window.results.subject) else { return };
    if lights.is_empty() {
        return;
    }
    let lamps = ui.collapsing(format!("lights ({})", lights.len()), |ui| {
        let step = 1e-3 * subject.diagonal;
        let own = &subject.animated.scene.lights;
        for (index, (light, own)) in lights.iter_mut().zip(own).take(LISTED).enumerate() {
            let free = !subject.is_rigged(index);
            ui.push_id(index, |ui| numbers(ui, light, own, free.then_some(step)));
        }
        if ui.button("as they were").on_hover_text("all lights as the scene has them").clicked() {
            own.clone_into(lights);
        }
    });
    lamps
        .header_response
        .on_hover_text("places, directions and brightness; handles on the images move them, too");
}

/// A light's numbers. Where nothing says by what steps it is moved, an animation moves it.
fn numbers(ui: &mut Ui, light: &mut Light, own: &Light, step: Option<f32>) {
    match step {
        Some(step) => placed(ui, light, step),
        None => drop(ui.label("moved by an animation")),
    }
    let Some(before) = stops(light, own) else { return };
    let mut stops = before;
    let slider = ui.add(slider(&mut stops, -6.0..=6.0, " stops", "brighter"));
    if slider.on_hover_text("than the scene has it").changed() {
        *light = light.brighter((stops - before).exp2());
    }
}

fn placed(ui: &mut Ui, light: &mut Light, step: f32) {
    if let Some(mut place) = light.position() {
        let mut changed = false;
        ui.horizontal_wrapped(|ui| {
            for (value, hint) in
                place.as_mut().iter_mut().zip(["x, to the right", "y, up", "z, to the front"])
            {
                let number = ui.add(DragValue::new(value).speed(step).suffix(" m"));
                changed |= number.on_hover_text(hint).changed();
            }
        });
        if changed {
            *light = light.moved(|_| place, |direction| direction);
        }
    }
    if let Some(direction) = light.direction() {
        let [mut height, mut turn] = angles(direction);
        let raised = ui.add(slider(&mut height, -90.0..=90.0, " degrees", "height"));
        let raised = raised.on_hover_text("how steeply light comes down").changed();
        let turned = ui.add(slider(&mut turn, -180.0..=180.0, " degrees", "turn"));
        if turned.on_hover_text("where it goes, around the vertical").changed() || raised {
            *light = light.moved(|place| place, |_| towards([height, turn]));
        }
    }
}

/// A slider that leaves what it is given as it is until the user moves it.
fn slider<'a>(
    value: &'a mut f32,
    range: RangeInclusive<f32>,
    unit: &'static str,
    text: &'static str,
) -> Slider<'a> {
    Slider::new(value, range).clamping(SliderClamping::Edits).suffix(unit).text(text)
}

/// How steeply a direction goes down, and where it turns, degrees.
fn angles(direction: Vec3) -> [f32; 2] {
    [(-direction.y).clamp(-1.0, 1.0).asin(), direction.x.atan2(direction.z)].map(f32::to_degrees)
}

/// The direction of [`angles`], just short of straight up and down, where it would forget where it turns.
fn towards([height, turn]: [f32; 2]) -> Vec3 {
    let height = height.clamp(-STEEPEST, STEEPEST).to_radians();
    let down = Mat3::from_rotation_y(turn.to_radians()) * Mat3::from_rotation_x(height);
    (down * Vec3::Z).normalize()
}

/// How much brighter a light is than it was, stops; nothing where one of both is dark.
fn stops(light: &Light, own: &Light) -> Option<f32> {
    let stops = (power(light) / power(own)).log2();
    stops.is_finite().then_some(stops)
}

/// The sum of a light's power over the colours.
const fn power(light: &Light) -> f32 {
    let power = match *light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity,
        Light::Directional { irradiance, .. } => irradiance,
    };
    power.x + power.y + power.z
}

/// A light that is held, and the image on which it is.
#[derive(Clone, Copy)]
struct Held {
    image: usize,
    light: usize,
    /// 1 where its handle was taken on this side of what the camera goes around, else -1.
    side: f32,
}

/// Shows where lights are on the images at `places`, but for those that animations move, and moves the one
/// that is dragged, as far away as it is, unless the pointer has `held` something else. A sun's handle goes
/// around what the camera does. Whether the pointer has hold of anything.
pub fn handles(ui: &Ui, response: &Response, places: &[ImageRect], window: &mut Window, held: bool) -> bool {
    let (Some(lights), Some(controller)) = (&mut window.state.lights, window.state.controller) else {
        return held;
    };
    let Some(subject) = &window.results.subject else { return held };
    let camera = &controller.camera;
    let middle = controller.pivot();
    let reach = SUN * middle.distance(camera.position);
    let mut seen = Vec::new();
    for (image, place) in places.iter().enumerate() {
        for (light, it) in lights.iter().enumerate().filter(|(light, _)| !subject.is_rigged(*light)) {
            let towards = it.direction().unwrap_or_default();
            let point = it.position().unwrap_or(middle - towards * reach);
            let spot = on_screen(camera, point, place.whole).filter(|spot| place.seen.contains(*spot));
            let side = if towards.dot(camera.rotation.z_axis) > 0.0 { -1.0 } else { 1.0 };
            seen.extend(spot.map(|spot| (Held { image, light, side }, spot)));
        }
    }
    let fill = Color32::from_rgb(255, 220, 120);
    for (held, spot) in &seen {
        let place = places[held.image];
        if lights[held.light].position().is_none()
            && let Some(to) = on_screen(camera, middle, place.whole)
        {
            let painter = ui.painter().with_clip_rect(place.seen);
            painter.arrow(*spot, 0.8 * (to - *spot), Stroke::new(1.5, fill));
        }
        ui.painter().circle(*spot, 4.0, fill, Stroke::new(1.5, Color32::BLACK));
    }
    if held {
        return true;
    }
    let held_light = Id::unique("held light");
    if response.drag_started_by(PointerButton::Primary) {
        let origin = ui.input(|input| input.pointer.press_origin());
        let near = |spot: &Pos2| origin.is_some_and(|origin| spot.distance(origin) < GRIP);
        let taken = seen.iter().find(|(_, spot)| near(spot)).map(|(held, _)| *held);
        ui.data_mut(|data| data.insert_temp(held_light, taken));
    }
    if response.drag_stopped() {
        ui.data_mut(|data| data.insert_temp(held_light, None::<Held>));
    }
    let Some(Held { image, light, side }) =
        ui.data(|data| data.get_temp::<Option<Held>>(held_light)).flatten()
    else {
        return false;
    };
    let (Some(place), Some(light), Some(pointer)) =
        (places.get(image), lights.get_mut(light), response.interact_pointer_pos())
    else {
        return false;
    };
    *light = match light.position() {
        Some(position) => {
            let position = dragged(camera, position, place.whole, pointer);
            light.moved(|_| position, |direction| direction)
        }
        None => {
            let drag = side * radians(camera, response.drag_delta(), place.whole);
            light.moved(|place| place, |direction| turned(camera, direction, drag))
        }
    };
    true
}

/// By how much a sun turns whose handle, before the middle of an image at `place`, goes by points of the
/// window.
fn radians(camera: &Camera, points: eframe::egui::Vec2, place: Rect) -> Vec2 {
    let radius = SUN * 0.5 * place.height() / (0.5 * camera.vertical_fov).tan();
    Vec2::new(points.x, points.y) / radius.max(1.0)
}

/// The direction of a sun that is turned as a ball is whose near side is moved to the right and down,
/// radians.
fn turned(camera: &Camera, direction: Vec3, drag: Vec2) -> Vec3 {
    let Mat3 { x_axis, y_axis, .. } = camera.rotation;
    (Mat3::from_axis_angle(y_axis, drag.x) * Mat3::from_axis_angle(x_axis, drag.y) * direction).normalize()
}

/// Where a point is seen on an image at `place`; nowhere behind the camera and beside the image.
pub fn on_screen(camera: &Camera, point: Vec3, place: Rect) -> Option<Pos2> {
    let [height, width] = pixels(place);
    let pixel = camera.project(camera.to_camera(point), height, width)?;
    let at = place.min + (pos2(pixel.x, pixel.y) - Pos2::ZERO) * (place.height() / height as f32);
    place.contains(at).then_some(at)
}

/// Where a point comes to be that is dragged to `pointer`, at the depth that it has.
fn dragged(camera: &Camera, point: Vec3, place: Rect, pointer: Pos2) -> Vec3 {
    let [height, width] = pixels(place);
    let share = (pointer - place.min) / place.height() * height as f32;
    let direction = camera.direction(Vec2::new(share.x, share.y), height, width);
    let depth = -camera.to_camera(point).z;
    camera.position + direction * (depth / -camera.direction_to_camera(direction).z)
}

/// Rows and columns of an image whose pixels are points of the window, about.
pub fn pixels(place: Rect) -> [usize; 2] {
    [place.height(), place.width()].map(|side| side.round().max(1.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn numbers_of_lights_survive_the_poles_and_the_dark() {
        for direction in [Vec3::NEG_Y, Vec3::Y] {
            let [height, turn] = angles(direction);
            assert!(height.abs() == 90.0 && towards([height, turn]).dot(direction) > 0.999);
        }
        let [height, turn] = angles(towards([90.0, 35.0]));
        assert!((height - STEEPEST).abs() < 0.05 && (turn - 35.0).abs() < 0.5, "{height} {turn}");
        let light = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let dark = light.brighter(0.0);
        assert_eq!(stops(&light.brighter(4.0), &light), Some(2.0));
        assert_eq!((stops(&light, &dark), stops(&dark, &dark)), (None, None));
    }

    #[test]
    fn a_sun_follows_the_pointer_on_either_side() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
        let place = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 400.0));
        let handle = |direction: Vec3| on_screen(&camera, -1.5 * direction, place).expect("in the image");
        for side in [1.0, -1.0] {
            let direction = -side * camera.rotation.z_axis;
            let before = handle(direction);
            let drag = radians(&camera, vec2(6.0, 4.0), place);
            let after = handle(turned(&camera, direction, side * drag));
            let moved = after - before;
            assert!(moved.x > 3.0 && moved.x < 10.0 && moved.y > 2.0 && moved.y < 7.0, "{side}: {moved:?}");
        }
    }

    #[test]
    fn a_light_goes_where_the_pointer_is_and_stays_as_far_away() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO);
        let place = Rect::from_min_size(pos2(300.0, 20.0), vec2(600.0, 400.0));
        let light = Vec3::new(0.3, 0.4, -0.5);
        let seen = on_screen(&camera, light, place).expect("in the image");
        assert!(dragged(&camera, light, place, seen).distance(light) < 1e-4);
        let target = seen + vec2(50.0, -30.0);
        let moved = dragged(&camera, light, place, target);
        assert!(on_screen(&camera, moved, place).expect("in the image").distance(target) < 0.01);
        assert!((camera.to_camera(moved).z - camera.to_camera(light).z).abs() < 1e-4);
        assert_eq!(on_screen(&camera, Vec3::new(1.0, 2.0, 9.0), place), None, "behind the camera");
    }
}
