//! Key frames of glow, set with the mouse: a place of the scene, what it should give back when, and the
//! material that comes closest, which the images show at once (thesis, section 8.6).
//!
//! [`place`] finds the place and its light on a thread, [`curve`] is where keys are set,
//! [`deepshade_phosphor::wish`] solves, within a few milliseconds and so in the window's own thread, and
//! [`written`] makes files of it.

mod curve;
pub mod pick;
pub mod place;
pub mod written;

use super::window::Window;
use crate::phosphor::design::task::Task;
use deepshade_glow::material::Material;
use deepshade_glow::spectrum::lights::Light as Spectrum;
use deepshade_phosphor::design::MAX_STATES;
use deepshade_phosphor::wish::{Answer, CurvePoint, FrameLight, Wish, WishError, brightness};
use deepshade_render::scene::glow::Start;
use deepshade_render::scene::{AnimatedScene, Glow};
use eframe::egui::{Button, CollapsingHeader, DragValue, RichText, TextEdit, Ui};
use glam::Vec3;
use place::{Asked, Place, Target};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// What is seen after the last lamp is switched, where nothing else is said, seconds.
const AFTER: f32 = 20.0;
/// How long curves are, seconds.
const LENGTHS: RangeInclusive<f32> = 0.1..=36_000.0;

/// What is designed in the window.
pub struct GlowDesign {
    /// Whether the panel is open, so that a click on an image chooses a place.
    pub is_open: bool,
    /// Where a place is wanted, and the one that was found.
    pub target: Option<Target>,
    /// The place.
    pub place: Option<Place>,
    /// What is wanted there.
    pub wish: Option<Wish>,
    /// What was found for that, and the milliseconds that it took.
    pub answer: Option<(Result<Answer, WishError>, f64)>,
    /// States of what is found.
    pub states: usize,
    /// How long the curve is, seconds.
    pub seconds: Option<f32>,
    /// The folder for files; empty for one that is free.
    pub folder: String,
    /// What glowed before this place was chosen, where that was designed, too.
    pub glow_before: Option<Arc<Glow>>,
    /// The spectrum of all lamps that a file's materials are for.
    pub spectrum: Option<Spectrum>,
    /// Whether what the place reflects is part of what a file wants.
    pub reflected: bool,
    /// Where the place is at a moment, seconds: what moves takes it along.
    pub seen: Option<(f32, Vec3)>,
    /// Keys that a file has: seconds from the beginning of time on, and radiance.
    keys: Vec<(f64, [f64; 3])>,
    /// What was asked of the thread last.
    pub asked: Option<Asked>,
}

impl Default for GlowDesign {
    fn default() -> Self {
        Self {
            is_open: false,
            target: None,
            place: None,
            wish: None,
            answer: None,
            states: 1,
            seconds: None,
            folder: String::new(),
            glow_before: None,
            spectrum: None,
            reflected: false,
            seen: None,
            keys: Vec::new(),
            asked: None,
        }
    }
}

impl GlowDesign {
    /// The first place of a file.
    pub fn of(task: &Task) -> Self {
        let place = task.places.first();
        let radiance = |key| task.bands.linear_srgb(&task.radiance(key));
        let keys = place.iter().flat_map(|place| &place.keys);
        Self {
            is_open: true,
            target: place.map(|place| Target::Point(place.at)),
            states: task.states,
            seconds: Some(task.seconds(task.frames)),
            spectrum: task.spectrum,
            reflected: task.reflected,
            keys: keys.map(|key| (f64::from(key.time), radiance(key))).collect(),
            ..Self::default()
        }
    }

    /// How long the curve is, seconds, of what glows like this.
    pub fn seconds_of(&self, glow: &Glow) -> f32 {
        let switches = glow.schedules.iter().flat_map(|schedule| &schedule.on).flatten().copied();
        let last = switches.filter(|at| at.is_finite()).fold(0.0, f32::max);
        let usual = last - glow.begin() + AFTER;
        self.seconds.unwrap_or(usual).clamp(*LENGTHS.start(), *LENGTHS.end())
    }

