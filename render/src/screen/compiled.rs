//! A screen method compiled for a device: what all of them have alike, so that a method's file says only what is its own.

use super::{Inputs, MethodStep, PlainInputs, ScreenMethod, View, Written};
use deepshade_shaders::gpu::{Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What a method is, apart from the device that it runs on. Its parameters implement it.
pub trait Technique: Copy + Send + Sync {
    /// Its name on the command line.
    const NAME: &'static str;
    /// What it computes.
    const EFFECT: Effect;
    /// What it reads of a g-buffer.
    const ATTRIBUTES: &'static [Attribute];
    /// As [`ScreenMethod::looks_beyond`].
    const LOOKS_BEYOND: bool = false;
    /// As [`ScreenMethod::wants_even_fog`].
    const WANTS_EVEN_FOG: bool = false;
    /// Its compiled passes.
    type Passes: Clone + Send + Sync;

    /// Compiles the passes.
    ///
    /// # Errors
    /// If the device refuses them.
    fn compile(device: &wgpu::Device) -> Result<Self::Passes, GpuError>;

    /// As [`ScreenMethod::uniforms`].
    fn uniforms(&self, view: &View) -> Vec<Vec<u8>>;

    /// As [`ScreenMethod::steps`], of the compiled passes.
    ///
    /// # Errors
    /// If the device has no room for what lies between the passes, or refuses a binding.
    fn steps(
        &self,
        passes: &Self::Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError>;

    /// As [`ScreenMethod::reference`].
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute>;

    /// As [`ScreenMethod::on_processor`].
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn on_processor(
        &self,
        _inputs: &PlainInputs<'_>,
        _view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        None
    }
}

/// A method, compiled for a device.
#[derive(Clone, Debug)]
pub struct Compiled<T: Technique> {
    gpu: Gpu,
    passes: T::Passes,
    parameters: T,
}

impl<T: Technique> Compiled<T> {
    /// Compiles the passes.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(gpu: &Gpu, parameters: T) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), passes: T::compile(&gpu.device)?, parameters })
    }

    /// The same passes with other parameters; nothing is compiled.
    #[must_use]
    pub fn with(&self, parameters: T) -> Self {
        Self { parameters, ..self.clone() }
    }
}

impl<T: Technique> ScreenMethod for Compiled<T> {
    fn name(&self) -> &'static str {
        T::NAME
    }

    fn effect(&self) -> Effect {
        T::EFFECT
    }

    fn attributes(&self) -> &'static [Attribute] {
        T::ATTRIBUTES
    }

    fn looks_beyond(&self) -> bool {
        T::LOOKS_BEYOND
    }

    fn wants_even_fog(&self) -> bool {
        T::WANTS_EVEN_FOG
    }

    fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.parameters.uniforms(view)
    }

    fn steps(
        &self,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        self.parameters.steps(&self.passes, &self.gpu.device, inputs, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.parameters.reference(inputs, view)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        self.parameters.on_processor(inputs, view)
    }
}
