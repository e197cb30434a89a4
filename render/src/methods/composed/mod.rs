//! `composed`: all light of a frame, each part by a method of its own.
//!
//! | part | method |
//! |---|---|
//! | light of lamps that surfaces reflect | the g-buffer's `light`, reflected as truth has it ([`lamps`]) |
//! | what surfaces emit, and the sky behind them | the g-buffer's `emission`, the environment |
//! | light that surfaces get of others that emit or that lamps light | [`surfel`](super::surfel) of `gi` |
//! | light that surfaces emit and others reflected | [`lpv`](super::lpv::ReflectedEmission) |
//! | light of the sky, and what other surfaces reflect of it | [`bounced-z`](super::bounced_z::sky_light) |
//! | phosphorescence | [`rate-equation`](super::phosphor) of `phosphor` |
//! | light in the medium that lamps send there | [`froxel`](super::froxel) of `fog-direct` |
//! | and surfaces | [`lpv`](super::lpv) of `fog-indirect` |
//! | and what emits or the sky | [`lpv`](super::lpv), scattered once |
//! | and all other | [`lpv`](super::lpv) of `fog-multiple` |
//!
//! For light of the sky visibility matters, which `surfel` lacks. For light of lamps noise does: what they
//! light brightly is small, and few rays find it.
//!
//! A part that a scene has nothing of takes no time: of the sky without an environment, of the medium where
//! there is none, of phosphorescence where nothing glows. What comes from surfaces and the sky is dimmed by
//! the medium in front of it. Surfels send all that a surface reflects of lamps, not its diffuse colour
//! alone. Both parts by surfels may shade half the rows and columns ([`Halved`]).
//!
//! Limits. Of several lamps, those that are hidden from a surface dim the others, too. Surfaces reflect the
//! sky and other surfaces as if they were everywhere alike, so that a mirror shows an even colour. Nothing
//! hides what surfaces send of lamps or emit to the next ones. Emitted light after its first reflection is as
//! blurred as the grid's cells are large. Light of lamps that was reflected more than twice is missing unless
//! the medium scatters it, and so is that of the sky that was reflected more than three times. By the grid it
//! was brighter than truth in a room full of shelves, whose cells are larger than what is between them. Light
//! of lamps between surfaces is dimmed up to the first of them only; that of the sky is dimmed on its way to
//! surfaces as if none were hidden. Where little sky is seen, as deep in a building in fog, too much of it
//! leaks in. The sky lights the medium within the grid, and not at all where the medium has no end. The lens
//! and the shutter are wide open and instant: neither depth of field nor motion blur.

mod lamps;
mod passes;
mod reference;
mod reflectance;
#[cfg(test)]
mod tests;
mod through;

use super::Quality;
use super::bounced_z::{BouncedZParameters, sky_light::SKY_LIGHT};
use super::disks::{ByDisks, DiskEffect, Disks};
use super::environment_map::EnvironmentMap;
use super::froxel::FroxelParameters;
use super::lpv::in_medium::InMedium;
use super::lpv::{LpvParameters, ReflectedEmission};
use super::phosphor::RateEquationParameters;
use super::surfel::{SurfelParameters, indirect::INDIRECT};
use crate::scene::{Camera, Environment, Scene};
use crate::screen::{About, Halved, MethodStep, PlainInputs, Resources, Technique, View, Written};
use crate::surfels::SurfelLight;
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use glam::Vec3;

/// What can be set: how each part is made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct ComposedParameters {
    /// Light that surfaces reflect of other surfaces.
    pub surfaces: SurfelParameters,
    /// Light of the sky that they reflect.
    pub sky: BouncedZParameters,
    /// Pixels along the edge of one for which both are made: with 2 there are half as many rows and
    /// columns.
    #[schemars(range(min = 1, max = 2), extend("unit" = "pixels"))]
    pub surfaces_scale: u32,
    /// Light of lamps in the medium.
    pub shafts: FroxelParameters,
    /// All other light in the medium.
    pub volume: LpvParameters,
    /// Phosphorescence.
    pub phosphor: RateEquationParameters,
}

impl ComposedParameters {
    /// All parts of a quality, but for the grid, which is that of a lower one: its light is smooth, and a
    /// finer one would take most of the time and change nothing that is seen.
    pub fn of(quality: Quality) -> Self {
        let of_volume = match quality {
            Quality::Low | Quality::Medium => Quality::Low,
            Quality::High => Quality::Medium,
            Quality::Ultra => Quality::High,
        };
        Self {
            surfaces: SurfelParameters::of(quality),
            sky: BouncedZParameters::of(quality),
            surfaces_scale: if quality == Quality::Low { 2 } else { 1 },
            shafts: FroxelParameters::of(quality),
            volume: LpvParameters::of(of_volume),
            phosphor: RateEquationParameters::of(quality),
        }
    }