    /// When the last key frame is, seconds from the beginning of the curve; 0 without one.
    fn last_key(&self) -> f32 {
        let last = self.wish.as_ref().and_then(|wish| Some((wish.light(), wish.keys().last()?)));
        last.map_or(0.0, |(light, key)| (key.frame as f64 * light.dt()) as f32)
    }

    /// Takes a place that was found, with its light in frames and the material that it has, if that keeps
    /// light. Keys stay where it is the same place. Whether it is.
    pub fn take(&mut self, place: Place, light: FrameLight, material: Option<&Material>) -> bool {
        let before = material.and_then(|material| light.glow(material).ok());
        let before = before.unwrap_or_else(|| light.reflected());
        let is_same = self.place.as_ref().is_some_and(|known| known.spot == place.spot);
        match self.wish.as_mut().filter(|_| is_same) {
            Some(wish) => wish.relight(light, before),
            None => {
                let mut wish = Wish::new(light, before);
                let begin = wish.light().seconds(0);
                for (seconds, radiance) in std::mem::take(&mut self.keys) {
                    let at = CurvePoint { seconds: begin + seconds, brightness: brightness(radiance) };
                    wish.add(at, Some(radiance));
                }
                self.wish = Some(wish);
            }
        }
        (self.place, self.seen) = (Some(place), None);
        is_same
    }

    /// Where the place is at a moment, seconds, metres.
    pub fn seen_at(&mut self, scene: &AnimatedScene, moment: f32) -> Option<Vec3> {
        let spot = &self.place.as_ref()?.spot;
        if let Some((_, at)) = self.seen.filter(|(known, _)| *known == moment) {
            return Some(at);
        }
        let at = spot.between(scene.corners(spot.mesh, spot.triangle, moment)?);
        self.seen = Some((moment, at));
        Some(at)
    }

    /// Whether a place is still looked for.
    pub const fn is_waiting(&self) -> bool {
        matches!(self.target, Some(Target::Ray(_) | Target::Point(_)))
    }

    /// Leaves the scene.
    pub fn leave(&mut self) {
        *self = Self { is_open: self.is_open, states: self.states, ..Self::default() };
    }
}

/// Whether key frames can be set of what glows like this; else why not.
pub const fn refusal(glow: &Glow) -> Option<&'static str> {
    match glow.start {
        Start::Share(0.0) => None,
        _ => Some("a design begins in the dark; this scene's `start` is another one"),
    }
}

/// Shows the panel where something glows.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let Some(glow) = window.glow().cloned() else { return };
    ui.separator();
    let header = CollapsingHeader::new("key frames of glow").default_open(window.design.is_open);
    let shown = header.show(ui, |ui| match refusal(&glow) {
        Some(why) => drop(ui.label(RichText::new(why).weak())),
        None => body(ui, window, &glow),
    });
    window.design.is_open = shown.body_returned.is_some();
    let hint = "what a place should give back when; the material that comes closest is found and shown";
    shown.header_response.on_hover_text(hint);
}

fn body(ui: &mut Ui, window: &mut Window, glow: &Glow) {
    place_in_words(ui, &window.design);
    let mut changed = numbers(ui, &mut window.design, glow);
    let moment = f64::from(window.state.time);
    changed |= curve::show(ui, &mut window.design, moment);
    if changed {
        window.solve();
    }
    if window.design.wish.is_some() {
        let hint = "a click adds a key frame, a drag moves it, a right click or Delete removes it";
        ui.label(RichText::new(hint).small().weak());
    }
    answer(ui, &window.design);
    write(ui, window);
}

