//! What a method that shades the screen is, apart from the device that it runs on.

use super::{Device, GpuGBuffer, MethodStep, PlainInputs, View, Written};
use crate::raster::World;
use crate::scene::Environment;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::host::HostPasses;
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use std::fmt::Debug;

/// What is known of a method without running it.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its name on the command line; figures write hyphens as underscores.
    pub name: &'static str,
    /// What it computes.
    pub effect: Effect,
    /// What it reads of a g-buffer; [`Attribute::Valid`] is among it.
    pub attributes: &'static [Attribute],
    /// Whether it also reads the scene itself: what the camera does not see.
    pub looks_beyond: bool,
    /// As [`Method::wants_even_fog`](crate::method::Method::wants_even_fog).
    pub wants_even_fog: bool,
}

impl About {
    /// A method that reads the g-buffer alone.
    pub const fn on_screen(name: &'static str, effect: Effect, attributes: &'static [Attribute]) -> Self {
        Self { name, effect, attributes, looks_beyond: false, wants_even_fog: false }
    }

    /// A method that also reads the scene.
    pub const fn beyond_screen(name: &'static str, effect: Effect, attributes: &'static [Attribute]) -> Self {
        Self { looks_beyond: true, ..Self::on_screen(name, effect, attributes) }
    }
}

/// A way to compute an effect in passes on the GPU, with what can be set. Parameters implement it.
pub trait Technique: Debug + Send + Sync {
    /// What it is.
    fn about(&self) -> About;

    /// The contents of its uniform buffers for a view, always as many and as long.
    fn uniforms(&self, view: &View) -> Vec<Vec<u8>>;

    /// Its passes in order. The last ones write `to.output`, `[effect.channels(), height, width]`, with
    /// [`Effect::background`] where no surface is seen.
    ///
    /// # Errors
    /// If the device refuses a pass or a binding, or has no room for what lies between the passes.
    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError>;

    /// Its passes as an engine runs them from files, into buffers of these names: the image before the
    /// method's own blur, and the image. None of methods that nobody exports.
    fn host_passes(&self, _raw: &str, _image: &str) -> Option<HostPasses> {
        None
    }

    /// What its passes write, in the order of [`MethodStep::writes`], computed slowly and plainly on the CPU.
    /// The last of it is the image.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute>;

    /// What its passes write, as [`reference`](Self::reference) has it, by vector instructions of the
    /// processor, of methods that have such a version. [`Method::shade`](crate::method::Method::shade) takes
    /// it where the device is the processor anyway.
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

/// What a method's passes are bound to.
#[derive(Clone, Copy, Debug)]
pub struct Resources<'a> {
    /// What compiles the passes.
    pub device: &'a Device,
    /// What the camera sees.
    pub gbuffer: &'a GpuGBuffer,
    /// What shines from infinitely far away.
    pub environment: Option<&'a Environment>,
    /// The scene, for methods that look beyond the screen.
    pub world: Option<&'a World>,
    /// What [`Technique::uniforms`] fills.
    pub uniforms: &'a [wgpu::Buffer],
    /// The image, `[channels, height, width]` f32.
    pub output: &'a wgpu::Buffer,
}

impl<'a> Resources<'a> {
    /// Rows and columns of the image.
    pub fn size(&self) -> [usize; 2] {
        [self.gbuffer.height(), self.gbuffer.width()]
    }

    /// Workgroups that cover the image.
    pub fn whole(&self) -> [u32; 3] {
        gpu::groups(self.gbuffer.height(), self.gbuffer.width(), TILE)
    }

    /// What the g-buffer has of attributes.
    pub fn seen<const COUNT: usize>(&self, attributes: [Attribute; COUNT]) -> [&'a wgpu::Buffer; COUNT] {
        attributes.map(|attribute| self.gbuffer.buffer(attribute))
    }

    /// The scene of a method that looks beyond the screen.
    ///
    /// # Errors
    /// If there is none.
    pub fn scene(&self) -> Result<&'a World, GpuError> {
        let missing = || GpuError::Refused {
            label: "deepshade.scene".to_owned(),
            what: "there is no scene whose surface a method could read".to_owned(),
        };
        self.world.ok_or_else(missing)
    }
}
