//! Error against time as an inline SVG: both axes logarithmic, a method's qualities joined by a line, and the Pareto front,
//! than which nothing is both faster and better, drawn as the steps that it is.

use super::summary::{Kind, Line};
use super::{pareto, times};
use std::fmt::Write;
use std::ops::Range;

/// Size of the picture, and of what is around the plot, in its own units.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 16.0;
const BOTTOM: f64 = 48.0;
/// Height of a line of text, and the mean width of a letter, plain and bold.
const TEXT: f64 = 13.0;
const LETTER: f64 = 6.8;
const BOLD_LETTER: f64 = 7.8;
/// Errors below this are drawn as this: a logarithm has no place for none.
const LEAST: f64 = 1e-6;
/// Colours there are in the page's style sheet.
const COLOURS: usize = 7;

/// A way to measure error.
pub struct Measure {
    /// What the page calls it.
    pub name: &'static str,
    /// What the axis says.
    pub axis: &'static str,
    error: fn(&Line) -> f64,
}

/// The ways to measure error.
pub const MEASURES: [Measure; 3] = [
    Measure { name: "relMSE", axis: "relative mean squared error", error: |line| line.scores.relative_mse },
    Measure { name: "SSIM", axis: "1 − SSIM", error: |line| 1.0 - line.scores.ssim },
    Measure { name: "FLIP", axis: "FLIP", error: |line| line.scores.flip },
];

/// A method in a quality.
struct Point<'a> {
    name: &'a str,
    /// Which of the methods it is.
    family: usize,
    time: f64,
    error: f64,
    on_front: bool,
}

/// A logarithmic axis from one place to another.
struct Axis {
    values: Range<f64>,
    places: Range<f64>,
}

/// A rectangle that something is drawn in: left, top, right, bottom.
type Room = [f64; 4];

/// The plot of some lines' times on the device that most of them have theirs from; nothing where no method
/// has both time and error.
pub fn svg(lines: &[Line], measure: &Measure) -> Option<String> {
    let device = times::device(lines)?;
    let points = points(lines, measure, device);
    let times = Axis::of(points.iter().map(|point| point.time), LEFT..WIDTH - RIGHT)?;
    let own = points.iter().map(|point| point.error);
    let alone = Axis::of(own.clone(), HEIGHT - BOTTOM..TOP)?;
    let levels: Vec<(&str, f64)> = lines
        .iter()
        .filter(|line| line.kind == Kind::Floor)
        .map(|line| (line.name.as_str(), (measure.error)(line)))
        .filter(|(_, error)| *error > 0.0 && alone.is_near(*error))
        .collect();
    let errors = Axis::of(own.chain(levels.iter().map(|level| level.1)), HEIGHT - BOTTOM..TOP)?;
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{} against milliseconds\">",
        escaped(measure.axis)
    );
    draw_axes(&mut svg, &times, &errors, measure, device);
    for (name, error) in levels {
        let y = errors.place(error);
        let _ = write!(
            svg,
            "<path class=\"level\" d=\"M{LEFT} {y:.1}H{:.1}\"/><text class=\"quiet\" x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            WIDTH - RIGHT,
            y - 5.0,
            escaped(name)
        );
    }
    draw_front(&mut svg, &points, &times, &errors);
    draw_families(&mut svg, &points, &times, &errors);
    draw_labels(&mut svg, &points, &times, &errors);
    svg.push_str("</svg>");
    Some(svg)
}

fn points<'a>(lines: &'a [Line], measure: &Measure, device: &str) -> Vec<Point<'a>> {
    let mut families: Vec<&str> = Vec::new();
    let mut points: Vec<Point<'a>> = Vec::new();
    for line in lines.iter().filter(|line| line.kind == Kind::Method) {
        let family = families.iter().position(|method| *method == line.method).unwrap_or_else(|| {
            families.push(&line.method);
            families.len() - 1
        });
        let (time, error) = (line.time_on(Some(device)).unwrap_or(f64::NAN), (measure.error)(line));
        if time > 0.0 && time.is_finite() && error.is_finite() {
            let error = error.max(LEAST);
            points.push(Point { name: &line.name, family, time, error, on_front: false });
        }
    }
    let costs: Vec<[f64; 2]> = points.iter().map(|point| [point.time, point.error]).collect();
    points.iter_mut().zip(pareto::front(&costs)).for_each(|(point, on_front)| point.on_front = on_front);
    points
}

