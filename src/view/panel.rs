//! The choices beside the images, and the figures under them.

#[cfg(feature = "train")]
use super::curves;
use super::film;
use super::layers;
use super::lights;
use super::parameters;
use super::state::{Arrangement, Map, State};
use super::window::Window;
use crate::arguments::EDGES;
use crate::complete::listeners;
use crate::methods::{self, TRUTH};
use deepshade_render::methods::Quality;
use deepshade_shaders::{Attribute, Effect};
use eframe::egui::{
    Button, Color32, ComboBox, DragValue, Grid, Key, RichText, ScrollArea, Slider, SliderClamping, Ui,
};

/// Shows everything that can be chosen and everything that is known.
pub fn show(ui: &mut Ui, window: &mut Window) {
    keys(ui, window);
    said(ui, window);
    ScrollArea::vertical().show(ui, |ui| {
        scene(ui, window);
        lights::show(ui, window);
        ui.separator();
        effect(ui, window);
        parameters::show(ui, &mut window.state);
        ui.separator();
        look(ui, window);
        layers::show(ui, window);
        ui.separator();
        truth(ui, window);
        figures(ui, window);
        #[cfg(feature = "train")]
        curves::show(ui, window);
        passes(ui, window);
    });
}

/// What could not be done and what was done last, above all that scrolls.
fn said(ui: &mut Ui, window: &Window) {
    if let Some(message) = &window.message {
        ui.label(RichText::new(message).color(Color32::from_rgb(255, 120, 90)));
        ui.separator();
    }
    if let Some(note) = &window.note {
        ui.label(note);
        ui.separator();
    }
}

/// What keys do that no text field takes.
fn keys(ui: &Ui, window: &mut Window) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let [space, t, m, p] =
        ui.input(|input| [Key::Space, Key::T, Key::M, Key::P].map(|key| input.key_pressed(key)));
    if p {
        window.shoot(ui.ctx(), None);
    }
    let state = &mut window.state;
    state.playing ^= space;
    state.truth ^= t;
    if m {
        state.map = state.map.next();
    }
}

fn scene(ui: &mut Ui, window: &mut Window) {
    let name = window.state.show.source.to_string();
    ui.heading(name);
    let Some(subject) = window.subject.clone() else { return };
    for added in &subject.added {
        ui.label(RichText::new(added).small().weak());
    }
    let cameras = &subject.animated.scene.cameras;
    if !cameras.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for (name, camera) in cameras {
                if ui.button(name).clicked()
                    && let Some(pilot) = &mut window.state.pilot
                {
                    pilot.camera.position = camera.position;
                    pilot.camera.rotation = camera.rotation;
                    pilot.camera.vertical_fov = camera.vertical_fov;
                }
            }
        });
    }
    ui.horizontal(|ui| {
        if ui.button("back to the first view").clicked() {
            window.state.pilot = Some(subject.pilot);
        }
        if ui
            .button("save")
            .on_hover_text("every image, and a comparison that makes them without a window")
            .clicked()
        {
            window.save(None);
        }
        if ui.button("screenshot").on_hover_text("the whole window as PNG").clicked() {
            window.shoot(ui.ctx(), None);
        }
    });
    if let Some(span) = window.timeline() {
        timeline(ui, &mut window.state, span);
        film::show(ui, window);
    }
}

/// The moment that is shown: on a line where time has an end, else as a number.
fn timeline(ui: &mut Ui, state: &mut State, [begin, end]: [f32; 2]) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut state.playing, "plays");
        if end.is_finite() {
            ui.add(Slider::new(&mut state.time, begin..=end).clamping(SliderClamping::Edits).suffix(" s"));
            return;
        }
        let moment = DragValue::new(&mut state.time).range(begin..=end).clamp_existing_to_range(false);
        ui.add(moment.speed(0.02).suffix(" s"));
        if ui.button("anew").on_hover_text("back to when time begins").clicked() {
            state.time = begin;
        }
    });
}

