//! What hands have chosen.

mod networks;
mod stated;

use super::Args;
use super::studio::Show;
use super::zoom::Zoom;
use crate::learned;
use crate::live::pilot::Pilot;
use crate::methods::{self, LEARNED, TRUTH};
use crate::place::{Folder, Place};
use anyhow::Result;
use deepshade_render::methods::dials::{Changes, Dial};
use deepshade_render::scene::{Light, SceneSource};
use deepshade_shaders::Effect;
#[cfg(feature = "train")]
use networks::Promised;
use stated::{Stated, first_methods, is_network};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How images lie in the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// One over the other, each seen between two borders that can be dragged.
    #[default]
    Wipe,
    /// Beside each other.
    Tiles,
}

/// What is seen of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Map {
    /// Itself.
    #[default]
    Image,
    /// How it differs from truth.
    Difference,
    /// FLIP.
    Flip,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Wipe, Self::Tiles];

    /// Its name in scripts and in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wipe => "wipe",
            Self::Tiles => "tiles",
        }
    }
}

impl Map {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Image, Self::Difference, Self::Flip];

    /// Its name in scripts and in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Image => "image",
            Self::Difference => "difference",
            Self::Flip => "flip",
        }
    }

    /// The one after it.
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }
}

/// A scene that was shown, to come back to where another one cannot be read.
struct Before {
    source: SceneSource,
    pilot: Option<Pilot>,
    lights: Option<Vec<Light>>,
    time: f32,
}

/// What hands have chosen.
pub struct State {
    /// What the command line says.
    pub args: Arc<Args>,
    /// What is made of every frame.
    pub show: Show,
    /// The camera, once the scene was read.
    pub pilot: Option<Pilot>,
    /// The lights, once the scene was read.
    pub lights: Option<Vec<Light>>,
    /// The moment of animations, seconds.
    pub time: f32,
    /// Whether the animation plays.
    pub playing: bool,
    /// How much brighter images are shown than suits the first one, stops.
    pub stops: f32,
    /// How images lie in the window.
    pub arrangement: Arrangement,
    /// How they are enlarged.
    pub zoom: Zoom,
    /// What is seen of them.
    pub map: Map,
    /// The method that the others are held against; by default truth.
    pub against: Option<&'static str>,
    /// Where hands have put the right ends of images that lie over each other, as shares of the width.
    ends: BTreeMap<String, f32>,
    /// Whether truth is refined.
    pub truth: bool,
    /// Samples of a pixel at which truth rests.
    pub samples: u32,
    /// Frames a second of films.
    pub film_rate: f32,
    /// Methods and a radius that stay when another effect is shown.
    stated: Stated,
    /// Folders of networks that hands have chosen, by what they compute.
    networks: HashMap<Effect, PathBuf>,
    /// Whether the method `learned` is to be shown as soon as there are weights.
    #[cfg(feature = "train")]
    awaits_network: bool,
    /// The network that a training under way is to make.
    #[cfg(feature = "train")]
    promised: Option<Promised>,
    /// How long films are where time has no end, seconds.
    pub film_seconds: f32,
    before: Option<Before>,
    /// The network that the command line names, which stays where it was fetched to as long as this does.
    fetched: Option<Folder>,
}

