//! Sliders, boxes and lists for what can be set of the methods that are shown: names, ranges, units, texts
//! and what is usual are the parameters' own.

use super::state::State;
use crate::methods;
use deepshade_render::methods::dials::{Dial, Values};
use eframe::egui::{Button, CollapsingHeader, ComboBox, RichText, Slider, SliderClamping, Ui};

/// Shows them, a method under the other.
pub fn show(ui: &mut Ui, state: &mut State) {
    for method in state.show.methods.clone() {
        let (effect, quality) = (state.show.effect, state.show.quality);
        let is_changed = state.show.changes.contains_key(method);
        let title = if is_changed { format!("{method}, changed") } else { method.to_owned() };
        let header = CollapsingHeader::new(title).id_salt(method).show(ui, |ui| {
            let dials = methods::dials(effect, method, quality).unwrap_or_default();
            if dials.is_empty() {
                ui.label(RichText::new("nothing to set").weak());
            }
            for dial in dials {
                row(ui, state, method, &dial);
            }
        });
        header.header_response.on_hover_text(format!("what can be set of {method}"));
    }
}

/// A dial: its slider, and a button that puts it back.
fn row(ui: &mut Ui, state: &mut State, method: &'static str, dial: &Dial) {
    let changed = state.show.changes.get(method).and_then(|changes| changes.0.get(&dial.name));
    let changed = changed.and_then(|setting| dial.number(setting).ok());
    let mut value = changed.unwrap_or(dial.usual);
    ui.horizontal_wrapped(|ui| {
        let response = match &dial.values {
            Values::Switch => {
                let mut on = value == 1.0;
                let response = ui.checkbox(&mut on, &dial.name);
                value = f64::from(u8::from(on));
                response
            }
            Values::Named(names) => {
                let mut chosen = value as usize;
                let choice = ComboBox::from_id_salt(&dial.name);
                let mut response = choice.show_index(ui, &mut chosen, names.len(), |at| names[at].clone());
                value = chosen as f64;
                response |= ui.label(&dial.name);
                response
            }
            Values::Real | Values::Whole(_) => ui.add(slider(&mut value, dial)),
        };
        if response.on_hover_text(&dial.text).changed() {
            state.set(method, dial, value);
        }
        let usual = ui.add_enabled(changed.is_some(), Button::new("usual"));
        let usual = usual.on_disabled_hover_text("it is as the quality has it");
        if usual.on_hover_text("as the quality has it").clicked() {
            state.set(method, dial, dial.usual);
        }
    });
}

fn slider<'a>(value: &'a mut f64, dial: &Dial) -> Slider<'a> {
    let [least, most] = dial.range;
    let is_wide = most > 100.0 * least.max(1.0);
    let suffix = if dial.unit.is_empty() { String::new() } else { format!(" {}", dial.unit) };
    let slider = Slider::new(value, least..=most).clamping(SliderClamping::Always).logarithmic(is_wide);
    let slider = slider.suffix(suffix).text(&dial.name);
    match dial.values {
        Values::Whole(of) => slider.step_by(f64::from(of)).fixed_decimals(0),
        Values::Real | Values::Switch | Values::Named(_) => slider,
    }
}
