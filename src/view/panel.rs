//! The choices beside the images.

use super::design;
use super::figures;
use super::film;
use super::layers;
use super::lights;
use super::parameters;
use super::state::{Arrangement, Map, State};
#[cfg(feature = "train")]
use super::training_panel;
use super::window::Window;
use crate::arguments::EDGES;
use crate::methods::{self, TRUTH};
use deepshade_render::methods::Quality;
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::{Attribute, Effect};
use eframe::egui::{
    Button, Color32, ComboBox, DragValue, Key, RichText, ScrollArea, Slider, SliderClamping, Ui,
    style::ScrollStyle,
};

/// The share of the panel's height that words may take above what can be chosen.
const SAID: f32 = 0.3;

/// Shows everything that can be chosen and everything that is known.
pub fn show(ui: &mut Ui, window: &mut Window) {
    keys(ui, window);
    said(ui, window);
    // A bar that is always there tells that there is more below.
    ui.spacing_mut().scroll = ScrollStyle::solid();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        scene(ui, window);
        lights::show(ui, window);
        ui.separator();
        effect(ui, window);
        parameters::show(ui, &mut window.state);
        design::show(ui, window);
        ui.separator();
        look(ui, window);
        layers::show(ui, window);
        ui.separator();
        figures::truth(ui, window);
        figures::metrics(ui, window);
        #[cfg(feature = "train")]
        training_panel::show(ui, window);
        figures::passes(ui, window);
    });
}

/// What could not be done and what was done last, above all that scrolls; long words scroll by themselves.
fn said(ui: &mut Ui, window: &Window) {
    let red = |message: &String| RichText::new(message).color(Color32::from_rgb(255, 120, 90));
    let words: Vec<RichText> =
        window.messages.error.iter().map(red).chain(window.messages.note.iter().map(RichText::new)).collect();
    if words.is_empty() {
        return;
    }
    let most = SAID * ui.available_height();
    ScrollArea::vertical().id_salt("said").max_height(most).show(ui, |ui| {
        for words in words {
            ui.label(words);
            ui.separator();
        }
    });
}

/// What keys do that no text field takes.
fn keys(ui: &Ui, window: &mut Window) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let [space, t, m, p] =
        ui.input(|input| [Key::Space, Key::T, Key::M, Key::P].map(|key| input.key_pressed(key)));
    if p {
        window.request_screenshot(ui.ctx(), None);
    }
    let state = &mut window.state;
    state.playing ^= space;
    state.truth ^= t;
    if m {
        state.look.map = state.look.map.next();
    }
}

fn scene(ui: &mut Ui, window: &mut Window) {
    let name = window.state.show.source.to_string();
    ui.heading(name);
    let Some(subject) = window.results.subject.clone() else { return };
    for added in &subject.added {
        ui.label(RichText::new(added).small().weak());
    }
    let cameras = &subject.animated.scene.cameras;
    if !cameras.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for (name, camera) in cameras {
                if ui.button(name).on_hover_text("look through this camera of the scene").clicked()
                    && let Some(controller) = &mut window.state.controller
                {
                    controller.camera.position = camera.position;
                    controller.camera.rotation = camera.rotation;
                    controller.camera.vertical_fov = camera.vertical_fov;
                }
            }
        });
    }
    ui.horizontal_wrapped(|ui| {
        let hint = "the camera where it was when the scene was opened";
        if ui.button("back to the first view").on_hover_text(hint).clicked() {
            window.state.controller = Some(subject.controller);
        }
        let hint = "every image, and a comparison that makes them without a window";
        if ui.button("save").on_hover_text(hint).clicked() {
            window.save();
        }
        if ui.button("screenshot").on_hover_text("the whole window as PNG: P").clicked() {
            window.request_screenshot(ui.ctx(), None);
        }
    });
    if let Some(span) = window.timeline() {
        timeline(ui, &mut window.state, span);
        film::show(ui, window, span);
    }
}

const MOMENT: &str = "the moment of the animation that is shown";

/// The moment that is shown: on a line where time has an end, else as a number.
fn timeline(ui: &mut Ui, state: &mut State, [begin, end]: [f32; 2]) {
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut state.playing, "plays").on_hover_text("whether time goes on: space");
        if end.is_finite() {
            let slider =
                Slider::new(&mut state.time, begin..=end).clamping(SliderClamping::Edits).suffix(" s");
            ui.add(slider).on_hover_text(MOMENT);
            return;
        }
        let moment = DragValue::new(&mut state.time).range(begin..=end).clamp_existing_to_range(false);
        ui.add(moment.speed(0.02).suffix(" s")).on_hover_text(MOMENT);
        if ui.button("anew").on_hover_text("back to when time begins").clicked() {
            state.time = begin;
        }
    });
}

