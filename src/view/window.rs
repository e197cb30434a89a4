//! The window: hears what the threads have made, orders what hands want next, shows it.

mod files;
mod hearing;
mod motion;
mod orders;
mod screen;
#[cfg(feature = "train")]
mod training;
mod words;

use super::canvas;
use super::desk::Desk;
use super::film::Recording;
use super::judge::Verdict;
use super::layers::{Choice, Opened};
use super::outcome::Outcome;
use super::panel;
use super::pictures::Developed;
use super::script::{Progress, Script};
use super::state::{Map, State};
use super::studio::{Order, Picture};
use super::subject::Subject;
#[cfg(feature = "train")]
use super::trainer::{Trainer, Wish};
#[cfg(feature = "train")]
use super::training::Training;
use super::truth::{self, Truth};
use crate::methods::TRUTH;
use crate::render::picture::Exposure;
use deepshade_render::metrics::Scores;
use eframe::egui::{self, CentralPanel, ColorImage, Context, Frame, Panel, TextureHandle};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// For how long nobody must have moved before truth begins.
const STILL: Duration = Duration::from_millis(250);

/// A picture of the whole window, and the file that it is for, or one that is free.
type Shot = (Arc<ColorImage>, Option<PathBuf>);

/// An order that is being worked on.
struct Ordered {
    order: Order,
    since: Instant,
    /// Hands have chosen another scene or effect meanwhile: nobody wants the picture any more.
    outdated: bool,
}

/// The window.
pub struct Window {
    /// What hands have chosen.
    pub state: State,
    /// The scene.
    pub subject: Option<Arc<Subject>>,
    /// The newest picture.
    pub picture: Option<Arc<Picture>>,
    /// The newest truth, of whatever.
    pub truth: Option<Truth>,
    /// What is said of the newest picture.
    pub verdict: Option<Verdict>,
    /// What could not be done last.
    pub message: Option<String>,
    /// What could not be done and no script has waited for.
    pub unheard: Vec<String>,
    /// What was done last that nothing else shows.
    pub note: Option<String>,
    /// Pictures a second.
    pub rate: f32,
    /// The EXR file beside the methods.
    pub opened: Option<Opened>,
    /// Which of its layers are to be seen.
    pub layers: Vec<String>,
    /// Pictures of these.
    pub developed: Vec<Developed>,
    /// The choice of layers that was ordered last.
    pub developing: Option<Choice>,
    /// Whether it is still to come.
    pub develops: bool,
    /// The film that is being recorded.
    pub recording: Option<Recording>,
    /// Errands that are not run yet.
    pub errands: usize,
    /// Pictures of the window that are there, and where they are to be written.
    taken: Arc<Mutex<Vec<Shot>>>,
    /// How many are still to come.
    shots: usize,
    desk: Desk,
    script: Option<Script>,
    outcome: Arc<Mutex<Outcome>>,
    began: Instant,
    moved: Instant,
    /// When the message or the note was said.
    said: Instant,
    /// What is being worked on.
    ordered: Option<Ordered>,
    /// What the newest picture was ordered as.
    made: Option<Order>,
    /// The order that could not be made last.
    refused: Option<Order>,
    asked: Option<truth::Order>,
    /// The picture's number, what it was held against, and truth's samples that the judge has seen last.
    judged: Option<(u32, &'static str, u32)>,
    /// When the animation was advanced last.
    played: Option<Instant>,
    exposure: Option<Exposure>,
    /// What hands want to be trained.
    #[cfg(feature = "train")]
    pub wish: Wish,
    /// The training that they have begun, while it runs.
    #[cfg(feature = "train")]
    pub trainer: Option<Trainer>,
    /// What is known of a training run.
    #[cfg(feature = "train")]
    training: Option<Training>,
    /// The network's folder that the follower knows of.
    #[cfg(feature = "train")]
    followed: Option<PathBuf>,
    textures: HashMap<(String, Map), TextureHandle>,
}

impl Window {
    /// A window before its first picture, of a program that `began` some time ago.
    pub fn new(
        state: State,
        desk: Desk,
        script: Option<Script>,
        outcome: Arc<Mutex<Outcome>>,
        began: Instant,
    ) -> Self {
        Self {
            state,
            subject: None,
            picture: None,
            truth: None,
            verdict: None,
            message: None,
            unheard: Vec::new(),
            note: None,
            said: Instant::now(),
            rate: 0.0,
            opened: None,
            layers: Vec::new(),
            developed: Vec::new(),
            developing: None,
            develops: false,
            recording: None,
            errands: 0,
            taken: Arc::default(),
            shots: 0,
            desk,
            script,
            outcome,
            began,
            moved: Instant::now(),
            ordered: None,
            made: None,
            refused: None,
            asked: None,
            judged: None,
            played: None,
            exposure: None,
            #[cfg(feature = "train")]
            wish: Wish::default(),
            #[cfg(feature = "train")]
            trainer: None,
            #[cfg(feature = "train")]
            training: None,
            #[cfg(feature = "train")]
            followed: None,
            textures: HashMap::new(),
        }
    }

