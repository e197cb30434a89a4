//! The curve on which key frames are set: time to the right, brightness upward.

use super::GlowDesign;
use deepshade_phosphor::wish::{Answer, CurvePoint, FRAMES, Wish, brightness};
use eframe::egui::{Color32, Key, PointerButton, Pos2, Ui};
use egui_plot::{
    HoverPosition, Legend, Line, Plot, PlotBounds, PlotPoints, PlotResponse, Points, VLine,
    uniform_grid_spacer,
};

/// Height of the curve, points.
const HEIGHT: f32 = 190.0;
/// How near to a key the pointer takes hold of it, points.
const GRIP: f64 = 9.0;
/// Room below keys that are black, of the height.
const BELOW: f64 = 0.04;
/// What the place gave back before.
const GREY: Color32 = Color32::from_gray(120);
/// What it gives back by what was found.
const GREEN: Color32 = Color32::from_rgb(120, 230, 150);
/// What is wanted.
const YELLOW: Color32 = Color32::from_rgb(255, 220, 120);

/// Shows it, with the moment that the images show, and takes what the mouse does. Whether keys have changed.
pub fn show(ui: &mut Ui, design: &mut GlowDesign, moment: f64) -> bool {
    let answer = design.answer.as_ref().and_then(|(answer, _)| answer.as_ref().ok());
    let Some(wish) = &mut design.wish else { return false };
    let shown = draw(ui, wish, answer, moment);
    take(ui, wish, &shown)
}

fn draw(ui: &mut Ui, wish: &Wish, answer: Option<&Answer>, moment: f64) -> PlotResponse<()> {
    let light = wish.light();
    let (begin, end) = (light.seconds(0), light.seconds(FRAMES));
    let bounds = PlotBounds::from_min_max([begin, -BELOW * wish.top()], [end, wish.top()]);
    let curve = |colours: &[[f64; 3]]| -> PlotPoints<'static> {
        let frames = colours.iter().enumerate();
        frames.map(|(frame, colour)| [light.seconds(frame), brightness(*colour)]).collect()
    };
    let before = curve(wish.before());
    let reached = answer.map(|answer| curve(&answer.reached));
    let selected = wish.selected().map(|key| key.frame);
    let keys = |of_selected: bool| -> PlotPoints<'static> {
        let chosen = wish.keys().iter().filter(|key| (Some(key.frame) == selected) == of_selected);
        chosen.map(|key| wish.point(key)).map(|point| [point.seconds, point.brightness]).collect()
    };
    let (keys, touched) = (keys(false), keys(true));
    plot(wish.top()).show(ui, move |plot| {
        plot.set_plot_bounds(bounds);
        plot.vline(VLine::new("", moment).color(Color32::from_white_alpha(60)).width(1.0));
        plot.line(Line::new("before", before).color(GREY).width(1.0));
        if let Some(reached) = reached {
            plot.line(Line::new("reached", reached).color(GREEN).width(2.0));
        }
        plot.points(Points::new("wanted", keys).color(YELLOW).radius(5.0));
        // Without a name of its own in the legend.
        plot.points(Points::new("", touched).color(Color32::WHITE).radius(6.0));
    })
}

/// The area, of such a height, without what is in it.
fn plot(top: f64) -> Plot<'static> {
    let step = step(top);
    Plot::new("key frames")
        .height(HEIGHT)
        .y_grid_spacer(uniform_grid_spacer(move |_| [step, 5.0 * step, 10.0 * step]))
        .y_axis_formatter(move |mark, _| label(mark.value, step))
        .legend(Legend::default())
        .x_axis_label("time, s")
        .y_axis_label("luminance of radiance")
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\nsecond {:.2}: {:.4}", position.x, position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

/// From line to line of an area of such a height: 1, 2 or 5 times a power of ten, at most five lines.
fn step(top: f64) -> f64 {
    let power = 10f64.powf((top / 5.0).log10().floor());
    let multiple = [1.0, 2.0, 5.0].into_iter().find(|multiple| 5.0 * multiple * power >= top);
    power * multiple.unwrap_or(10.0)
}

/// A multiple of a step, without what rounding adds.
fn label(value: f64, step: f64) -> String {
    let digits = (-step.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

/// Sets keys as the mouse does. Whether any has changed.
fn take(ui: &Ui, wish: &mut Wish, shown: &PlotResponse<()>) -> bool {
    let PlotResponse { response, transform, .. } = shown;
    let point = |at: Pos2| {
        let value = transform.value_from_position(at);
        CurvePoint { seconds: value.x, brightness: value.y }
    };
    let [seconds, brightness] = transform.dvalue_dpos().map(|per_point| GRIP * per_point.abs());
    let reach = CurvePoint { seconds, brightness };
    let pointer = response.interact_pointer_pos().map(point);
    let mut changed = false;
    if response.drag_started_by(PointerButton::Primary)
        && let Some(origin) = ui.input(|input| input.pointer.press_origin())
    {
        wish.grab(point(origin), reach);
    }
    if let Some(pointer) = pointer {
        if response.dragged_by(PointerButton::Primary) {
            changed |= wish.drag(pointer);
        }
        if response.clicked() {
            changed |= wish.click(pointer, reach);
        }
        if response.secondary_clicked() {
            changed |= wish.remove_at(pointer, reach);
        }
    }
    if response.drag_stopped() {
        wish.release();
        // The area is made to suit.
        changed = true;
    }
    let deletes = ui.input(|input| input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace));
    if deletes && !ui.ctx().egui_wants_keyboard_input() {
        changed |= wish.remove_selected();
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_has_a_few_round_lines() {
        for (top, expected) in [(1.0, 0.2), (0.1, 0.02), (0.11, 0.05), (0.26, 0.1), (7.0, 2.0), (2.4, 0.5)] {
            let step = step(top);
            assert!((step / expected - 1.0).abs() < 1e-9, "{top}: {step}");
        }
        assert_eq!([label(3.0 * 0.1, 0.1), label(4e-5, 2e-5), label(40.0, 20.0)], ["0.3", "0.00004", "40"]);
    }
}
