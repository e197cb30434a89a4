//! Lights under hands: their places and directions as numbers, and as handles on the images.

use super::window::Window;
use deepshade_render::scene::{Camera, Light};
use eframe::egui::{Color32, DragValue, Id, Pos2, Rect, Response, Slider, Stroke, Ui, pos2};
use glam::{Mat3, Vec2, Vec3};

/// How near to a light's handle the pointer takes hold of it, points.
const GRIP: f32 = 9.0;
/// Lights with numbers beside the images.
const LISTED: usize = 16;

/// Places, directions and powers as numbers.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let (Some(lights), Some(subject)) = (&mut window.state.lights, &window.subject) else { return };
    if lights.is_empty() {
        return;
    }
    ui.collapsing(format!("lights ({})", lights.len()), |ui| {
        let step = 1e-3 * subject.diagonal;
        let own = &subject.animated.scene.lights;
        for (index, (light, own)) in lights.iter_mut().zip(own).take(LISTED).enumerate() {
            ui.push_id(index, |ui| numbers(ui, light, own, step));
        }
        if ui.button("as they were").clicked() {
            own.clone_into(lights);
        }
    });
}

fn numbers(ui: &mut Ui, light: &mut Light, own: &Light, step: f32) {
    if let Some(mut place) = light.position() {
        ui.horizontal(|ui| {
            for value in place.as_mut() {
                ui.add(DragValue::new(value).speed(step).suffix(" m"));
            }
        });
        *light = light.moved(|_| place, |direction| direction);
    }
    if let Some(direction) = light.direction() {
        let mut height = (-direction.y).clamp(-1.0, 1.0).asin().to_degrees();
        let mut turn = direction.x.atan2(direction.z).to_degrees();
        let before = (height, turn);
        ui.add(Slider::new(&mut height, -89.0..=89.0).suffix(" degrees").text("height"));
        ui.add(Slider::new(&mut turn, -180.0..=180.0).suffix(" degrees").text("turn"));
        if before != (height, turn) {
            let down = Mat3::from_rotation_y(turn.to_radians()) * Mat3::from_rotation_x(height.to_radians());
            *light = light.moved(|place| place, |_| (down * Vec3::Z).normalize());
        }
    }
    let mut stops = (power(light) / power(own).max(f32::MIN_POSITIVE)).log2();
    let before = stops;
    ui.add(Slider::new(&mut stops, -6.0..=6.0).suffix(" stops").text("brighter"));
    if before != stops {
        *light = light.brighter((stops - before).exp2());
    }
}

/// The sum of a light's power over the colours.
const fn power(light: &Light) -> f32 {
    let power = match *light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity,
        Light::Directional { irradiance, .. } => irradiance,
    };
    power.x + power.y + power.z
}

/// Shows where lights are on an image at `place`, and moves the one that is dragged, as far away as it is. Whether one is.
pub fn handles(ui: &Ui, response: &Response, place: Rect, window: &mut Window) -> bool {
    let (Some(lights), Some(pilot)) = (&mut window.state.lights, window.state.pilot) else { return false };
    let camera = &pilot.camera;
    let at = |light: &Light| light.position().and_then(|position| on_screen(camera, position, place));
    for spot in lights.iter().filter_map(at) {
        ui.painter().circle(spot, 4.0, Color32::from_rgb(255, 220, 120), Stroke::new(1.5, Color32::BLACK));
    }
    let held = Id::unique("light in hand");
    if response.drag_started() {
        let origin = ui.input(|input| input.pointer.press_origin());
        let near = |light: &Light| Some(at(light)?.distance(origin?) < GRIP);
        let taken = lights.iter().position(|light| near(light) == Some(true));
        ui.data_mut(|data| data.insert_temp(held, taken));
    }
    if response.drag_stopped() {
        ui.data_mut(|data| data.insert_temp(held, None::<usize>));
    }
    let taken = ui.data(|data| data.get_temp::<Option<usize>>(held)).flatten();
    let (Some(light), Some(pointer)) =
        (taken.and_then(|index| lights.get_mut(index)), response.interact_pointer_pos())
    else {
        return false;
    };
    if let Some(position) = light.position() {
        let position = dragged(camera, position, place, pointer);
        *light = light.moved(|_| position, |direction| direction);
    }
    true
}

/// Where a point is seen on an image at `place`; nowhere behind the camera and beside the image.
fn on_screen(camera: &Camera, point: Vec3, place: Rect) -> Option<Pos2> {
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
fn pixels(place: Rect) -> [usize; 2] {
    [place.height(), place.width()].map(|side| side.round().max(1.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

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
