//! The window: takes what the workers have made, requests what the user wants next, and shows it.

mod animation;
mod design;
mod files;
mod messages;
mod requests;
mod screenshot;
mod textures;
#[cfg(feature = "train")]
mod training;
mod updates;

use super::canvas;
use super::design::GlowDesign;
use super::display_image::DisplayImage;
use super::film::Recording;
use super::layers::FileLayers;
use super::method_worker::MethodFrame;
use super::metrics::{self, Metrics};
use super::panel;
use super::state::{Map, State};
use super::subject::PreparedScene;
use super::truth::Truth;
use super::window_figures::WindowFigures;
use super::workers::Workers;
use crate::methods::TRUTH;
use deepshade_render::metrics::Scores;
use eframe::egui::{CentralPanel, Context, Frame, Panel, TextureHandle, Ui};
pub use files::Files;
pub use messages::Messages;
use requests::Requests;
pub use screenshot::Screenshot;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
#[cfg(feature = "train")]
pub use training::Training;

/// The window.
pub struct Window {
    /// What the user has chosen.
    pub state: State,
    /// What was made of it.
    pub results: Results,
    /// What is being made.
    requests: Requests,
    /// What is said above the choices.
    pub messages: Messages,
    /// The EXR file beside the methods.
    pub layers: FileLayers,
    /// Files that are written and read.
    pub files: Files,
    /// Key frames of glow, and what was found for them.
    pub design: GlowDesign,
    /// The film that is being recorded.
    pub recording: Option<Recording>,
    /// Trainings that the window begins and follows.
    #[cfg(feature = "train")]
    pub training: Training,
    /// The image that the command line wants.
    screenshot: Option<Screenshot>,
    pub(super) workers: Workers,
    outcome: Arc<Mutex<WindowFigures>>,
}

/// What was made of the user's choices.
#[derive(Default)]
pub struct Results {
    /// The scene.
    pub subject: Option<Arc<PreparedScene>>,
    /// The newest picture.
    pub picture: Option<Arc<MethodFrame>>,
    /// The newest truth, of whatever.
    pub truth: Option<Truth>,
    /// The newest figures, of whatever.
    pub metrics: Option<Metrics>,
    /// Pictures a second.
    pub rate: f32,
    /// What is seen of images, by name.
    pub textures: HashMap<(String, Map), TextureHandle>,
}

impl Window {
    /// A window before its first picture.
    pub fn new(
        state: State,
        workers: Workers,
        screenshot: Option<Screenshot>,
        outcome: Arc<Mutex<WindowFigures>>,
    ) -> Self {
        Self {
            state,
            results: Results::default(),
            requests: Requests::default(),
            messages: Messages::default(),
            layers: FileLayers::default(),
            files: Files::default(),
            design: GlowDesign::default(),
            recording: None,
            #[cfg(feature = "train")]
            training: Training::default(),
            screenshot,
            workers,
            outcome,
        }
    }

    /// Takes what has come, and requests what is wanted next.
    pub fn advance(&mut self, context: &Context) {
        self.take_updates(context);
        #[cfg(feature = "train")]
        self.follow_training();
        self.follow_screenshot(context);
        self.fade_messages(context);
        self.advance_animation(context);
        self.record_frame();
        self.request_place();
        self.request_picture();
        self.request_truth();
        self.request_metrics();
        self.request_layers();
        let waits = !(self.is_up_to_date() || self.is_refused()) || self.recording.is_some();
        if waits || !self.requests.is_still() {
            context.request_repaint_after(Duration::from_millis(30));
        }
    }

    /// Shows the choices and the images.
    pub fn show(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        dropped.iter().for_each(|file| self.open(file.path()));
        let before = (self.state.controller, self.state.time, self.state.lights.clone());
        Panel::left("choices").default_size(290.0).show(ui, |ui| panel::show(ui, self));
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| canvas::show(ui, self));
        if before != (self.state.controller, self.state.time, self.state.lights.clone()) {
            self.requests.moved = Some(Instant::now());
            context.request_repaint();
        }
    }

    /// Truth of what the newest picture shows, where some is known.
    pub fn truth_of_picture(&self) -> Option<&Truth> {
        let view_key = self.view_key()?;
        self.results.truth.as_ref().filter(|truth| self.state.truth && truth.view_key == view_key)
    }

    /// What the newest picture's images are measured against, and of how many samples it is: truth as far as
    /// it is known, or the image of a method, which has none.
    pub fn reference(&self) -> Option<(&DisplayImage, u32)> {
        match self.state.reference() {
            TRUTH => self.truth_of_picture().map(|truth| (&truth.image, truth.samples)),
            method => {
                let images = &self.results.picture.as_ref()?.images;
                images.iter().find(|image| image.name == method).map(|image| (image, 0))
            }
        }
    }

    /// What figures of the newest picture are of.
    fn metrics_key(&self) -> Option<metrics::Key> {
        let show = self.results.picture.as_ref()?.request.show.clone();
        Some(metrics::Key { view_key: self.view_key()?, show, against: self.state.reference() })
    }

    /// The figures of the newest picture, beside what is shown of it.
    pub fn metrics_of_picture(&self) -> Option<&Metrics> {
        let key = self.metrics_key()?;
        self.results.metrics.as_ref().filter(|metrics| metrics.key == key && self.reference().is_some())
    }

    /// How far the newest picture's truth is from itself, where that is what its images are measured against.
    pub fn ceiling(&self) -> Option<Scores> {
        let truth = self.truth_of_picture().filter(|_| self.state.reference() == TRUTH);
        truth.map(|truth| truth.ceiling)
    }

    /// Forgets what was known of other effects and scenes: among it their lights, of which effects add some.
    pub fn changed(&mut self) {
        self.state.lights = None;
        self.opened();
    }

    /// As [`Self::changed`], but for lights.
    fn opened(&mut self) {
        self.messages = Messages::default();
        self.forget();
    }

    fn forget(&mut self) {
        self.requests.forget();
        self.results.textures.retain(|(_, map), _| *map == Map::Image);
    }

    fn outcome(&self) -> MutexGuard<'_, WindowFigures> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl eframe::App for Window {
    fn logic(&mut self, context: &Context, _: &mut eframe::Frame) {
        self.advance(context);
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }
}