impl State {
    /// What the command line asks for.
    ///
    /// # Errors
    /// If a method does not exist, or a network cannot be fetched.
    pub fn new(args: &Args) -> Result<Self> {
        let chosen = chosen_methods(args.effect, &args.methods)?;
        let none_wanted = args.methods.is_empty();
        let model = args.model.as_ref().map(Place::read).transpose()?;
        let mut stated = Stated::default();
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
            pilot: None,
            lights: None,
            time: args.time,
            playing: false,
            stops: 0.0,
            arrangement: Arrangement::default(),
            zoom: Zoom::default(),
            map: Map::default(),
            against: None,
            ends: BTreeMap::new(),
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

    /// Shows another scene, of which nothing is known yet. The one that is left is kept where it `was_read`. The same one is read
    /// anew, and seen as it was.
    pub fn open(&mut self, source: SceneSource, was_read: bool) {
        self.show.scenes_opened += 1;
        if source == self.show.source {
            return;
        }
        let left = std::mem::replace(&mut self.show.source, source);
        let (pilot, lights) = (self.pilot.take(), self.lights.take());
        if was_read {
            self.before = Some(Before { source: left, pilot, lights, time: self.time });
        }
        self.time = 0.0;
    }

    /// Shows the scene before this one as it was left. Whether there was one.
    pub fn go_back(&mut self) -> bool {
        let Some(Before { source, pilot, lights, time }) = self.before.take() else { return false };
        self.show.source = source;
        (self.pilot, self.lights, self.time) = (pilot, lights, time);
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
        self.stops = 0.0;
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

    /// Shows exactly these methods.
    ///
    /// # Errors
    /// If the effect does not have one.
    pub fn choose_methods(&mut self, wanted: &[String]) -> Result<()> {
        self.show.methods = chosen_methods(self.show.effect, wanted)?;
        self.stated.state_methods(self.show.effect, &self.show.methods);
        Ok(())
    }

    /// Adds a method or takes it away.
    pub fn toggle(&mut self, method: &'static str) {
        self.switch(method);
        self.stated.state_methods(self.show.effect, &self.show.methods);
    }

    /// As [`Self::toggle`], without hands having asked for it; methods keep the order of their list.
    fn switch(&mut self, method: &'static str) {
        let chosen = &mut self.show.methods;
        match chosen.iter().position(|name| *name == method) {
            Some(index) => drop(chosen.remove(index)),
            None => chosen.push(method),
        }
        let known = methods::names_of(self.show.effect);
        chosen.sort_by_key(|name| known.iter().position(|known| known == name));
    }

    /// What the images are held against: the method that hands have chosen as long as it is shown, else truth.
    pub fn reference(&self) -> &'static str {
        self.against.filter(|name| self.show.methods.contains(name)).unwrap_or(TRUTH)
    }

    /// Where images that lie over each other end, but for the last one, as shares of the width: where hands have put it, as long as
    /// they have put all of it, and in this order; else evenly. One that is not there for a while leaves its room to the others.
    pub fn borders(&self, names: &[&str]) -> Vec<f32> {
        let inner = &names[..names.len().saturating_sub(1)];
        let put: Option<Vec<f32>> = inner.iter().map(|name| self.ends.get(*name).copied()).collect();
        let evenly = || (1..names.len()).map(|index| index as f32 / names.len() as f32).collect();
        put.filter(|put| put.is_sorted()).unwrap_or_else(evenly)
    }

    /// Moves one of these borders, between its neighbours; the others stay where they are seen.
    pub fn put_border(&mut self, names: &[&str], index: usize, share: f32) {
        let mut borders = self.borders(names);
        let low = if index == 0 { 0.0 } else { borders[index - 1] };
        let high = borders.get(index + 1).copied().unwrap_or(1.0);
        borders[index] = share.clamp(low, high);
        self.ends.extend(names.iter().map(|name| (*name).to_owned()).zip(borders));
    }
}

/// Whether a network is named and not there yet, as where its training is still to begin.
#[cfg(feature = "train")]
fn awaits_network(show: &Show) -> bool {
    show.model.is_some() && !show.methods.contains(&LEARNED)
}

/// Those of an effect's methods that are wanted, in the order of their list; truth, which is beside them anyway, is none of them.
fn chosen_methods(effect: Effect, wanted: &[String]) -> Result<Vec<&'static str>> {
    let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
    methods::check(effect, &wanted)?;
    let known = methods::names_of(effect).into_iter();
    Ok(known.filter(|name| wanted.contains(name) && *name != TRUTH).collect())
}

#[cfg(test)]
mod tests;