fn place_in_words(ui: &mut Ui, design: &GlowDesign) {
    let text = match (&design.place, &design.target) {
        (Some(place), _) => format!("{} at {:.2} m", place.material, place.at),
        (None, Some(_)) => "looking for the place's light".to_owned(),
        (None, None) => "click on a surface in an image to choose a place".to_owned(),
    };
    ui.label(text).on_hover_text(
        "where key frames are of; a click on an image (Ctrl and a click) chooses another place",
    );
    let lamps = design.spectrum.map(|lamp| format!("under {} lamps", lamp.name()));
    let reflected = design.reflected.then(|| "with what it reflects".to_owned());
    let more: Vec<String> = lamps.into_iter().chain(reflected).collect();
    if !more.is_empty() {
        ui.label(RichText::new(more.join(", ")).weak())
            .on_hover_text("as the file with the key frames has it");
    }
}

/// Numbers beside the curve. Whether another material is to be found.
fn numbers(ui: &mut Ui, design: &mut GlowDesign, glow: &Glow) -> bool {
    let mut changed = false;
    ui.horizontal_wrapped(|ui| {
        let mut seconds = design.seconds_of(glow);
        let lengths = design.last_key().max(*LENGTHS.start())..=*LENGTHS.end();
        let length = DragValue::new(&mut seconds).range(lengths).speed(0.1).suffix(" s");
        if ui.add(length).on_hover_text("how long the curve is").changed() {
            design.seconds = Some(seconds);
        }
        for states in 1..=MAX_STATES {
            let name = if states == 1 { "1 state".to_owned() } else { format!("{states} states") };
            let choice = ui.selectable_value(&mut design.states, states, name);
            changed |= choice.on_hover_text("of the material that is found").changed();
        }
        changed |= colour(ui, design);
    });
    changed
}

/// The colour of the key that was touched last, and a button that removes all keys.
fn colour(ui: &mut Ui, design: &mut GlowDesign) -> bool {
    let Some(wish) = &mut design.wish else { return false };
    let (is_touched, is_wanted) = (wish.selected().is_some(), !wish.keys().is_empty());
    let hue = wish.selected().map_or([1.0; 3], |key| key.hue);
    let most = hue.into_iter().fold(0.0, f64::max);
    let mut shown = hue.map(|part| (part / most).max(0.0) as f32);
    let picker = ui.add_enabled_ui(is_touched, |ui| ui.color_edit_button_rgb(&mut shown)).inner;
    let picker = picker.on_disabled_hover_text("no key frame was touched last");
    let mut changed = false;
    if picker.on_hover_text("colour of the key frame that was touched last").changed() {
        changed |= wish.set_hue(shown.map(f64::from));
    }
    let none = ui.add_enabled(is_wanted, Button::new("none"));
    let none = none.on_disabled_hover_text("there are no key frames");
    if none.on_hover_text("removes all key frames").clicked() {
        changed |= wish.clear();
    }
    changed
}

fn answer(ui: &mut Ui, design: &GlowDesign) {
    let Some((answer, milliseconds)) = &design.answer else { return };
    match answer {
        Ok(answer) => {
            answer.in_words().into_iter().for_each(|line| drop(ui.label(line)));
            let time = RichText::new(format!("found in {milliseconds:.1} ms")).small().weak();
            ui.label(time);
        }
        Err(error) => drop(ui.label(RichText::new(error.to_string()).weak())),
    }
}

/// The button that writes files.
fn write(ui: &mut Ui, window: &mut Window) {
    let is_found = matches!(&window.design.answer, Some((Ok(_), _)));
    ui.horizontal_wrapped(|ui| {
        let folder = TextEdit::singleline(&mut window.design.folder).hint_text("design-1, design-2, ...");
        ui.add(folder.desired_width(140.0)).on_hover_text("the folder that is written; by default a new one");
        let button = ui.add_enabled(is_found, Button::new("write"));
        let button = button.on_disabled_hover_text("no material was found yet");
        let hint = "wanted.toml, which `phosphor design` reads, and glow.toml, which --phosphor shows";
        if button.on_hover_text(hint).clicked() {
            window.write_design();
        }
    });
}
