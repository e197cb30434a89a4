//! The window: hears what the threads have made, orders what hands want next, shows it.

use super::canvas::{self, Shown};
use super::judge::{Case, Verdict};
use super::script::{Progress, Script};
use super::state::{Map, State};
use super::studio::{Order, Picture};
use super::subject::Subject;
use super::truth::{self, Sight, Truth};
use super::{Desk, News, panel, saved};
use crate::figures::Figures;
use crate::render::picture::Exposure;
use deepshade_render::scene::SceneSource;
use eframe::egui::{self, CentralPanel, ColorImage, Context, Frame, Panel, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What is to be said when the window has closed.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Seconds from the beginning to the first picture.
    pub first_picture: Option<f64>,
    /// Pictures that were made.
    pub pictures: u32,
    /// What a script measured, by name.
    pub measured: Vec<(String, f64)>,
    /// Things that could not be done, and were said.
    pub refusals: u32,
    /// Why the script did not come to its end.
    pub failure: Option<String>,
}

impl Outcome {
    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        if let Some(seconds) = self.first_picture {
            figures.set("seconds_to_first_picture", seconds);
        }
        self.measured.iter().for_each(|(name, value)| figures.set(name, *value));
        figures.set("pictures", f64::from(self.pictures));
        figures.set("refusals", f64::from(self.refusals));
    }
}

/// For how long nobody must have moved before truth begins.
const STILL: Duration = Duration::from_millis(250);

/// The window.
pub struct Window {
    /// What hands have chosen.
    pub state: State,
    /// The scene.
    pub subject: Option<Arc<Subject>>,
    /// The newest picture.
    pub picture: Option<Box<Picture>>,
    /// The newest truth, of whatever.
    pub truth: Option<Truth>,
    /// What is said of the newest picture.
    pub verdict: Option<Verdict>,
    /// What could not be done last.
    pub message: Option<String>,
    /// Pictures a second.
    pub rate: f32,
    desk: Desk,
    script: Option<Script>,
    outcome: Arc<Mutex<Outcome>>,
    began: Instant,
    moved: Instant,
    /// The order that is being worked on, and since when.
    ordered: Option<(Order, Instant)>,
    /// What the newest picture was ordered as.
    made: Option<Order>,
    asked: Option<truth::Order>,
    judged: Option<(u32, u32)>,
    exposure: Option<Exposure>,
    textures: HashMap<(String, Map), TextureHandle>,
}

impl Window {
    /// A window before its first picture.
    pub fn new(state: State, desk: Desk, script: Option<Script>, outcome: Arc<Mutex<Outcome>>) -> Self {
        let now = Instant::now();
        Self {
            state,
            subject: None,
            picture: None,
            truth: None,
            verdict: None,
            message: None,
            rate: 0.0,
            desk,
            script,
            outcome,
            began: now,
            moved: now,
            ordered: None,
            made: None,
            asked: None,
            judged: None,
            exposure: None,
            textures: HashMap::new(),
        }
    }

    /// Whether the newest picture is what hands want, and nobody works on another one.
    pub fn is_up_to_date(&self) -> bool {
        self.ordered.is_none() && self.made.as_ref().is_some_and(|made| !self.differs(made))
    }

    /// Truth of what the newest picture shows, where some is known.
    pub fn truth_of_picture(&self) -> Option<&Truth> {
        let sight = self.sight()?;
        self.truth.as_ref().filter(|truth| self.state.truth && truth.sight == sight)
    }

    /// The verdict of the newest picture, beside the truth that is shown.
    pub fn verdict_of_picture(&self) -> Option<&Verdict> {
        let number = self.picture.as_ref()?.order.number;
        self.verdict.as_ref().filter(|verdict| verdict.number == number && self.truth_of_picture().is_some())
    }

    /// Opens what was dropped onto the window.
    pub fn open(&mut self, path: &Path) {
        if path.join("net.json").is_file() {
            return match self.state.open_model(path) {
                Ok(()) => self.changed(),
                Err(error) => self.refuse(format!("{error:#}")),
            };
        }
        match path.display().to_string().parse::<SceneSource>() {
            Ok(source) => self.open_scene(source),
            Err(error) => self.refuse(format!("{}: {error}", path.display())),
        }
    }

    /// Shows another scene.
    pub fn open_scene(&mut self, source: SceneSource) {
        self.state.show.source = source;
        self.state.pilot = None;
        self.state.lights = None;
        self.state.time = 0.0;
        self.changed();
    }

