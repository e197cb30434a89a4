//! What the effects that are shaded by a bounced z-buffer have in common as methods.

use super::{Parameters, Reflector, passes, reference};
use crate::bvh::TracedScene;
use crate::methods::Surface;
use crate::screen::{Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels::Lit;
use crate::surfels::reference::{Disk, laid};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};
use glam::{IVec2, Vec3};
use std::marker::PhantomData;

/// How the surface of each pixel reflects, if it does.
pub type Reflectors<'a, R> = Box<dyn Fn(IVec2) -> Option<R> + Sync + 'a>;

/// The shaders that make an effect of what all have in common.
#[derive(Clone, Copy, Debug)]
pub struct Shaders {
    /// What a pixel's rays meet.
    pub trace: &'static Shader,
    /// What arrives from there.
    pub arrive: &'static Shader,
    /// What brings neighbours' rays together.
    pub filter: &'static Shader,
}

/// An effect that the nearest surfels have on what is seen.
pub trait BouncedEffect: Copy + Send + Sync {
    /// What it is.
    const EFFECT: Effect;
    /// What it reads of a g-buffer.
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    /// What of the lights surfels send, where they are lit first.
    const LIT: Option<Lit>;
    /// How surfaces reflect.
    type Reflector: Reflector;

    /// The passes of its rays and of what brings them together.
    fn shaders() -> Shaders;

    /// How the surface of each pixel reflects, if it does.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn reflectors<'a>(
        gbuffer: &GBuffer,
        surface: &'a Surface,
    ) -> Result<Reflectors<'a, Self::Reflector>, MissingAttribute>;

    /// The radiance that arrives along a ray in a direction, of the disk that it meets or of none.
    fn arriving(met: Option<&Disk>, direction: Vec3) -> Vec3;
}

/// An effect by a bounced z-buffer, with what can be set.
#[derive(Clone, Copy, Debug)]
pub struct BouncedZ<E>(Parameters, PhantomData<E>);

impl<E> From<Parameters> for BouncedZ<E> {
    fn from(parameters: Parameters) -> Self {
        Self(parameters.sane(), PhantomData)
    }
}

impl<E: BouncedEffect> Technique for BouncedZ<E> {
    const NAME: &'static str = "bounced-z";
    const EFFECT: Effect = E::EFFECT;
    const ATTRIBUTES: &'static [Attribute] = E::ATTRIBUTES;
    const LOOKS_BEYOND: bool = true;
    type Passes = passes::Passes;

    fn compile(device: &wgpu::Device) -> Result<passes::Passes, GpuError> {
        passes::Passes::new::<E>(device)
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
        passes.steps(device, inputs, self.0.directions, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let reflectors = E::reflectors(inputs.gbuffer, &surface)?;
        let shaded = |scene: &TracedScene| {
            let disks = laid(scene, &self.0.surfels, view, E::LIT);
            reference::shade::<E>(&surface, &reflectors, &disks, &self.0, view).data().to_vec()
        };
        Ok(inputs.scene.map(shaded).into_iter().collect())
    }
}