    /// Whether the newest picture is what hands want, and nobody works on another one.
    pub fn is_up_to_date(&self) -> bool {
        self.ordered.is_none() && self.is_as_wanted()
    }

    /// Whether the newest picture is what hands want.
    pub fn is_as_wanted(&self) -> bool {
        self.made.as_ref().is_some_and(|made| !self.differs(made))
    }

    /// Whether what hands want cannot be made.
    pub fn is_refused(&self) -> bool {
        self.ordered.is_none() && self.refused.as_ref().is_some_and(|refused| !self.differs(refused))
    }

    /// Whether the scene that hands have chosen was read.
    pub fn is_met(&self) -> bool {
        self.subject.as_ref().is_some_and(|subject| subject.source == self.state.show.source)
    }

    /// Truth of what the newest picture shows, where some is known.
    pub fn truth_of_picture(&self) -> Option<&Truth> {
        let sight = self.sight()?;
        self.truth.as_ref().filter(|truth| self.state.truth && truth.sight == sight)
    }

    /// What the newest picture's images are held against, and of how many samples it is: truth as far as it is known, or the image
    /// of a method, which has none.
    pub fn reference(&self) -> Option<(&Developed, u32)> {
        match self.state.reference() {
            TRUTH => self.truth_of_picture().map(|truth| (&truth.image, truth.samples)),
            method => {
                let images = &self.picture.as_ref()?.images;
                images.iter().find(|image| image.name == method).map(|image| (image, 0))
            }
        }
    }

    /// The verdict of the newest picture, beside what is shown of it.
    pub fn verdict_of_picture(&self) -> Option<&Verdict> {
        let (sight, show) = (self.sight()?, &self.picture.as_ref()?.order.show);
        let against = self.state.reference();
        let suits =
            |verdict: &&Verdict| (&verdict.sight, &verdict.show, verdict.against) == (&sight, show, against);
        self.verdict.as_ref().filter(suits).filter(|_| self.reference().is_some())
    }

    /// How far the newest picture's truth is from itself, where that is what its images are held against.
    pub fn ceiling(&self) -> Option<Scores> {
        let truth = self.truth_of_picture().filter(|_| self.state.reference() == TRUTH);
        truth.map(|truth| truth.ceiling)
    }

    /// Keeps a figure that a script measured.
    pub fn measured(&self, name: &str, value: f64) {
        self.outcome().measured.push((name.to_owned(), value));
    }

    /// Forgets what was known of other effects and scenes: among it their lights, of which effects add some.
    pub fn changed(&mut self) {
        self.state.lights = None;
        self.opened();
    }

    /// As [`Self::changed`], but for lights.
    fn opened(&mut self) {
        (self.message, self.note) = (None, None);
        self.forget();
    }

    fn forget(&mut self) {
        (self.exposure, self.made, self.refused) = (None, None, None);
        self.ordered.iter_mut().for_each(|ordered| ordered.outdated = true);
        self.textures.retain(|(_, map), _| *map == Map::Image);
        self.moved = Instant::now();
    }

    fn outcome(&self) -> std::sync::MutexGuard<'_, Outcome> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn follow_script(&mut self, context: &Context) {
        let Some(mut script) = self.script.take() else { return self.unheard.clear() };
        match script.go_on(self, context) {
            Progress::GoesOn => self.script = Some(script),
            Progress::Done => {}
            Progress::Failed(what) => {
                self.outcome().failure = Some(what);
                context.send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
        context.request_repaint_after(Duration::from_millis(20));
    }
}

impl eframe::App for Window {
    fn logic(&mut self, context: &Context, _: &mut eframe::Frame) {
        self.hear(context);
        #[cfg(feature = "train")]
        self.follow();
        self.write_shots();
        self.follow_script(context);
        self.fade(context);
        self.play(context);
        self.go_on_recording();
        self.order_picture();
        self.order_truth();
        self.order_verdict();
        self.order_layers();
        let waits = !(self.is_up_to_date() || self.is_refused()) || self.recording.is_some();
        if waits || self.moved.elapsed() <= STILL {
            context.request_repaint_after(Duration::from_millis(30));
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        dropped.iter().for_each(|file| self.open(file.path()));
        let before = (self.state.pilot, self.state.time, self.state.lights.clone());
        Panel::left("choices").default_size(290.0).show(ui, |ui| panel::show(ui, self));
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| canvas::show(ui, self));
        if before != (self.state.pilot, self.state.time, self.state.lights.clone()) {
            self.moved = Instant::now();
            context.request_repaint();
        }
    }
}