    /// Saves what is shown into a folder of its own, and says where.
    pub fn save(&mut self) {
        let folder = saved::free_folder();
        match saved::save(self, &folder) {
            Ok(()) => self.message = Some(format!("saved in {}", folder.display())),
            Err(error) => self.refuse(format!("{error:#}")),
        }
    }

    /// Keeps a figure that a script measured.
    pub fn measured(&self, name: &str, value: f64) {
        self.outcome().measured.push((name.to_owned(), value));
    }

    /// Says that something cannot be done.
    pub fn refuse(&mut self, what: String) {
        self.outcome().refusals += 1;
        self.message = Some(what);
    }

    /// Forgets what was known of other effects and scenes.
    pub fn changed(&mut self) {
        self.exposure = None;
        self.made = None;
        self.message = None;
        self.moved = Instant::now();
    }

    /// Images in the order in which they are shown: of methods, of truth, of the g-buffer.
    pub fn shown(&self) -> Vec<Shown<'_>> {
        let Some(picture) = &self.picture else { return Vec::new() };
        let truth = self.truth_of_picture().map(|truth| &truth.image);
        let all = picture.images.iter().chain(truth).chain(&picture.inspected);
        let seen = |name: &str| {
            let map = self.textures.get(&(name.to_owned(), self.state.map));
            map.or_else(|| self.textures.get(&(name.to_owned(), Map::Image)))
        };
        all.filter_map(|image| {
            Some(Shown { name: &image.name, values: &image.values, texture: seen(&image.name)?.id() })
        })
        .collect()
    }

    fn outcome(&self) -> std::sync::MutexGuard<'_, Outcome> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn hear(&mut self, context: &Context) {
        while let Ok(news) = self.desk.news.try_recv() {
            match news {
                News::Subject(subject) => self.meet(subject),
                News::Picture(picture) => self.take(context, picture),
                News::Truth(truth) => {
                    self.show(context, &truth.image.name, Map::Image, &truth.image.picture);
                    self.truth = Some(truth);
                }
                News::Judged(verdict) => self.take_verdict(context, verdict),
                News::Refused(what) => {
                    // What cannot be made is not asked for again until hands change something.
                    self.made = self.ordered.take().map(|(order, _)| order).or(self.made.take());
                    self.refuse(what);
                }
            }
        }
    }

    fn meet(&mut self, subject: Arc<Subject>) {
        let same_place = self.subject.as_ref().is_some_and(|known| known.source == subject.source);
        let pilot = self.state.pilot.filter(|_| same_place).unwrap_or(subject.pilot);
        let mut pilot = pilot;
        pilot.camera.lens = subject.pilot.camera.lens;
        self.state.pilot = Some(pilot);
        // Another effect may have given the scene another lamp.
        self.state.lights = Some(subject.animated.scene.lights.clone());
        self.subject = Some(subject);
    }

    fn take(&mut self, context: &Context, picture: Box<Picture>) {
        if let Some((_, since)) = self.ordered.take() {
            self.rate = 1.0 / since.elapsed().as_secs_f32().max(1e-3);
        }
        for image in picture.images.iter().chain(&picture.inspected) {
            self.show(context, &image.name, Map::Image, &image.picture);
        }
        let suits = picture.exposure.map(|exposure| exposure.brighter(-self.state.stops));
        self.exposure = self.exposure.or(suits);
        let mut made = picture.order.clone();
        made.camera = Some(picture.camera);
        made.lights = Some(picture.lights.clone());
        made.exposure = picture.exposure;
        self.made = Some(made);
        let seconds = self.began.elapsed().as_secs_f64();
        let mut outcome = self.outcome();
        outcome.pictures += 1;
        outcome.first_picture.get_or_insert(seconds);
        drop(outcome);
        self.picture = Some(picture);
    }

    fn take_verdict(&mut self, context: &Context, verdict: Verdict) {
        for judged in &verdict.judged {
            for (map, picture) in [Map::Difference, Map::Flip].into_iter().zip(&judged.maps) {
                self.show(context, &judged.name, map, picture);
            }
        }
        self.verdict = Some(verdict);
    }

    fn show(&mut self, context: &Context, name: &str, map: Map, picture: &Arc<ColorImage>) {
        let options =
            TextureOptions { magnification: egui::TextureFilter::Nearest, ..TextureOptions::LINEAR };
        match self.textures.get_mut(&(name.to_owned(), map)) {
            Some(texture) => texture.set(Arc::clone(picture), options),
            None => {
                let texture = context.load_texture(name, Arc::clone(picture), options);
                self.textures.insert((name.to_owned(), map), texture);
            }
        }
    }

    /// What is wanted now.
    fn order(&self, number: u32) -> Order {
        Order {
            show: self.state.show.clone(),
            camera: self.state.pilot.map(|pilot| pilot.camera),
            time: self.state.time,
            lights: self.state.lights.clone(),
            exposure: self.exposure.map(|exposure| exposure.brighter(self.state.stops)),
            number,
        }
    }

    /// Whether what is wanted now is something else than an order.
    fn differs(&self, other: &Order) -> bool {
        let order = self.order(other.number);
        (&order.show, order.camera, order.time, &order.lights)
            != (&other.show, other.camera, other.time, &other.lights)
            || order.exposure.is_some_and(|exposure| Some(exposure) != other.exposure)
    }

    fn order_picture(&mut self) {
        let busy_with = self.ordered.as_ref().map(|(order, _)| order);
        let newest = busy_with.or(self.made.as_ref());
        if let Some(newest) = newest
            && !self.differs(newest)
        {
            // Mixing with frames before goes on while nothing moves.
            if !self.state.show.temporal || busy_with.is_some() {
                return;
            }
        }
        // One order at a time, so that none is overtaken for ever while somebody moves.
        if busy_with.is_some() {
            return;
        }
        let number = self.picture.as_ref().map_or(0, |picture| picture.order.number + 1);
        let order = self.order(number);
        self.desk.studio.put(order.clone());
        self.ordered = Some((order, Instant::now()));
    }

    fn sight(&self) -> Option<Sight> {
        let picture = self.picture.as_ref()?;
        Some(Sight {
            subject: Arc::clone(&picture.subject),
            camera: picture.camera,
            time: picture.order.time,
            lights: picture.lights.clone(),
            radius: picture.radius,
            size: picture.order.show.size,
        })
    }

    /// Orders truth of what stands still, and lets it rest where something moves.
    fn order_truth(&mut self) {
        let (Some(sight), Some(picture)) = (self.sight(), &self.picture) else { return };
        let still = self.is_up_to_date() && self.moved.elapsed() > STILL && !self.state.playing;
        let samples = if still && self.state.truth { self.state.samples } else { 0 };
        let resting = self.asked.as_ref().is_none_or(|asked| asked.samples == 0);
        let (exposure, stops, seed) = (picture.exposure, self.state.stops, self.state.args.seed);
        let order = truth::Order { sight, exposure, stops, samples, seed };
        if self.asked.as_ref() == Some(&order) || (samples == 0 && resting) {
            return;
        }
        self.desk.truth.put(order.clone());
        self.asked = Some(order);
    }

    fn order_verdict(&mut self) {
        let (Some(truth), Some(picture)) = (self.truth_of_picture(), &self.picture) else { return };
        let what = (picture.order.number, truth.samples);
        if self.judged == Some(what) || picture.images.is_empty() {
            return;
        }
        self.desk.judge.put(Case {
            number: what.0,
            samples: what.1,
            effect: picture.subject.effect,
            truth: Arc::clone(&truth.image.values),
            images: picture.images.clone(),
        });
        self.judged = Some(what);
    }

    fn follow_script(&mut self, context: &Context) {
        let Some(mut script) = self.script.take() else { return };
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

    fn play(&mut self, context: &Context) {
        let span = self.subject.as_ref().and_then(|subject| subject.animated.span());
        let Some([begin, end]) = span.filter(|[begin, end]| self.state.playing && end > begin) else {
            return;
        };
        if self.ordered.is_none() {
            let step = context.input(|input| input.stable_dt).min(0.2) + self.last_frame();
            self.state.time = begin + (self.state.time + step - begin).rem_euclid(end - begin);
            self.moved = Instant::now();
        }
        context.request_repaint();
    }

    /// Seconds that the newest picture took.
    fn last_frame(&self) -> f32 {
        self.picture.as_ref().map_or(0.0, |picture| picture.milliseconds as f32 / 1e3)
    }
}

impl eframe::App for Window {
    fn logic(&mut self, context: &Context, _: &mut eframe::Frame) {
        self.hear(context);
        self.follow_script(context);
        self.play(context);
        self.order_picture();
        self.order_truth();
        self.order_verdict();
        if !self.is_up_to_date() || self.moved.elapsed() <= STILL {
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
