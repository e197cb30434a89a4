//! The window: hears what the threads have made, orders what hands want next, shows it.

use super::canvas::{self, Shown};
use super::judge::{Case, Verdict};
use super::script::{Progress, Script};
use super::state::{Map, State};
use super::studio::{Order, Picture, Show};
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

/// For how long something that was said can be read.
const READ: Duration = Duration::from_secs(20);
/// For how long nobody must have moved before truth begins.
const STILL: Duration = Duration::from_millis(250);

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
    pub picture: Option<Box<Picture>>,
    /// The newest truth, of whatever.
    pub truth: Option<Truth>,
    /// What is said of the newest picture.
    pub verdict: Option<Verdict>,
    /// What could not be done last.
    pub message: Option<String>,
    /// What was done last that nothing else shows.
    pub note: Option<String>,
    /// Pictures a second.
    pub rate: f32,
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
    /// The picture's number and truth's samples that the judge has seen last.
    judged: Option<(u32, u32)>,
    /// When the animation was advanced last.
    played: Option<Instant>,
    exposure: Option<Exposure>,
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
            note: None,
            said: Instant::now(),
            rate: 0.0,
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
            textures: HashMap::new(),
        }
    }

    /// Whether the newest picture is what hands want, and nobody works on another one.
    pub fn is_up_to_date(&self) -> bool {
        self.ordered.is_none() && self.made.as_ref().is_some_and(|made| !self.differs(made))
    }

    /// Whether what hands want cannot be made.
    pub fn is_refused(&self) -> bool {
        self.ordered.is_none() && self.refused.as_ref().is_some_and(|refused| !self.differs(refused))
    }

    /// Truth of what the newest picture shows, where some is known.
    pub fn truth_of_picture(&self) -> Option<&Truth> {
        let sight = self.sight()?;
        self.truth.as_ref().filter(|truth| self.state.truth && truth.sight == sight)
    }

    /// The verdict of the newest picture, beside the truth that is shown.
    pub fn verdict_of_picture(&self) -> Option<&Verdict> {
        let (sight, show) = (self.sight()?, &self.picture.as_ref()?.order.show);
        let suits = |verdict: &&Verdict| verdict.sight == sight && verdict.show == *show;
        self.verdict.as_ref().filter(suits).filter(|_| self.truth_of_picture().is_some())
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
        let was_read = self.subject.as_ref().is_some_and(|subject| subject.source == self.state.show.source);
        self.state.open(source, was_read);
        self.changed();
    }

    /// Saves what is shown into a folder of its own, and says where.
    pub fn save(&mut self) {
        let folder = saved::free_folder();
        match saved::save(self, &folder) {
            Ok(()) => {
                self.note = Some(format!("saved in {}", folder.display()));
                self.said = Instant::now();
            }
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
        self.said = Instant::now();
    }

    /// Forgets what was known of other effects and scenes: among it their lights, of which effects add some.
    pub fn changed(&mut self) {
        self.state.lights = None;
        (self.message, self.note) = (None, None);
        self.forget();
    }

    fn forget(&mut self) {
        (self.exposure, self.made, self.refused) = (None, None, None);
        self.ordered.iter_mut().for_each(|ordered| ordered.outdated = true);
        self.textures.retain(|(_, map), _| *map == Map::Image);
        self.moved = Instant::now();
    }

    /// Images in the order in which they are shown: of methods, of truth, of the g-buffer.
    pub fn shown(&self) -> Vec<Shown<'_>> {
        let Some(picture) = &self.picture else { return Vec::new() };
        let truth = self.truth_of_picture().map(|truth| &truth.image);
        let all = picture.images.iter().chain(truth).chain(&picture.inspected);
        let verdict = self.verdict_of_picture();
        let is_judged = |name: &str| {
            verdict.is_some_and(|verdict| verdict.judged.iter().any(|judged| judged.name == name))
        };
        let seen = |name: &str| {
            let map = self.textures.get(&(name.to_owned(), self.state.map)).filter(|_| is_judged(name));
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
                News::Subject(subject) => self.meet(&subject),
                News::Picture(picture) => self.take(context, picture),
                News::Truth(truth) => {
                    self.show(context, &truth.image.name, Map::Image, &truth.image.picture);
                    self.truth = Some(truth);
                }
                News::Judged(verdict) => self.take_verdict(context, verdict),
                News::NoPicture(what) => self.give_up(what),
                News::Refused(what) => self.refuse(what),
            }
        }
    }

    /// Does not ask for what cannot be made again until hands change something, and comes back from a scene that cannot be read.
    fn give_up(&mut self, what: String) {
        self.refuse(what);
        let Some(Ordered { mut order, outdated: false, .. }) = self.ordered.take() else { return };
        let was_read = self.subject.as_ref().is_some_and(|subject| subject.source == order.show.source);
        if !was_read && order.show.source == self.state.show.source && self.state.go_back() {
            return self.forget();
        }
        // What was not known when it was ordered was learned meanwhile.
        order.camera = order.camera.or(self.state.pilot.map(|pilot| pilot.camera));
        order.lights = order.lights.or_else(|| self.state.lights.clone());
        self.refused = Some(order);
    }

    /// Knows the scene that hands have chosen, and stays where they are in it. One that they have left meanwhile is not met.
    fn meet(&mut self, subject: &Arc<Subject>) {
        let show = &self.state.show;
        if (&subject.source, subject.effect) != (&show.source, show.effect) {
            return;
        }
        let pilot = self.state.pilot.get_or_insert(subject.pilot);
        pilot.camera.lens = subject.pilot.camera.lens;
        self.state.lights = Some(subject.lights(self.state.lights.as_deref()));
        self.subject = Some(Arc::clone(subject));
    }

    fn take(&mut self, context: &Context, picture: Box<Picture>) {
        let Some(Ordered { since, outdated: false, .. }) = self.ordered.take() else { return };
        self.rate = 1.0 / since.elapsed().as_secs_f32().max(1e-3);
        self.meet(&picture.subject);
        for image in picture.images.iter().chain(&picture.inspected) {
            self.show(context, &image.name, Map::Image, &image.picture);
        }
        // Only one that the studio has chosen is as suits the image.
        let suits = picture.exposure.filter(|_| picture.order.exposure.is_none());
        self.exposure = self.exposure.or(suits);
        let mut made = picture.order.clone();
        made.camera = Some(picture.camera);
        made.lights = Some(picture.lights.clone());
        made.exposure = picture.exposure;
        (self.made, self.refused) = (Some(made), None);
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

    /// Whether what is wanted now looks upon something else than an order: truth does not hear of methods and brightness.
    fn looks_elsewhere(&self, other: &Order) -> bool {
        let order = self.order(other.number);
        let place = |show: &Show| (show.source.clone(), show.effect, show.radius, show.size);
        (place(&order.show), order.camera, order.time, &order.lights)
            != (place(&other.show), other.camera, other.time, &other.lights)
    }

    /// Orders what is wanted: one at a time, so that none is overtaken for ever while somebody moves.
    fn order_picture(&mut self) {
        let is_made = self.made.as_ref().is_some_and(|made| !self.differs(made));
        // Mixing with frames before goes on while nothing moves.
        if self.ordered.is_some() || self.is_refused() || (is_made && !self.state.show.temporal) {
            return;
        }
        let number = self.picture.as_ref().map_or(0, |picture| picture.order.number + 1);
        let order = self.order(number);
        self.desk.studio.put(order.clone());
        self.ordered = Some(Ordered { order, since: Instant::now(), outdated: false });
    }

    fn sight(&self) -> Option<Sight> {
        let picture = self.picture.as_ref()?;
        Some(Sight {
            source: picture.subject.source.clone(),
            effect: picture.subject.effect,
            subject: Arc::downgrade(&picture.subject),
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
        let seen = self.made.as_ref().is_some_and(|made| !self.looks_elsewhere(made));
        let still = seen && self.moved.elapsed() > STILL && !self.plays();
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
            sight: truth.sight.clone(),
            show: picture.order.show.clone(),
            samples: truth.samples,
            truth: Arc::clone(&truth.image.values),
            images: picture.images.clone(),
        });
        self.judged = Some(what);
    }

    /// Takes back what was said long ago, but not why there is no picture.
    fn fade(&mut self) {
        if self.said.elapsed() > READ && !self.is_refused() {
            (self.message, self.note) = (None, None);
        }
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

    /// Whether something moves by itself.
    fn plays(&self) -> bool {
        self.state.playing && self.subject.as_ref().is_some_and(|subject| subject.moves_for() > 0.0)
    }

    /// Goes on with the animation by the time that has gone, whenever there is room for a picture.
    fn play(&mut self, context: &Context) {
        let span = self.subject.as_ref().and_then(|subject| subject.animated.span());
        let Some([begin, end]) = span.filter(|_| self.plays()) else {
            self.played = None;
            return;
        };
        if self.ordered.is_none() {
            let before = self.played.replace(Instant::now());
            let step = before.map_or(0.0, |before| before.elapsed().as_secs_f32());
            self.state.time = begin + (self.state.time + step - begin).rem_euclid(end - begin);
            self.moved = Instant::now();
        }
        context.request_repaint();
    }
}

impl eframe::App for Window {
    fn logic(&mut self, context: &Context, _: &mut eframe::Frame) {
        self.hear(context);
        self.follow_script(context);
        self.fade();
        self.play(context);
        self.order_picture();
        self.order_truth();
        self.order_verdict();
        if !(self.is_up_to_date() || self.is_refused()) || self.moved.elapsed() <= STILL {
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