fn effect(ui: &mut Ui, window: &mut Window) {
    let mut wanted = window.state.show.effect;
    ComboBox::from_label("effect").selected_text(wanted.name()).show_ui(ui, |ui| {
        for effect in Effect::ALL {
            ui.selectable_value(&mut wanted, effect, effect.name());
        }
    });
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
        if ui.checkbox(&mut chosen, name).changed() {
            state.toggle(name);
        }
    }
    let show = &mut state.show;
    ComboBox::from_label("quality").selected_text(show.quality.name()).show_ui(ui, |ui| {
        for quality in Quality::ALL {
            ui.selectable_value(&mut show.quality, quality, quality.name());
        }
    });
    ui.checkbox(&mut show.temporal, "mixed with frames before");
    let (Some(picture), Some(subject)) = (&window.picture, &window.subject) else { return };
    if listeners::RADIUS.contains(&wanted) {
        let mut radius = show.radius.unwrap_or(picture.radius);
        ui.horizontal(|ui| {
            let range = 1e-3 * subject.diagonal..=subject.diagonal;
            let slider = Slider::new(&mut radius, range).clamping(SliderClamping::Edits);
            if ui.add(slider.logarithmic(true).suffix(" m").text("radius")).changed() {
                show.radius = Some(radius);
            }
            if ui.add_enabled(show.radius.is_some(), Button::new("usual")).clicked() {
                show.radius = None;
            }
        });
    }
    if let Some(warning) = &picture.warning {
        ui.label(RichText::new(warning).small().weak());
    }
}

fn look(ui: &mut Ui, window: &mut Window) {
    let state = &mut window.state;
    ui.horizontal(|ui| {
        for arrangement in Arrangement::ALL {
            ui.selectable_value(&mut state.arrangement, arrangement, arrangement.name());
        }
        ui.separator();
        for map in Map::ALL {
            ui.selectable_value(&mut state.map, map, map.name());
        }
    });
    ComboBox::from_label("is held against").selected_text(state.reference()).show_ui(ui, |ui| {
        ui.selectable_value(&mut state.against, None, TRUTH);
        for method in &state.show.methods {
            ui.selectable_value(&mut state.against, Some(*method), *method);
        }
    });
    let stops = Slider::new(&mut state.stops, -6.0..=6.0).clamping(SliderClamping::Edits);
    ui.add(stops.suffix(" stops").text("brighter"));
    if ui.button("expose anew").on_hover_text("as suits what is shown now").clicked() {
        window.expose_anew();
    }
    let state = &mut window.state;
    let inspected = &mut state.show.inspected;
    let name = inspected.map_or("none", Attribute::name);
    ComboBox::from_label("of the g-buffer").selected_text(name).show_ui(ui, |ui| {
        ui.selectable_value(inspected, None, "none");
        for attribute in Attribute::ALL {
            ui.selectable_value(inspected, Some(attribute), attribute.name());
        }
    });
    ui.horizontal(|ui| {
        let [height, width] = &mut state.show.size;
        ui.add(DragValue::new(width).range(*EDGES.start()..=3840).clamp_existing_to_range(false));
        ui.label("x");
        ui.add(DragValue::new(height).range(*EDGES.start()..=2160).clamp_existing_to_range(false));
        ui.label("pixels");
    });
}

fn truth(ui: &mut Ui, window: &mut Window) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut window.state.truth, "truth, up to");
        let samples = &mut window.state.samples;
        ui.add(DragValue::new(samples).range(8..=16_384).clamp_existing_to_range(false).suffix(" samples"));
    });
    if let Some(truth) = window.truth_of_picture() {
        let noise = 100.0 * truth.noise;
        ui.label(format!("{} samples in {:.1} s, noise {noise:.1} %", truth.samples, truth.seconds));
    }
}

fn figures(ui: &mut Ui, window: &Window) {
    let Some(verdict) = window.verdict_of_picture() else { return };
    Grid::new("figures").striped(true).show(ui, |ui| {
        for head in [verdict.against, "SSIM", "FLIP", "relMSE"] {
            ui.strong(head);
        }
        ui.end_row();
        for judged in &verdict.judged {
            ui.label(&judged.name);
            ui.monospace(format!("{:.3}", judged.scores.ssim));
            ui.monospace(format!("{:.3}", judged.scores.flip));
            ui.monospace(format!("{:.4}", judged.scores.relative_mse));
            ui.end_row();
        }
    });
}

fn passes(ui: &mut Ui, window: &Window) {
    let Some(picture) = &window.picture else { return };
    ui.separator();
    Grid::new("passes").striped(true).show(ui, |ui| {
        for (name, milliseconds) in &picture.passes {
            ui.label(name);
            ui.monospace(format!("{milliseconds:9.2} ms"));
            ui.end_row();
        }
    });
    ui.label(format!("{:.1} pictures a second", window.rate));
}