fn effect(ui: &mut Ui, window: &mut Window) {
    let mut wanted = window.state.show.effect;
    let choice = ComboBox::from_label("effect").selected_text(wanted.name()).show_ui(ui, |ui| {
        for effect in Effect::ALL {
            let hint = format!("its image is {}", effect.unit());
            ui.selectable_value(&mut wanted, effect, effect.name()).on_hover_text(hint);
        }
    });
    choice
        .response
        .on_hover_text("what is computed; a radius and methods that were chosen stay where it has them");
    if wanted != window.state.show.effect {
        window.state.choose_effect(wanted);
        window.changed();
    }
    let state = &mut window.state;
    let names = methods::names_of(wanted);
    if names.len() == 1 {
        ui.label("no method computes it: truth alone");
    }
    for name in names.into_iter().filter(|name| *name != TRUTH) {
        let mut chosen = state.show.methods.contains(&name);
        let hint = format!("whether {name} is shown; what it costs stands under the figures");
        if ui.checkbox(&mut chosen, name).on_hover_text(hint).changed() {
            state.toggle(name);
        }
    }
    let show = &mut state.show;
    let choice = ComboBox::from_label("quality").selected_text(show.quality.name()).show_ui(ui, |ui| {
        for quality in Quality::ALL {
            let hint = format!("analytic methods with {} quality", quality.name());
            ui.selectable_value(&mut show.quality, quality, quality.name()).on_hover_text(hint);
        }
    });
    choice.response.on_hover_text("how much time analytic methods may take for a better image");
    let hint = "less noise, by what of frames before is seen again; it follows what moves late";
    ui.checkbox(&mut show.temporal, "mixed with frames before").on_hover_text(hint);
    let (Some(picture), Some(subject)) = (&window.results.picture, &window.results.subject) else { return };
    if wanted.listens_to(EffectSetting::Radius) {
        let mut radius = state.show.radius.unwrap_or(picture.radius);
        ui.horizontal_wrapped(|ui| {
            let range = 1e-3 * subject.diagonal..=subject.diagonal;
            let slider = Slider::new(&mut radius, range).clamping(SliderClamping::Edits);
            let slider = ui.add(slider.logarithmic(true).suffix(" m").text("radius"));
            if slider.on_hover_text("how far the effect reaches").changed() {
                state.set_radius(Some(radius));
            }
            let usual = ui.add_enabled(state.show.radius.is_some(), Button::new("usual"));
            let usual = usual.on_disabled_hover_text("it is as far as is usual");
            if usual.on_hover_text("as far as suits the scene and the network").clicked() {
                state.set_radius(None);
            }
        });
    }
    if let Some(warning) = &picture.warning {
        ui.label(RichText::new(warning).small().weak());
    }
}

fn look(ui: &mut Ui, window: &mut Window) {
    let state = &mut window.state;
    ui.horizontal_wrapped(|ui| {
        for arrangement in Arrangement::ALL {
            let hint = match arrangement {
                Arrangement::Wipe => "images over each other, with borders that can be dragged",
                Arrangement::Tiles => "images beside each other",
            };
            ui.selectable_value(&mut state.look.arrangement, arrangement, arrangement.name())
                .on_hover_text(hint);
        }
        ui.separator();
        for map in Map::ALL {
            let hint = match map {
                Map::Image => "the images themselves: M goes through these three",
                Map::Difference => "how far they are from what they are held against, darker or brighter",
                Map::Flip => "how far they look from it: FLIP",
            };
            ui.selectable_value(&mut state.look.map, map, map.name()).on_hover_text(hint);
        }
    });
    let choice = ComboBox::from_label("is held against").selected_text(state.reference()).show_ui(ui, |ui| {
        ui.selectable_value(&mut state.look.against, None, TRUTH).on_hover_text("the path-traced image");
        for method in &state.show.methods {
            let hint = format!("the image of {method}");
            ui.selectable_value(&mut state.look.against, Some(*method), *method).on_hover_text(hint);
        }
    });
    choice.response.on_hover_text("what differences and figures are measured against");
    let stops = Slider::new(&mut state.look.stops, -6.0..=6.0).clamping(SliderClamping::Edits);
    let hint = "how much brighter images are shown";
    ui.add(stops.suffix(" stops").text("brighter")).on_hover_text(hint);
    if ui.button("expose anew").on_hover_text("as suits what is shown now").clicked() {
        window.expose_anew();
    }
    let state = &mut window.state;
    let inspected = &mut state.show.inspected;
    let name = inspected.map_or("none", Attribute::name);
    let choice = ComboBox::from_label("of the g-buffer").selected_text(name).show_ui(ui, |ui| {
        ui.selectable_value(inspected, None, "none").on_hover_text("the methods' images alone");
        for attribute in Attribute::ALL {
            let hint = format!("{} of what is seen, beside the images", attribute.name());
            ui.selectable_value(inspected, Some(attribute), attribute.name()).on_hover_text(hint);
        }
    });
    choice.response.on_hover_text("what methods read, as an image beside theirs");
    ui.horizontal_wrapped(|ui| {
        let [height, width] = &mut state.show.size;
        let edge =
            |value, most| DragValue::new(value).range(*EDGES.start()..=most).clamp_existing_to_range(false);
        ui.add(edge(width, 3840)).on_hover_text("columns of the images");
        ui.label("x");
        ui.add(edge(height, 2160)).on_hover_text("rows of the images");
        ui.label("pixels");
    });
}
