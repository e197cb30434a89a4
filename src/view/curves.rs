//! A training run beside the images: how far it is, and its loss over its steps.

use super::trainer;
use super::training::Training;
use super::window::Window;
use deepshade_train::metrics::Line;
use eframe::egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

/// Height of the curves, points.
const HEIGHT: f32 = 130.0;
/// Room for the numbers left of them, points.
const MARGIN: f32 = 34.0;
/// Losses below are drawn as this, since the scale is logarithmic.
const LEAST: f32 = 1e-6;
/// The most points of a curve: a long log has more lines than the panel has columns.
const POINTS: usize = 400;
/// Loss of training crops.
const GREY: Color32 = Color32::from_gray(130);
/// DSSIM of validation.
const BLUE: Color32 = Color32::from_rgb(90, 170, 255);

/// Shows what can be trained, and the run whose weights the window follows, if it does.
pub fn show(ui: &mut Ui, window: &mut Window) {
    ui.separator();
    trainer::show(ui, window);
    let Some(training) = window.training_of_model() else { return };
    ui.separator();
    let what = if training.is_taken { "training" } else { "run" };
    ui.strong(format!("{what} {}", training.folder.display()));
    ui.label(progress(training));
    if let Some((progress, _)) = &training.checkpoint {
        let best = progress.best().map(|(step, loss)| format!(", validated best at {step}: {loss:.4}"));
        ui.label(format!("weights of step {}{}", progress.step, best.unwrap_or_default()));
    }
    curves(ui, training);
}

/// How far it is and how long it takes yet.
fn progress(training: &Training) -> String {
    if !training.is_taken && !training.is_over() {
        let [step, steps] = [training.step(), training.steps];
        return format!("stopped at step {step} of {steps}; the same wish goes on");
    }
    let left = match training.seconds_left() {
        Some(seconds) => format!(", {} left", duration(seconds)),
        None if training.is_over() => ", done".to_owned(),
        None => String::new(),
    };
    format!("step {} of {}{left}", training.step(), training.steps)
}

/// Seconds in the largest units that suit.
fn duration(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 100.0 => format!("{seconds:.0} s"),
        seconds if seconds < 6000.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

/// Steps and losses, and where they lie.
struct Chart {
    place: Rect,
    steps: f32,
    /// Logarithms of the lowest and the highest loss.
    range: [f32; 2],
}

impl Chart {
    fn new(place: Rect, steps: usize, losses: impl Iterator<Item = f32>) -> Self {
        let logarithms = losses.filter(|loss| loss.is_finite()).map(|loss| loss.max(LEAST).ln());
        let [low, high] =
            logarithms.fold([f32::MAX, f32::MIN], |[low, high], it| [low.min(it), high.max(it)]);
        let [low, high] = if low <= high { [low, high] } else { [LEAST.ln(), 0.0] };
        Self { place, steps: steps.max(1) as f32, range: [low - 0.1, high + 0.1] }
    }

    fn at(&self, step: usize, loss: f32) -> Pos2 {
        let [low, high] = self.range;
        let share = (loss.max(LEAST).ln() - low) / (high - low);
        let x = self.place.left() + step as f32 / self.steps * self.place.width();
        pos2(x, self.place.bottom() - share * self.place.height())
    }
}

fn curves(ui: &mut Ui, training: &Training) {
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let place = Rect::from_min_max(area.min + vec2(MARGIN, 4.0), area.max - vec2(6.0, 18.0));
    let painter = ui.painter();
    painter.rect_filled(place, 2.0, Color32::from_gray(18));
    let trained: Vec<(usize, f32)> = training.lines.iter().map(|line| (line.step, line.loss)).collect();
    let validated: Vec<(usize, f32)> =
        training.lines.iter().filter_map(|line| Some((line.step, line.validation_loss?))).collect();
    let chart = Chart::new(place, training.steps, trained.iter().chain(&validated).map(|point| point.1));
    let font = FontId::proportional(10.0);
    let number = |at: Pos2, align: Align2, text: String, colour: Color32| {
        painter.text(at, align, text, font.clone(), colour);
    };
    let [low, high] = chart.range.map(f32::exp);
    number(place.left_top(), Align2::RIGHT_TOP, format!("{high:.3} "), GREY);
    number(place.left_bottom(), Align2::RIGHT_BOTTOM, format!("{low:.3} "), GREY);
    let under = place.left_bottom() + vec2(0.0, 2.0);
    number(under, Align2::LEFT_TOP, "loss of crops".to_owned(), GREY);
    number(under + vec2(76.0, 0.0), Align2::LEFT_TOP, "DSSIM of validation".to_owned(), BLUE);
    for (points, colour, width) in [(&trained, GREY, 1.0), (&validated, BLUE, 2.0)] {
        let points: Vec<Pos2> = thinned(points).map(|(step, loss)| chart.at(step, loss)).collect();
        if let [one] = points[..] {
            painter.circle_filled(one, 2.0, colour);
        }
        painter.add(Shape::line(points, Stroke::new(width, colour)));
    }
    let pointed = response.hover_pos().filter(|at| place.contains(*at));
    if let Some(line) =
        pointed.and_then(|at| nearest(&training.lines, (at.x - place.left()) / place.width() * chart.steps))
    {
        painter.vline(
            chart.at(line.step, 1.0).x,
            place.y_range(),
            Stroke::new(1.0, Color32::from_white_alpha(60)),
        );
        response.on_hover_text(said(line));
    }
}

/// At most [`POINTS`] of a curve's points, the last among them.
fn thinned(points: &[(usize, f32)]) -> impl Iterator<Item = (usize, f32)> {
    let each = points.len().div_ceil(POINTS).max(1);
    let last = points.len().saturating_sub(1);
    points
        .iter()
        .enumerate()
        .filter(move |(index, _)| (last - index).is_multiple_of(each))
        .map(|(_, point)| *point)
}

/// The line of the log nearest to a step.
fn nearest(lines: &[Line], step: f32) -> Option<&Line> {
    lines.iter().min_by(|a, b| (a.step as f32 - step).abs().total_cmp(&(b.step as f32 - step).abs()))
}

fn said(line: &Line) -> String {
    let validation = line.validation_loss.map(|loss| format!("\nDSSIM of validation {loss:.5}"));
    format!("step {}\nloss of crops {:.5}{}", line.step, line.loss, validation.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lower_losses_are_lower_and_later_steps_further_right() {
        let place = Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0));
        let chart = Chart::new(place, 1000, [0.5, 0.05, f32::NAN].into_iter());
        let [first, last] = [chart.at(100, 0.5), chart.at(900, 0.05)];
        assert!(first.x < last.x && first.y < last.y && place.contains(first) && place.contains(last));
        let middle = chart.at(500, (0.5f32 * 0.05).sqrt());
        assert!(middle.distance(place.center()) < 0.01, "the scale is logarithmic: {middle}");
        let nothing = Chart::new(place, 0, std::iter::empty());
        assert!(nothing.at(0, 0.0).y.is_finite());
    }

    #[test]
    fn long_curves_are_thinned_and_keep_their_end() {
        for count in [0, 1, POINTS, 12_345] {
            let points: Vec<(usize, f32)> = (0..count).map(|step| (step, 0.1)).collect();
            let kept: Vec<(usize, f32)> = thinned(&points).collect();
            assert!(kept.len() <= POINTS && kept.last() == points.last(), "{count}: {}", kept.len());
        }
        assert_eq!([3.0, 90.0, 9e4].map(duration), ["3 s", "90 s", "25.0 h"]);
    }
}