    /// The parts, in the order in which they are added.
    fn parts(&self) -> [Part; 6] {
        let scale = self.surfaces_scale;
        let surfaces = scaled(FromFar { parameters: self.surfaces, effect: OF_SURFACES }, scale);
        let sky = scaled(FromFar { parameters: self.sky, effect: SKY_LIGHT }, scale);
        let has_medium: fn(&Scene) -> bool = |scene| scene.medium.is_some();
        let lights: fn(&Scene) -> bool = |scene| !scene.lights.is_empty() || scene.emits();
        [
            Part::new("surfaces", Shown::Reflected, surfaces, lights),
            Part::new("emission", Shown::Reflected, Box::new(ReflectedEmission(self.volume)), Scene::emits),
            Part::new("sky", Shown::FromSky, sky, |scene| scene.environment.is_some()),
            Part::new("phosphor", Shown::Sent, Box::new(self.phosphor), Scene::keeps_light),
            Part::new("shafts", Shown::Between, Box::new(self.shafts), has_medium),
            Part::new("volume", Shown::Between, Box::new(InMedium::all(self.volume)), has_medium),
        ]
    }
}

/// Light that surfaces emit, or send after one reflection, dimmed on its way to the first.
const OF_SURFACES: DiskEffect<SurfelParameters> =
    DiskEffect { lit: Some(SurfelLight::DimmedAndEmitted), on_processor: None, ..INDIRECT };

impl Shown {
    /// Whether surfaces reflect it.
    const fn is_reflected(self) -> bool {
        matches!(self, Self::Reflected | Self::FromSky)
    }
}

/// One method's part of all light.
struct Part {
    name: &'static str,
    shown: Shown,
    made: Box<dyn Technique>,
    /// How many uniform buffers it has, whatever the view.
    uniforms: usize,
    /// Whether a scene has any of it.
    has: fn(&Scene) -> bool,
}

impl Part {
    fn new(name: &'static str, shown: Shown, made: Box<dyn Technique>, has: fn(&Scene) -> bool) -> Self {
        let any = View {
            height: 1,
            width: 1,
            camera: Camera::look_at(Vec3::ZERO, Vec3::NEG_Z),
            radius: 1.0,
            seed: 0,
        };
        let uniforms = made.uniforms(&any).len();
        Self { name, shown, made, uniforms, has }
    }
}

/// How a part reaches the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Surfaces reflect it, as if it came from everywhere alike.
    Reflected,
    /// So they do, after the medium has dimmed it on its way from the sky.
    FromSky,
    /// Surfaces send it as it is.
    Sent,
    /// It comes from between surfaces and the eye.
    Between,
}

/// Farther than any scene is large, metres: light has no radius.
const FAR: f32 = 1e5;

/// A method at half the rows and columns, if `scale` is more than 1.
fn scaled<T: Technique + 'static>(technique: T, scale: u32) -> Box<dyn Technique> {
    if scale > 1 { Box::new(Halved(technique)) } else { Box::new(technique) }
}

/// An effect by surfels that reaches as far as the scene does. They are as large, and as sharply kept apart,
/// as those of the radius that was asked for.
#[derive(Clone, Copy, Debug)]
struct FromFar<M: ByDisks> {
    parameters: M,
    effect: DiskEffect<M>,
}

impl<M: ByDisks> FromFar<M> {
    fn seen(&self, view: &View) -> (Disks<M>, View) {
        let farther = FAR / view.radius.max(f32::MIN_POSITIVE);
        (Disks::new(self.parameters.reaching(farther), self.effect), View { radius: FAR, ..*view })
    }
}

impl<M: ByDisks> Technique for FromFar<M> {
    fn about(&self) -> About {
        Disks::new(self.parameters, self.effect).about()
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let (disks, view) = self.seen(view);
        disks.uniforms(&view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        Disks::new(self.parameters, self.effect).steps(to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let (disks, view) = self.seen(view);
        disks.reference(inputs, &view)
    }
}

/// Rows of the map of the sky that is seen behind surfaces, at most.
const SKY_HEIGHT: usize = 512;

/// The sky as it is seen; black without one.
fn sky(environment: Option<&Environment>) -> EnvironmentMap {
    let black = Environment::uniform(Vec3::ZERO);
    let environment = environment.unwrap_or(&black);
    EnvironmentMap::new(environment, environment.size()[1].min(SKY_HEIGHT))
}

impl Technique for ComposedParameters {
    fn about(&self) -> About {
        let seen = &[
            Attribute::Position,
            Attribute::Normal,
            Attribute::Diffuse,
            Attribute::Specular,
            Attribute::Glossiness,
            Attribute::Light,
            Attribute::Emission,
            Attribute::ObjectId,
            Attribute::Valid,
        ];
        About::beyond_screen("composed", Effect::Path, seen)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let own = bytes_of(&view.perspective()).to_vec();
        let of_parts = self.parts().into_iter().flat_map(|part| part.made.uniforms(view));
        std::iter::once(own).chain(of_parts).collect()
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(&self.parts(), to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        reference::image(&self.parts(), inputs, view)
    }
}