impl Axis {
    /// An axis a little longer than some values are apart; none without a value.
    fn of(values: impl Iterator<Item = f64>, places: Range<f64>) -> Option<Self> {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        let margin = (high / low).powf(0.08).max(1.05);
        (low <= high).then(|| Self { values: low / margin..high * margin, places })
    }

    fn place(&self, value: f64) -> f64 {
        let Range { start, end } = &self.values;
        let share = (value / start).ln() / (end / start).ln();
        self.places.start + share * (self.places.end - self.places.start)
    }

    /// Whether a value can be shown, too, without all others being pressed into less than half of the axis.
    fn is_near(&self, value: f64) -> bool {
        let place = self.place(value);
        let Range { start, end } = self.places;
        (place - 0.5 * (start + end)).abs() <= 1.5 * (end - start).abs()
    }

    /// Round values along it: every so much where it is short, else a few of each decade where there are few.
    fn ticks(&self) -> Vec<f64> {
        let Range { start, end } = self.values;
        let decades = (end / start).log10();
        if decades < 0.5 {
            let step = round_step((end - start) / 5.0);
            let ticks = (start / step).ceil() as i64..=(end / step).floor() as i64;
            return ticks.map(|tick| tick as f64 * step).collect();
        }
        let steps: &[f64] = if decades < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let (low, high) = (start.log10().floor() as i32, end.log10().ceil() as i32);
        let ticks = (low..=high).flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
        ticks.filter(|tick| self.values.contains(tick)).collect()
    }
}

/// The nearest of 1, 2, 5, 10 times a power of ten that is not below a step.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|round| *round >= step).unwrap_or(step)
}

fn draw_axes(svg: &mut String, times: &Axis, errors: &Axis, measure: &Measure, device: &str) {
    let bottom = HEIGHT - BOTTOM;
    for time in times.ticks() {
        let x = times.place(time);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{x:.1} {TOP}V{bottom}\"/><text class=\"quiet\" x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{}</text>",
            bottom + 17.0,
            short(time)
        );
    }
    for error in errors.ticks() {
        let y = errors.place(error);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{:.1}\"/><text class=\"quiet\" x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 8.0,
            y + 4.0,
            short(error)
        );
    }
    let (middle, centre) = (0.5 * (LEFT + WIDTH - RIGHT), 0.5 * (TOP + bottom));
    let _ = write!(
        svg,
        "<text class=\"quiet\" x=\"{middle}\" y=\"{:.1}\" text-anchor=\"middle\">milliseconds on {}</text><text class=\"quiet\" \
         transform=\"translate(14 {centre}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        HEIGHT - 10.0,
        escaped(device),
        escaped(measure.axis)
    );
}

