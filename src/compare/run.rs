//! What is compared: the keys of a comparison's TOML file, which are the command line's options under the
//! same names.
//!
//! A run is every effect by every method in every quality, in every view of every scene. What a run leaves
//! out it has from the run that it stands in, and what no run states has a default
//! ([`ComparisonRun::filled`]).

use super::values::{Colour, MethodChoice};
use crate::complete::Additions;
use crate::location::Location;
use crate::props::{self, Prop};
use crate::views::{self, Choice};
use crate::{exposure_time, methods, samples};
use deepshade_dataset::Radius;
use deepshade_dataset::recipe::Resolution;
use deepshade_render::methods::Quality;
use deepshade_render::path::Goal;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Samples of a pixel of truth where none are asked for.
const SAMPLES: u32 = 512;
/// Rows and columns of images.
const RESOLUTION: Resolution = Resolution { height: 512, width: 512 };

/// What is compared with what.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ComparisonRun {
    /// What the run is called where several have scenes in common.
    pub name: Option<String>,
    /// Scene files, or procedural families and seeds.
    pub scenes: Option<Vec<SceneSource>>,
    /// What is computed.
    pub effects: Option<Vec<Effect>>,
    /// By what; each for those of the effects that have it. By default all, as [`super::compared_methods`]
    /// says.
    pub methods: Option<Vec<MethodChoice>>,
    /// How much time analytic methods may take for a better image.
    pub qualities: Option<Vec<Quality>>,
    /// Folder or address of the network of `learned`; by default models/EFFECT, else the program's own.
    pub model: Option<Location>,
    /// Which views of each scene; by default the cameras of its file, or where it has none one sampled view
    /// of a place, and one from outside of anything else.
    pub views: Option<Choice>,
    /// What is put into each scene.
    pub put: Option<Vec<Prop>>,
    /// Size of the images.
    pub resolution: Option<Resolution>,
    /// How far the effects reach.
    pub radius: Option<Radius>,
    /// Samples of a pixel of truth; with `error` the most.
    pub samples: Option<u32>,
    /// Noise of truth, as a share of its values, below which it takes no more samples.
    pub error: Option<f32>,
    /// Chooses sampled views, and all other random numbers.
    pub seed: Option<u32>,
    /// Moment at which scenes and media are seen, seconds.
    pub time: Option<f32>,
    /// How long the shutter is open, seconds.
    pub shutter: Option<f32>,
    /// An environment map around each scene.
    pub environment: Option<PathBuf>,
    /// Radius of the lens, metres.
    pub aperture: Option<f32>,
    /// Depth that the lens focuses, metres.
    pub focus: Option<f32>,
    /// Densities of a medium.
    pub medium: Option<PathBuf>,
    /// Extinction at density 1, per metre.
    pub extinction: Option<Colour>,
    /// Share of the extinction that is scattering.
    pub scattering_albedo: Option<Colour>,
    /// Mean cosine of the angle by which the medium scatters.
    pub anisotropy: Option<f32>,
    /// How far light goes within every material, metres.
    pub mean_free_path: Option<Colour>,
    /// What glows: which materials keep light, and when lamps shine.
    pub phosphor: Option<PathBuf>,
    /// Runs that differ in what they state from this one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<Self>,
}

impl ComparisonRun {
    /// What is stated here, and elsewhere what is stated by another; of its methods those that are for
    /// effects that are stated here. What stands in either is left out.
    #[must_use]
    pub fn over(self, other: &Self) -> Self {
        let other = other.clone();
        // Samples and error are one statement: a count does not mean the most for an error of the other's.
        let stated = self.samples.is_some() || self.error.is_some();
        let (samples, error) = if stated { (self.samples, self.error) } else { (other.samples, other.error) };
        let methods = match &self.effects {
            Some(effects) => other.methods.and_then(|methods| fitting(methods, effects)),
            None => other.methods,
        };
        Self {
            name: self.name.or(other.name),
            scenes: self.scenes.or(other.scenes),
            effects: self.effects.or(other.effects),
            methods: self.methods.or(methods),
            qualities: self.qualities.or(other.qualities),
            model: self.model.or(other.model),
            views: self.views.or(other.views),
            put: self.put.or(other.put),
            resolution: self.resolution.or(other.resolution),
            radius: self.radius.or(other.radius),
            samples,
            error,
            seed: self.seed.or(other.seed),
            time: self.time.or(other.time),
            shutter: self.shutter.or(other.shutter),
            environment: self.environment.or(other.environment),
            aperture: self.aperture.or(other.aperture),
            focus: self.focus.or(other.focus),
            medium: self.medium.or(other.medium),
            extinction: self.extinction.or(other.extinction),
            scattering_albedo: self.scattering_albedo.or(other.scattering_albedo),
            anisotropy: self.anisotropy.or(other.anisotropy),
            mean_free_path: self.mean_free_path.or(other.mean_free_path),
            phosphor: self.phosphor.or(other.phosphor),
            runs: Vec::new(),
        }
    }

    /// [`ComparisonRun::over`] of a command line, whose qualities and network are those of all methods,
    /// whatever a file states for one. A file's network goes where the command line leaves no method that is
    /// one.
    #[must_use]
    pub fn in_place_of(self, file: &Self) -> Self {
        let (qualities, model) = (self.qualities.is_some(), self.model.is_some());
        let narrows = self.methods.is_some() || self.effects.is_some();
        let mut run = self.over(file);
        let needless = narrows && !model && !run.methods().is_empty() && !run.learns();
        run.model.take_if(|_| needless);
        for method in run.methods.iter_mut().flatten() {
            method.qualities.take_if(|_| qualities);
            method.model.take_if(|_| model);
        }
        run
    }

