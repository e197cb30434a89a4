//! Trainings beside the images: what to train, how far a run is, and its loss over its steps.

use super::training_process::TrainingOptions;
use super::training_run::TrainingRun;
use super::window::Window;
use deepshade_train::metrics::Line;
use eframe::egui::{Button, Color32, TextEdit, Ui};
use egui_plot::{HoverPosition, Legend, Plot, PlotPoints};

/// Height of the curves, points.
const HEIGHT: f32 = 160.0;
/// Losses below are drawn as this, since the scale is logarithmic.
const LEAST: f32 = 1e-6;
/// Loss of training crops.
const GREY: Color32 = Color32::from_gray(130);
/// DSSIM of validation.
const BLUE: Color32 = Color32::from_rgb(90, 170, 255);

/// Shows what can be trained, and the run whose weights the window follows, if it does.
pub fn show(ui: &mut Ui, window: &mut Window) {
    ui.separator();
    choices(ui, window);
    let Some(run) = window.training_of_model() else { return };
    ui.separator();
    let what = if run.is_taken { "training" } else { "run" };
    ui.strong(format!("{what} {}", run.folder.display()));
    ui.label(progress(run));
    if let Some((progress, _)) = &run.checkpoint {
        let best = progress.best().map(|(step, loss)| format!(", validated best at {step}: {loss:.4}"));
        ui.label(format!("weights of step {}{}", progress.step, best.unwrap_or_default()));
    }
    curves(ui, run);
}

/// What the user can train, or stop.
fn choices(ui: &mut Ui, window: &mut Window) {
    if let Some(process) = &window.training.process {
        ui.horizontal_wrapped(|ui| {
            ui.label(format!("training {}", process.folder.display()));
            let hint = "the same choice goes on from its newest checkpoint; the window's end stops it, too";
            if ui.button("stop").on_hover_text(hint).clicked() {
                process.stop();
            }
        });
        return;
    }
    let training = ui.collapsing("train a network", |ui| {
        let usual = window.training.options.folder().display().to_string();
        let TrainingOptions { dataset, run, options } = &mut window.training.options;
        let field = |text, hint: &str| TextEdit::singleline(text).hint_text(hint.to_owned());
        ui.add(field(dataset, "folder of a dataset")).on_hover_text("what `deepshade dataset generate` made");
        let run = ui.add(field(run, &format!("folder of the run: {usual}")));
        run.on_hover_text("where checkpoints are kept; a run that lies there goes on");
        let options = ui.add(field(options, "options, such as --steps 20000"));
        options.on_hover_text("what else `deepshade train` is told");
        let train = ui.add_enabled(!dataset.trim().is_empty(), Button::new("train"));
        let train = train.on_disabled_hover_text("the folder of a dataset is missing");
        if train.on_hover_text("begins; the network is shown as it learns").clicked() {
            window.begin_training();
        }
    });
    training.header_response.on_hover_text("of a dataset, beside the images, by `deepshade train`");
}

/// How far it is and how long it takes yet.
fn progress(run: &TrainingRun) -> String {
    if !run.is_taken && !run.is_over() {
        let [step, steps] = [run.step(), run.steps];
        return format!("stopped at step {step} of {steps}; the same choice goes on");
    }
    let left = match run.seconds_left() {
        Some(seconds) => format!(", {} left", duration(seconds)),
        None if run.is_over() => ", done".to_owned(),
        None => String::new(),
    };
    format!("step {} of {}{left}", run.step(), run.steps)
}

/// Seconds in the largest units that suit.
fn duration(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 100.0 => format!("{seconds:.0} s"),
        seconds if seconds < 6000.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

/// Losses over steps, on a logarithmic scale.
fn curves(ui: &mut Ui, run: &TrainingRun) {
    let of_crops = curve(&run.lines, |line| Some(line.loss));
    let validated = curve(&run.lines, |line| line.validation_loss);
    let plot = Plot::new("loss")
        .height(HEIGHT)
        .include_x(0.0)
        .include_x(run.steps as f64)
        .legend(Legend::default())
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .y_axis_formatter(|mark, _| format!("{:.3}", 10f64.powf(mark.value)))
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\nstep {:.0}: {:.5}", position.x, 10f64.powf(position.y)))
            }
            HoverPosition::Elsewhere { .. } => None,
        });
    plot.show(ui, |plot| {
        plot.line(egui_plot::Line::new("loss of crops", of_crops).color(GREY).width(1.0));
        plot.line(egui_plot::Line::new("DSSIM of validation", validated).color(BLUE).width(2.0));
    });
}

/// Steps and logarithms of losses.
fn curve(lines: &[Line], loss: impl Fn(&Line) -> Option<f32>) -> PlotPoints<'static> {
    let point = |line: &Line| Some([line.step as f64, f64::from(loss(line)?.max(LEAST).log10())]);
    lines.iter().filter_map(point).filter(|point| point[1].is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_drawn_by_their_logarithms() {
        let line =
            |step, loss| Line { step, loss, validation_loss: None, rate: 1e-3, images_per_second: 1.0 };
        let lines = [line(20, 0.1), line(40, 0.0), line(60, f32::INFINITY)];
        let points = curve(&lines, |line| Some(line.loss));
        let heights: Vec<f64> = points.points().iter().map(|point| point.y.round()).collect();
        assert_eq!(heights, [-1.0, -6.0]);
        assert!(curve(&lines, |line| line.validation_loss).points().is_empty());
        assert_eq!([3.0, 90.0, 9e4].map(duration), ["3 s", "90 s", "25.0 h"]);
    }
}
