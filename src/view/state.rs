//! What the user has chosen.

mod look;
mod networks;
mod user_choices;

use super::Args;
use super::method_worker::Show;
use crate::learned;
use crate::live::camera_controller::CameraController;
use crate::location::Location;
use crate::methods::{self, LEARNED, TRUTH};
use anyhow::Result;
use deepshade_render::methods::dials::{Changes, Dial};
use deepshade_render::scene::{Light, SceneSource};
use deepshade_shaders::Effect;
pub use look::{Arrangement, Look, Map};
#[cfg(feature = "train")]
use networks::ExpectedNetwork;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use user_choices::{UserChoices, first_methods, is_network};

/// A scene that was shown, to come back to where another one cannot be read.
struct Before {
    source: SceneSource,
    controller: Option<CameraController>,
    lights: Option<Vec<Light>>,
    time: f32,
}

/// What the user has chosen.
pub struct State {
    /// What the command line says.
    pub args: Arc<Args>,
    /// What is made of every frame.
    pub show: Show,
    /// The camera, once the scene was read.
    pub controller: Option<CameraController>,
    /// The lights, once the scene was read.
    pub lights: Option<Vec<Light>>,
    /// The moment of animations, seconds.
    pub time: f32,
    /// Whether the animation plays.
    pub playing: bool,
    /// How images are seen.
    pub look: Look,
    /// Whether truth is refined.
    pub truth: bool,
    /// Samples of a pixel at which truth rests.
    pub samples: u32,
    /// Frames a second of films.
    pub film_rate: f32,
    /// Methods and a radius that stay when another effect is shown.
    stated: UserChoices,
    /// Folders of networks that the user has chosen, by what they compute.
    networks: HashMap<Effect, PathBuf>,
    /// Whether the method `learned` is to be shown as soon as there are weights.
    #[cfg(feature = "train")]
    awaits_network: bool,
    /// The network that a training under way is to make.
    #[cfg(feature = "train")]
    promised: Option<ExpectedNetwork>,
    /// How long films are where time has no end, seconds.
    pub film_seconds: f32,
    before: Option<Before>,
    /// The folder of the network that the command line names.
    fetched: Option<PathBuf>,
}

impl State {
    /// What the command line asks for.
    ///
    /// # Errors
    /// If a method does not exist, or a network cannot be fetched.
    pub fn new(args: &Args) -> Result<Self> {
        let chosen = chosen_methods(args.effect, &args.methods)?;
        let none_wanted = args.methods.is_empty();
        let model = args.model.as_ref().map(Location::read).transpose()?;
        let mut stated = UserChoices::default();
        stated.state_radius(args.radius);
        if !none_wanted {
            stated.state_methods(args.effect, &chosen);
        }
        let first = || first_methods(args.effect, is_network(model.as_deref(), args.effect));
        let show = Show {
            source: args.scene.clone(),
            scenes_opened: 0,
            effect: args.effect,
            methods: if none_wanted { first() } else { chosen },
            quality: args.quality,
            changes: BTreeMap::new(),
            radius: args.radius,
            size: [args.height, args.width],
            temporal: false,
            inspected: None,
            model: model.as_deref().map(Path::to_owned),
            models_opened: 0,
            trained: None,
            glow: None,
        };
        #[cfg(feature = "train")]
        let awaits_network = none_wanted && awaits_network(&show);
        // One that is not there yet is taken for what the window begins with.
        let of = |folder: &PathBuf| {
            (learned::spec(folder).map_or(args.effect, |spec| spec.effect), folder.clone())
        };
        let networks = show.model.iter().map(of).collect();
        Ok(Self {
            args: Arc::new(args.clone()),
            show,
            controller: None,
            lights: None,
            time: args.time,
            playing: false,
            look: Look::default(),
            truth: true,
            samples: args.spp,
            film_rate: 25.0,
            #[cfg(feature = "train")]
            awaits_network,
            #[cfg(feature = "train")]
            promised: None,
            networks,
            stated,
            film_seconds: 10.0,
            before: None,
            fetched: model,
        })
    }

