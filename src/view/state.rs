//! What hands have chosen.

use super::Args;
use super::studio::Show;
use crate::learned;
use crate::live::pilot::Pilot;
use crate::methods::{self, LEARNED, TRUTH};
use crate::place::{Folder, Place};
use anyhow::Result;
use deepshade_render::methods::dials::{Changes, Dial};
use deepshade_render::scene::{Light, SceneSource};
use deepshade_shaders::Effect;
use std::collections::BTreeMap;
use std::path::Path;
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
    /// What is seen of them.
    pub map: Map,
    /// Where images that lie over each other end, as shares of the width, from left to right.
    pub borders: Vec<f32>,
    /// Whether truth is refined.
    pub truth: bool,
    /// Samples of a pixel at which truth rests.
    pub samples: u32,
    /// Frames a second of films.
    pub film_rate: f32,
    before: Option<Before>,
    /// Keeps a network that was fetched.
    _model: Option<Folder>,
}

impl State {
    /// What the command line asks for.
    ///
    /// # Errors
    /// If a method does not exist, or a network cannot be fetched.
    pub fn new(args: &Args) -> Result<Self> {
        let known = methods::names_of(args.effect);
        let wanted: Vec<&str> = args.methods.iter().map(String::as_str).collect();
        methods::check(args.effect, &wanted)?;
        let chosen: Vec<&'static str> =
            known.iter().copied().filter(|name| wanted.contains(name) && *name != TRUTH).collect();
        let model = args.model.as_ref().map(Place::read).transpose()?;
        let show = Show {
            source: args.scene.clone(),
            effect: args.effect,
            methods: if wanted.is_empty() { first_methods(model.as_deref(), args.effect) } else { chosen },
            quality: args.quality,
            changes: BTreeMap::new(),
            radius: args.radius,
            size: [args.height, args.width],
            temporal: false,
            inspected: None,
            model: model.as_deref().map(Path::to_owned),
            trained: None,
        };
        Ok(Self {
            args: Arc::new(args.clone()),
            show,
            pilot: None,
            lights: None,
            time: args.time,
            playing: false,
            stops: 0.0,
            arrangement: Arrangement::default(),
            map: Map::default(),
            borders: Vec::new(),
            truth: true,
            samples: args.spp,
            film_rate: 25.0,
            before: None,
            _model: model,
        })
    }

    /// Shows another scene, of which nothing is known yet. The one that is left is kept where it `was_read`.
    pub fn open(&mut self, source: SceneSource, was_read: bool) {
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

    /// Computes another effect, by its first methods.
    pub fn choose_effect(&mut self, effect: Effect) {
        // A network computes one effect.
        if self.show.effect != effect {
            let model = self.show.model.take();
            self.show.model = model.filter(|folder| learned::effect(folder).is_ok_and(|made| made == effect));
            self.show.trained = None;
        }
        self.show.effect = effect;
        self.show.radius = None;
        self.show.changes.clear();
        self.show.methods = first_methods(self.show.model.as_deref(), effect);
        self.stops = 0.0;
    }

    /// Shows what the network in a folder makes.
    ///
    /// # Errors
    /// If it is damaged.
    pub fn open_model(&mut self, folder: &Path) -> Result<()> {
        let effect = learned::effect(folder)?;
        (self.show.model, self.show.trained) = (Some(folder.to_owned()), None);
        self.choose_effect(effect);
        Ok(())
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

    /// Adds a method or takes it away; methods keep the order of their list.
    pub fn toggle(&mut self, method: &'static str) {
        let chosen = &mut self.show.methods;
        match chosen.iter().position(|name| *name == method) {
            Some(index) => drop(chosen.remove(index)),
            None => chosen.push(method),
        }
        let known = methods::names_of(self.show.effect);
        chosen.sort_by_key(|name| known.iter().position(|known| known == name));
    }

    /// Where `count` images that lie over each other end: as hands have put it, or evenly where there are more or fewer of them.
    pub fn borders(&mut self, count: usize) -> &mut Vec<f32> {
        if self.borders.len() + 1 != count {
            self.borders = (1..count).map(|index| index as f32 / count as f32).collect();
        }
        &mut self.borders
    }
}

/// The first two methods of an effect; the trained network only where there is one.
fn first_methods(model: Option<&Path>, effect: Effect) -> Vec<&'static str> {
    let folder = model.map_or_else(|| learned::usual_folder(effect), Path::to_owned);
    let there = |name: &&str| *name != TRUTH && (*name != LEARNED || learned::is_network(&folder));
    methods::names_of(effect).into_iter().filter(there).take(2).collect()
}
