//! Methods that shade by the disks that a scene is laid out as ([`crate::surfels`]):
//! [`surfel`](super::surfel), which adds up what all of them do, and [`bounced_z`](super::bounced_z), which
//! takes the nearest. Each has several effects, a [`DiskEffect`] each.

use super::Surface;
use crate::bvh::TracedScene;
use crate::scene::Environment;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use crate::surfels::reference::{Disk, laid};
use crate::surfels::{self, SurfelLight};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use std::fmt::Debug;

/// What most effects read of a g-buffer.
pub const SURFACE: &[Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];

/// A method by disks, whatever the effect. Its parameters implement it.
pub trait ByDisks: Copy + Debug + Send + Sync {
    /// Its name on the command line.
    const NAME: &'static str;
    /// What its passes do in an effect's own way.
    type Passes: Copy + Debug + Send + Sync;

    /// These with numbers that make no sense brought into their range.
    #[must_use]
    fn sane(self) -> Self;

    /// These for an effect that reaches so many times as far, with surfels as large and surfaces as sharply
    /// kept apart.
    #[must_use]
    fn reaching(self, times: f32) -> Self;

    /// How finely the scene is laid out.
    fn surfels(&self) -> &surfels::SurfelDensity;

    /// As [`Technique::uniforms`].
    fn uniforms(&self, effect: Effect, view: &View) -> Vec<Vec<u8>>;

    /// As [`Technique::steps`].
    ///
    /// # Errors
    /// If there is no scene, or the device has no room or refuses a pass.
    fn steps(&self, effect: &DiskEffect<Self>, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError>;
}

/// An effect that disks have on what is seen.
#[derive(Clone, Copy, Debug)]
pub struct DiskEffect<M: ByDisks> {
    /// What it is.
    pub effect: Effect,
    /// What it reads of a g-buffer.
    pub attributes: &'static [Attribute],
    /// What of the lights disks send, where they are lit first.
    pub lit: Option<SurfelLight>,
    /// What the passes do in its own way.
    pub passes: M::Passes,
    /// Its image of a scene's disks in plain Rust, `[channels, height, width]`.
    pub plain: fn(&Plain<'_, M>, &[Disk]) -> Result<Planes, MissingAttribute>,
    /// The same by a faster way on the processor, where there is one.
    pub on_processor: Option<DiskImage<M>>,
}

/// An image of disks, `[channels, height, width]`.
pub type DiskImage<M> = fn(&Plain<'_, M>, &[Disk]) -> Planes;

/// What the plain version reads.
#[derive(Clone, Copy, Debug)]
pub struct Plain<'a, M> {
    /// All that is seen.
    pub gbuffer: &'a GBuffer,
    /// Where surfaces are seen.
    pub surface: &'a Surface,
    /// All of the scene.
    pub scene: &'a TracedScene,
    /// The scene's environment, where it has one.
    pub environment: Option<&'a Environment>,
    /// What is set.
    pub parameters: &'a M,
    /// From where it is seen.
    pub view: &'a View,
}

/// A method by disks with an effect.
#[derive(Clone, Copy, Debug)]
pub struct Disks<M: ByDisks> {
    parameters: M,
    effect: DiskEffect<M>,
}

impl<M: ByDisks> Disks<M> {
    /// A method with what is set.
    pub fn new(parameters: M, effect: DiskEffect<M>) -> Self {
        Self { parameters: parameters.sane(), effect }
    }

    /// What is made of a scene's disks.
    fn written(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
        image: impl Fn(&Plain<'_, M>, &[Disk]) -> Result<Planes, MissingAttribute>,
    ) -> Result<Written, MissingAttribute> {
        let PlainInputs { gbuffer, environment, .. } = *inputs;
        let (surface, parameters) = (&Surface::of(gbuffer)?, &self.parameters);
        inputs.image_of_scene(|scene| {
            let disks = laid(scene, parameters.surfels(), view, self.effect.lit);
            image(&Plain { gbuffer, surface, scene, environment, parameters, view }, &disks)
        })
    }
}

impl<M: ByDisks> Technique for Disks<M> {
    fn about(&self) -> About {
        About::beyond_screen(M::NAME, self.effect.effect, self.effect.attributes)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.parameters.uniforms(self.effect.effect, view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        self.parameters.steps(&self.effect, to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.written(inputs, view, self.effect.plain)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        let image = self.effect.on_processor?;
        Some(self.written(inputs, view, |plain, disks| Ok(image(plain, disks))))
    }
}