    /// Shows another scene, of which nothing is known yet. The one that is left is kept where it `was_read`.
    /// The same one is read anew, and seen as it was.
    pub fn open(&mut self, source: SceneSource, was_read: bool) {
        self.show.scenes_opened += 1;
        self.show.glow = None;
        if source == self.show.source {
            return;
        }
        let left = std::mem::replace(&mut self.show.source, source);
        let (controller, lights) = (self.controller.take(), self.lights.take());
        if was_read {
            self.before = Some(Before { source: left, controller, lights, time: self.time });
        }
        self.time = 0.0;
    }

    /// Shows the scene before this one as it was left. Whether there was one.
    pub fn go_back(&mut self) -> bool {
        let Some(Before { source, controller, lights, time }) = self.before.take() else { return false };
        self.show.source = source;
        (self.controller, self.lights, self.time) = (controller, lights, time);
        true
    }

    /// Computes another effect, by what was stated of methods and radius, else by its first methods.
    pub fn choose_effect(&mut self, effect: Effect) {
        // A network computes one effect.
        (self.show.model, self.show.trained) = (self.networks.get(&effect).cloned(), None);
        self.show.effect = effect;
        self.show.radius = self.stated.radius(effect);
        self.show.changes.clear();
        let is_network = is_network(self.show.model.as_deref(), effect);
        let stated = self.stated.methods(effect, is_network);
        #[cfg(feature = "train")]
        {
            self.awaits_network = stated.is_none() && self.show.model.is_some() && !is_network;
        }
        self.show.methods = stated.unwrap_or_else(|| first_methods(effect, is_network));
        self.look.stops = 0.0;
    }

    /// Has effects reach so far, metres or infinitely; without a radius as far as is usual.
    pub const fn set_radius(&mut self, radius: Option<f32>) {
        self.show.radius = radius;
        self.stated.state_radius(radius);
    }

    /// Sets a dial of a method by hand, or, where it is what the quality has anyway, no longer.
    pub fn set(&mut self, method: &'static str, dial: &Dial, value: f64) {
        let Changes(changes) = self.show.changes.entry(method).or_default();
        if value == dial.usual {
            changes.remove(&dial.name);
        } else {
            changes.insert(dial.name.clone(), dial.setting(value));
        }
        self.show.changes.retain(|_, changes| !changes.is_empty());
    }

    /// Adds a method or takes it away.
    pub fn toggle(&mut self, method: &'static str) {
        self.switch(method);
        self.stated.state_methods(self.show.effect, &self.show.methods);
    }

    /// As [`Self::toggle`], without the user having asked for it; methods keep the order of their list.
    fn switch(&mut self, method: &'static str) {
        let chosen = &mut self.show.methods;
        match chosen.iter().position(|name| *name == method) {
            Some(index) => drop(chosen.remove(index)),
            None => chosen.push(method),
        }
        let known = methods::names_of(self.show.effect);
        chosen.sort_by_key(|name| known.iter().position(|known| known == name));
    }

    /// What the images are held against: the method that the user has chosen as long as it is shown, else
    /// truth.
    pub fn reference(&self) -> &'static str {
        self.look.against.filter(|name| self.show.methods.contains(name)).unwrap_or(TRUTH)
    }
}

/// Whether a network is named and not there yet, as where its training is still to begin.
#[cfg(feature = "train")]
fn awaits_network(show: &Show) -> bool {
    show.model.is_some() && !show.methods.contains(&LEARNED)
}

/// Those of an effect's methods that are wanted, in the order of their list; truth, which is beside them
/// anyway, is none of them.
fn chosen_methods(effect: Effect, wanted: &[String]) -> Result<Vec<&'static str>> {
    let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
    methods::check(effect, &wanted)?;
    let known = methods::names_of(effect).into_iter();
    Ok(known.filter(|name| wanted.contains(name) && *name != TRUTH).collect())
}

#[cfg(test)]
mod tests;
