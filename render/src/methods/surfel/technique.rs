//! What the effects that are shaded by surfels have in common as methods.

use super::{Parameters, passes};
use crate::bvh::TracedScene;
use crate::methods::Surface;
use crate::scene::Environment;
use crate::screen::{Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels::reference::{Disk, laid};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use std::marker::PhantomData;

/// An effect that surfels have on what is seen.
pub trait SurfelEffect: Copy + Send + Sync {
    /// What it is.
    const EFFECT: Effect;
    /// What it reads of a g-buffer.
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];

    /// What its passes do in their own way.
    fn shaders() -> passes::Shaders;

    /// Its image of a scene's disks, lit if they are to be, in plain Rust, `[channels, height, width]`.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn plain(plain: &Plain<'_>, disks: Vec<Disk>) -> Result<Planes, MissingAttribute>;
}

/// What the plain version reads.
#[derive(Clone, Copy)]
pub struct Plain<'a> {
    /// All that is seen.
    pub gbuffer: &'a GBuffer,
    /// Where surfaces are seen.
    pub surface: &'a Surface,
    /// All of the scene.
    pub scene: &'a TracedScene,
    /// The scene's environment, where it has one.
    pub environment: Option<&'a Environment>,
    /// What is set.
    pub parameters: &'a Parameters,
    /// From where it is seen.
    pub view: &'a View,
}

/// An effect by surfels, with what can be set.
#[derive(Clone, Copy, Debug)]
pub struct Surfel<E>(Parameters, PhantomData<E>);

impl<E> From<Parameters> for Surfel<E> {
    fn from(parameters: Parameters) -> Self {
        Self(parameters.sane(), PhantomData)
    }
}

impl<E: SurfelEffect> Technique for Surfel<E> {
    const NAME: &'static str = "surfel";
    const EFFECT: Effect = E::EFFECT;
    const ATTRIBUTES: &'static [Attribute] = E::ATTRIBUTES;
    const LOOKS_BEYOND: bool = true;
    type Passes = passes::Passes;

    fn compile(device: &wgpu::Device) -> Result<passes::Passes, GpuError> {
        passes::Passes::new(device, &E::shaders())
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(&self.0, E::EFFECT, view)
    }

    fn steps(
        &self,
        passes: &passes::Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        passes.steps(device, inputs, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let shaded = |scene: &TracedScene| {
            let disks = laid(scene, &self.0.surfels, view, E::shaders().lit);
            let environment = inputs.environment;
            let (gbuffer, surface, parameters) = (inputs.gbuffer, &surface, &self.0);
            let plain = Plain { gbuffer, surface, scene, environment, parameters, view };
            Ok(E::plain(&plain, disks)?.data().to_vec())
        };
        inputs.scene.map(shaded).into_iter().collect()
    }
}