/// The front as steps: whoever has that much time has at best that error.
fn draw_front(svg: &mut String, points: &[Point<'_>], times: &Axis, errors: &Axis) {
    let mut front: Vec<&Point<'_>> = points.iter().filter(|point| point.on_front).collect();
    front.sort_by(|a, b| a.time.total_cmp(&b.time));
    let Some((first, rest)) = front.split_first() else { return };
    let mut path = format!("M{:.1} {TOP}V{:.1}", times.place(first.time), errors.place(first.error));
    for point in rest {
        let _ = write!(path, "H{:.1}V{:.1}", times.place(point.time), errors.place(point.error));
    }
    let _ = write!(svg, "<path class=\"front\" d=\"{path}H{:.1}\"/>", WIDTH - RIGHT);
}

/// A line through each method's qualities, and a dot for each; those on the front have a ring.
fn draw_families(svg: &mut String, points: &[Point<'_>], times: &Axis, errors: &Axis) {
    let place = |point: &Point<'_>| (times.place(point.time), errors.place(point.error));
    let count = points.iter().map(|point| point.family + 1).max().unwrap_or(0);
    for family in 0..count {
        let mut own: Vec<&Point<'_>> = points.iter().filter(|point| point.family == family).collect();
        own.sort_by(|a, b| a.time.total_cmp(&b.time));
        let colour = family % COLOURS;
        if own.len() > 1 {
            let places: Vec<String> =
                own.iter().map(|p| place(p)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let _ = write!(svg, "<polyline class=\"c{colour}\" points=\"{}\"/>", places.join(" "));
        }
        for point in own {
            let (x, y) = place(point);
            if point.on_front {
                let _ = write!(svg, "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"8\"/>");
            }
            let _ = write!(
                svg,
                "<circle class=\"dot c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"><title>{}: {} ms, {}{}</title></circle>",
                escaped(point.name),
                short(point.time),
                short(point.error),
                if point.on_front { ", on the Pareto front" } else { "" }
            );
        }
    }
}

/// Names beside their dots, each at the first of some places around it where nothing else is; those on the front first.
fn draw_labels(svg: &mut String, points: &[Point<'_>], times: &Axis, errors: &Axis) {
    let around = |x: f64, y: f64, by: f64| [x - by, y - by, x + by, y + by];
    let mut taken: Vec<Room> =
        points.iter().map(|point| around(times.place(point.time), errors.place(point.error), 6.0)).collect();
    let mut order: Vec<&Point<'_>> = points.iter().collect();
    order.sort_by_key(|point| !point.on_front);
    for point in order {
        let (x, y) = (times.place(point.time), errors.place(point.error));
        let letter = if point.on_front { BOLD_LETTER } else { LETTER };
        let width = letter * point.name.chars().count() as f64;
        let free = |room: &Room| {
            let inside = room[0] >= LEFT && room[2] <= WIDTH && room[1] >= 0.0 && room[3] <= HEIGHT - BOTTOM;
            inside && !taken.iter().any(|other| meet(room, other))
        };
        let places = label_places(x, y, width);
        let room = places.iter().copied().find(free).unwrap_or(places[0]);
        taken.push(room);
        let class = if point.on_front { "name best" } else { "name" };
        let _ = write!(
            svg,
            "<text class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            room[0],
            room[3] - 3.0,
            escaped(point.name)
        );
    }
}

/// Where the name of a dot may stand, the best place first.
fn label_places(x: f64, y: f64, width: f64) -> Vec<Room> {
    const GAP: f64 = 11.0;
    let room = |left: f64, top: f64| [left, top, left + width, top + TEXT];
    let (right, left, middle) = (x + GAP, x - GAP - width, x - 0.5 * width);
    let mut places = vec![
        room(right, y - 0.5 * TEXT),
        room(left, y - 0.5 * TEXT),
        room(middle, y - GAP - TEXT),
        room(middle, y + GAP),
    ];
    for step in [1.0, 2.0, 3.0] {
        for side in [right, left] {
            places.extend([room(side, y - (0.5 + step) * TEXT), room(side, y + (step - 0.5) * TEXT)]);
        }
    }
    places
}

fn meet(a: &Room, b: &Room) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// A number with as many digits as axes need.
fn short(value: f64) -> String {
    let digits = (2 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Text that opens no element.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::metrics::Scores;

    fn line(name: &str, kind: Kind, milliseconds: Option<f64>, error: f64) -> Line {
        let scores = Scores { ssim: 1.0 - error, psnr: 20.0, flip: error, relative_mse: error };
        let method = name.split('-').next().unwrap_or_default().to_owned();
        let (clock, device) = ("wall clock", "<a card>".to_owned());
        let (label, name) = (name.to_owned(), name.to_owned());
        Line { name, label, kind, method, file: None, scores, milliseconds, clock, device }
    }

    #[test]
    fn every_method_is_a_dot_with_its_name_and_the_front_is_marked() {
        let lines = [
            line("fast-low", Kind::Method, Some(1.0), 0.3),
            line("fast", Kind::Method, Some(10.0), 0.1),
            line("slow<", Kind::Method, Some(100.0), 0.2),
            line("white image", Kind::Floor, None, 0.9),
        ];
        let svg = svg(&lines, &MEASURES[0]).expect("a plot");
        assert_eq!(svg.matches("class=\"dot ").count(), 3);
        assert_eq!(svg.matches("class=\"ring\"").count(), 2, "who is slower and worse is beaten");
        assert_eq!(svg.matches("<polyline").count(), 1, "qualities of one method are joined");
        assert_eq!(svg.matches("class=\"front\"").count(), 1);
        for name in
            [">fast-low<", ">fast<", ">slow&lt;<", ">white image<", ">milliseconds on &lt;a card&gt;<"]
        {
            assert!(svg.contains(name), "{name} in {svg}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn times_of_two_devices_are_not_joined() {
        let here = [line("gtao", Kind::Method, Some(10.0), 0.1), line("hbao", Kind::Method, Some(5.0), 0.2)];
        let elsewhere =
            Line { device: "a processor".to_owned(), ..line("fast", Kind::Method, Some(1.0), 0.05) };
        let all = [here.to_vec(), vec![elsewhere]].concat();
        let plot = |lines: &[Line]| svg(lines, &MEASURES[0]).expect("a plot");
        assert_eq!(plot(&all), plot(&here), "who ran elsewhere beats nobody and has no dot");
        let same = [here.to_vec(), vec![line("fast", Kind::Method, Some(1.0), 0.05)]].concat();
        assert_eq!(plot(&same).matches("class=\"ring\"").count(), 1, "on the same device it beats both");
    }

    #[test]
    fn nothing_to_show_is_no_plot_and_a_perfect_image_has_a_place() {
        let floor = line("white image", Kind::Floor, None, 0.9);
        assert_eq!(svg(std::slice::from_ref(&floor), &MEASURES[0]), None);
        assert_eq!(svg(&[line("a", Kind::Method, Some(1.0), f64::NAN), floor], &MEASURES[1]), None);
        let perfect = svg(&[line("a", Kind::Method, Some(1.0), 0.0)], &MEASURES[1]).expect("a plot");
        assert!(perfect.contains("class=\"dot ") && !perfect.contains("NaN") && !perfect.contains("inf"));
    }

    #[test]
    fn axes_go_by_factors_and_ticks_are_round() {
        let axis = Axis::of([1.0, 100.0].into_iter(), 0.0..100.0).expect("an axis");
        assert!((axis.place(10.0) - 50.0).abs() < 1e-9);
        assert!(axis.ticks().contains(&10.0) && axis.ticks().len() >= 3, "{:?}", axis.ticks());
        let short_axis = Axis::of([0.476, 0.49].into_iter(), 100.0..0.0).expect("an axis");
        assert_eq!(short_axis.ticks().into_iter().map(short).collect::<Vec<_>>(), ["0.46", "0.48", "0.5"]);
        assert!(short_axis.is_near(0.5) && !short_axis.is_near(0.988), "it would press them flat");
        assert_eq!([0.05, 20.0, 1500.0, 0.0001].map(short), ["0.05", "20", "1500", "0.0001"]);
    }

    #[test]
    fn names_do_not_stand_on_each_other() {
        // Dots nearer to each other than names are long, since others stretch the axis.
        let times = [1.0, 10.0, 10.2, 10.4, 10.6, 10.8, 1000.0];
        let lines: Vec<Line> = times
            .iter()
            .enumerate()
            .map(|(i, time)| line(&format!("method{i}"), Kind::Method, Some(*time), 0.2))
            .collect();
        let svg = svg(&lines, &MEASURES[2]).expect("a plot");
        let number = |text: &str, key: &str| -> f64 {
            let value = text.split(key).nth(1).and_then(|rest| rest.split('"').next());
            value.and_then(|value| value.parse().ok()).expect("a number")
        };
        let room = |text: &str| -> Room {
            let letter = if text.starts_with(" best") { BOLD_LETTER } else { LETTER };
            let (left, bottom) = (number(text, " x=\""), number(text, " y=\"") + 3.0);
            [left, bottom - TEXT, left + letter * "method0".len() as f64, bottom]
        };
        let rooms: Vec<Room> = svg.split("<text class=\"name").skip(1).map(room).collect();
        assert_eq!(rooms.len(), times.len());
        for (i, room) in rooms.iter().enumerate() {
            // Places are written with one digit.
            let inner = [room[0] + 0.1, room[1] + 0.1, room[2] - 0.1, room[3] - 0.1];
            assert!(!rooms[..i].iter().any(|other| meet(&inner, other)), "{rooms:?}");
        }
    }
}
