//! Figures under the choices: truth, metrics, and times of passes.

use super::window::Window;
use eframe::egui::{DragValue, Grid, RichText, Ui};

/// Whether there is truth, and how well it is known.
pub fn truth(ui: &mut Ui, window: &mut Window) {
    ui.horizontal_wrapped(|ui| {
        let hint = "whether truth is path-traced while nothing moves: T";
        ui.checkbox(&mut window.state.truth, "truth, up to").on_hover_text(hint);
        let samples = DragValue::new(&mut window.state.samples).range(8..=16_384);
        let samples = samples.clamp_existing_to_range(false).suffix(" samples");
        ui.add(samples).on_hover_text("samples of a pixel at which truth rests");
    });
    if let Some(truth) = window.truth_of_picture() {
        let noise = 100.0 * truth.noise;
        ui.label(format!("{} samples in {:.1} s, noise {noise:.1} %", truth.samples, truth.seconds));
    }
}

/// How far methods are from the reference.
pub fn metrics(ui: &mut Ui, window: &Window) {
    let Some(metrics) = window.metrics_of_picture() else { return };
    Grid::new("figures").striped(true).show(ui, |ui| {
        for head in [metrics.key.against, "SSIM", "FLIP", "relMSE"] {
            ui.strong(head);
        }
        ui.end_row();
        let images = metrics.images.iter().map(|image| (image.name.as_str(), image.scores));
        let ceiling = window.ceiling().map(|ceiling| ("half against half", ceiling));
        for (name, scores) in images.chain(ceiling) {
            ui.label(name);
            ui.monospace(format!("{:.3}", scores.ssim));
            ui.monospace(format!("{:.3}", scores.flip));
            ui.monospace(format!("{:.4}", scores.relative_mse));
            ui.end_row();
        }
    });
    if let Some(said) = window.ceiling().and_then(|ceiling| metrics.within_noise(ceiling)) {
        ui.label(RichText::new(said).small());
    }
}

/// What passes cost.
pub fn passes(ui: &mut Ui, window: &Window) {
    let Some(picture) = &window.results.picture else { return };
    ui.separator();
    Grid::new("passes").striped(true).show(ui, |ui| {
        for (name, milliseconds) in &picture.passes {
            ui.label(name);
            ui.monospace(format!("{milliseconds:9.2} ms"));
            ui.end_row();
        }
    });
    ui.label(format!("{:.1} pictures a second", window.results.rate));
}