    /// The run with all defaults stated that do not depend on scenes and networks.
    #[must_use]
    pub fn filled(self) -> Self {
        let samples = self.goal().samples;
        let defaults = Self {
            effects: Some(vec![Effect::Ao]),
            qualities: Some(vec![Quality::default()]),
            resolution: Some(RESOLUTION),
            seed: Some(0),
            time: Some(0.0),
            ..Self::default()
        };
        Self { samples: Some(samples), ..self.over(&defaults) }
    }

    /// Every path that the run names, its scenes' and props' too.
    pub fn map_paths(&mut self, map: &impl Fn(&Path) -> PathBuf) {
        let source = |source: &mut SceneSource| {
            if let SceneSource::File(path) = source {
                *path = map(path);
            }
        };
        self.scenes.iter_mut().flatten().for_each(source);
        self.put.iter_mut().flatten().for_each(|prop| source(&mut prop.source));
        let models = self.methods.iter_mut().flatten().filter_map(|method| method.model.as_mut());
        let folders = self.model.as_mut().into_iter().chain(models).filter_map(Location::folder_mut);
        [&mut self.environment, &mut self.medium, &mut self.phosphor]
            .into_iter()
            .flatten()
            .chain(folders)
            .for_each(|path| *path = map(path));
        self.runs.iter_mut().for_each(|run| run.map_paths(map));
    }

    /// Effects that are computed.
    pub fn effects(&self) -> &[Effect] {
        self.effects.as_deref().unwrap_or_default()
    }

    /// Scenes that are shown.
    pub fn scenes(&self) -> &[SceneSource] {
        self.scenes.as_deref().unwrap_or_default()
    }

    /// Qualities of methods that do not state their own.
    pub fn qualities(&self) -> &[Quality] {
        self.qualities.as_deref().unwrap_or_default()
    }

    /// Methods that are stated.
    pub fn methods(&self) -> &[MethodChoice] {
        self.methods.as_deref().unwrap_or_default()
    }

    /// Rows and columns.
    pub fn size(&self) -> [usize; 2] {
        let Resolution { height, width } = self.resolution.unwrap_or(RESOLUTION);
        [height, width]
    }

    /// Chooses sampled views, and all other random numbers.
    pub fn seed(&self) -> u32 {
        self.seed.unwrap_or(0)
    }

    /// When truth has samples enough.
    pub fn goal(&self) -> Goal {
        samples::Args::new(self.samples, self.error).goal(SAMPLES)
    }

    /// How far effects reach in a scene of a diagonal, metres, where it is stated.
    pub fn reach(&self, diagonal: f32) -> Option<f32> {
        self.radius.and_then(|radius| radius.metres(diagonal))
    }

    /// What is put into each scene.
    pub fn props(&self) -> props::Args {
        props::Args::new(self.put.clone().unwrap_or_default())
    }

    /// The moment, for an effect.
    pub fn moment(&self, effect: Effect) -> exposure_time::Args {
        let shutter = self.shutter.filter(|_| effect.listens_to(EffectSetting::Shutter));
        exposure_time::Args::new(self.time, shutter)
    }

    /// What scenes are given beside what they bring.
    pub fn additions(&self) -> Additions {
        let vector = |colour: Option<Colour>| colour.map(|Colour(value)| value);
        Additions {
            environment: self.environment.clone(),
            aperture: self.aperture,
            focus: self.focus,
            medium: self.medium.clone(),
            extinction: vector(self.extinction),
            scattering_albedo: vector(self.scattering_albedo),
            anisotropy: self.anisotropy,
            mean_free_path: vector(self.mean_free_path),
            phosphor: self.phosphor.clone(),
        }
    }

    /// What command lines state in the structures of options that several verbs share.
    #[must_use]
    pub fn with_options(
        self,
        additions: &Additions,
        views: &views::Args,
        samples: samples::Args,
        time: exposure_time::Args,
    ) -> Self {
        let ((time, shutter), additions) = (time.stated(), additions.clone());
        Self {
            views: views.choice(),
            seed: views.seed,
            samples: samples.spp(),
            error: samples.error(),
            time,
            shutter,
            environment: additions.environment,
            aperture: additions.aperture,
            focus: additions.focus,
            medium: additions.medium,
            extinction: additions.extinction.map(Colour),
            scattering_albedo: additions.scattering_albedo.map(Colour),
            anisotropy: additions.anisotropy,
            mean_free_path: additions.mean_free_path.map(Colour),
            phosphor: additions.phosphor,
            ..self
        }
    }

    /// Whether a method is `learned` for one of the effects.
    pub fn learns(&self) -> bool {
        self.methods().iter().any(|method| method.name == methods::LEARNED)
    }
}

/// Methods without those that only other effects have; nothing where no effect has any. What is no method at
/// all stays, to be refused by name.
fn fitting(mut methods: Vec<MethodChoice>, effects: &[Effect]) -> Option<Vec<MethodChoice>> {
    let has =
        |effect: &Effect, method: &MethodChoice| methods::names_of(*effect).contains(&method.name.as_str());
    methods.retain(|method| {
        effects.iter().any(|effect| has(effect, method))
            || !Effect::ALL.iter().any(|effect| has(effect, method))
    });
    (!methods.is_empty()).then_some(methods)
}
