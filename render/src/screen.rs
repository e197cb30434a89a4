//! Methods that shade the screen in passes on the GPU: they compute an effect from what the camera sees, some also from
//! the scene behind it, and each has a plain version on the CPU that it is checked against.
//!
//! A [`ScreenMethod`] says which attributes it reads and which passes it has. A [`Plan`] is those passes bound to a
//! g-buffer on the GPU, whoever made that: the frame loop, which renders it there, or [`Method::shade`], which sends one
//! over. A plan is made once for a size of image; from frame to frame only its uniforms change.

mod compiled;
mod gbuffer;
mod plan;
mod processor;
pub mod reprojection;
pub(crate) mod surface;
pub mod upsampling;

pub use compiled::{Compiled, Technique};
pub use gbuffer::GpuGBuffer;
pub use plan::{MethodStep, Plan, Step, Workgroups};
pub use reprojection::Reprojection;
pub use surface::Surface;

use crate::bvh::TracedScene;

use crate::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use crate::raster::World;
use crate::scene::glow::Start;
use crate::scene::{Camera, Environment, Glow, Scene};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use std::borrow::Cow;

/// From where an image is seen, and what else a method's passes are told about it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// The camera of the g-buffer.
    pub camera: Camera,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Chooses random numbers.
    pub seed: u32,
}

impl View {
    /// Distance in pixels, at depth 1, of two points one unit apart.
    pub fn focal_length(&self) -> f32 {
        self.camera.focal_length(self.height)
    }
}

impl From<&Frame<'_>> for View {
    fn from(frame: &Frame<'_>) -> Self {
        let Frame { camera, gbuffer, radius, seed, .. } = *frame;
        Self { height: gbuffer.height(), width: gbuffer.width(), camera: *camera, radius, seed }
    }
}

/// What a plan's passes read besides their uniforms.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// What the camera sees.
    pub gbuffer: &'a GpuGBuffer,
    /// What shines from infinitely far away.
    pub environment: Option<&'a Environment>,
    /// The scene, for methods that [look beyond](ScreenMethod::looks_beyond) the screen.
    pub world: Option<&'a World>,
}

/// What a method's plain version reads: the same on the CPU.
#[derive(Clone, Copy, Debug)]
pub struct PlainInputs<'a> {
    /// What the camera sees.
    pub gbuffer: &'a GBuffer,
    /// What shines from infinitely far away.
    pub environment: Option<&'a Environment>,
    /// The scene, for methods that look beyond the screen.
    pub scene: Option<&'a TracedScene>,
}

/// The contents of buffers, one after the other.
pub type Written = Vec<Vec<f32>>;

/// A way to compute an effect in passes on the GPU.
pub trait ScreenMethod: Send + Sync {
    /// Its name on the command line; figures write hyphens as underscores.
    fn name(&self) -> &'static str;

    /// What it computes.
    fn effect(&self) -> Effect;

    /// What it reads of a g-buffer; [`Attribute::Valid`] is among it.
    fn attributes(&self) -> &'static [Attribute];

    /// Whether it also reads the scene itself: what the camera does not see.
    fn looks_beyond(&self) -> bool;

    /// As [`Method::wants_even_fog`].
    fn wants_even_fog(&self) -> bool;

    /// Where its passes were compiled for.
    fn gpu(&self) -> &Gpu;

    /// The contents of its uniform buffers for a view, always as many and as long.
    fn uniforms(&self, view: &View) -> Vec<Vec<u8>>;

    /// Its passes in order. The last ones write `output`, `[effect.channels(), height, width]`, with
    /// [`Effect::background`] where no surface is seen.
    ///
    /// # Errors
    /// If the device has no room for what lies between the passes, or refuses a binding.
    fn steps(
        &self,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError>;

    /// What its passes write, in the order of [`MethodStep::writes`], computed slowly and plainly on the CPU. The last of it
    /// is the image.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute>;

    /// What its passes write, as [`ScreenMethod::reference`] has it, by vector instructions of the processor,
    /// of methods that have such a version. [`Method::shade`] takes it where the device is the processor
    /// anyway.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>>;
}

impl<M: ScreenMethod + ?Sized> Method for M {
    fn name(&self) -> &'static str {
        ScreenMethod::name(self)
    }

    fn effect(&self) -> Effect {
        ScreenMethod::effect(self)
    }

    fn wants_even_fog(&self) -> bool {
        ScreenMethod::wants_even_fog(self)
    }

    /// The time is that of the passes on the GPU, without sending the g-buffer there and the image back, or
    /// that of the [version for the processor](ScreenMethod::on_processor) where that is taken.
    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        if self.gpu().is_software() {
            let environment = frame.scene.scene().environment.as_deref();
            let inputs = PlainInputs { gbuffer: &seen(self, frame), environment, scene: Some(frame.scene) };
            if let Some(shaded) = processor::shade(self, &inputs, &View::from(frame), repeats) {
                let method = ScreenMethod::name(self);
                return shaded.map_err(|source| MethodError::Missing { method, source });
            }
        }
        shade_in_passes(self, frame, repeats)
    }
}

/// As [`Method::shade`], in passes whatever the adapter is, so that times of several methods are of one
/// device.
///
/// # Errors
/// If the frame lacks something or the GPU fails.
pub fn shade_in_passes<M: ScreenMethod + ?Sized>(
    shading: &M,
    frame: &Frame<'_>,
    repeats: Repeats,
) -> Result<Shaded, MethodError> {
    let method = ScreenMethod::name(shading);
    let failed = |source: GpuError| MethodError::Gpu { method, source };
    let Gpu { device, queue, .. } = shading.gpu();
    let view = View::from(frame);
    let gbuffer = GpuGBuffer::upload(device, &seen(shading, frame), shading.attributes())
        .map_err(|error| error.of_method(method))?;
    let world = shading.looks_beyond().then(|| remembered(shading.gpu(), frame.scene, &view));
    let world = world.transpose().map_err(failed)?;
    let environment = frame.scene.scene().environment.as_deref();
    let inputs = Inputs { gbuffer: &gbuffer, environment, world: world.as_ref() };
    let plan = Plan::new(shading, &inputs, &view).map_err(failed)?;
    let timing = gpu::time(device, queue, method, repeats.warm_up, repeats.timed, |encoder| {
        plan.encode(encoder);
    })
    .map_err(failed)?;
    let image = gpu::read(device, queue, plan.output()).map_err(failed)?;
    let image = Planes::from_data(ScreenMethod::effect(shading).channels(), view.height, view.width, image);
    let clock = if timing.by_gpu { Clock::Gpu } else { Clock::Cpu };
    let device = shading.gpu().info.name.clone();
    Ok(Shaded { image, milliseconds: timing.milliseconds, clock, device })
}

/// What a method reads of a frame's g-buffer: one that looks beyond the screen knows the scene, so that what the g-buffer does not
/// hold is rendered for it.
fn seen<'a, M: ScreenMethod + ?Sized>(method: &M, frame: &Frame<'a>) -> Cow<'a, GBuffer> {
    let (gbuffer, wanted) = (frame.gbuffer, method.attributes());
    if !method.looks_beyond() || wanted.iter().all(|attribute| gbuffer.attributes().contains(attribute)) {
        return Cow::Borrowed(gbuffer);
    }
    Cow::Owned(crate::gbuffer::render(frame.scene, frame.camera, gbuffer.height(), gbuffer.width(), wanted))
}

/// Edge of shadow maps of stills, texels.
const SHADOW_SIZE: usize = 2048;

/// A scene that stays, with the shadow maps for a view drawn.
pub(crate) fn world(gpu: &Gpu, scene: &Scene, view: &View) -> Result<World, GpuError> {
    still(gpu, scene, view, SHADOW_SIZE)
}

fn still(gpu: &Gpu, scene: &Scene, view: &View, shadow_size: usize) -> Result<World, GpuError> {
    let mut world = World::new(gpu, &scene.clone().into(), Some(shadow_size))?;
    let moment = Glow::of(scene).moment;
    world.set(&gpu.queue, moment, 0.0, &view.camera, view.width as f32 / view.height as f32);
    gpu::submit(&gpu.device, &gpu.queue, "world", |encoder| world.encode_shadows(encoder, None))?;
    Ok(world)
}

/// Poses of the past of which a still has shadow maps, at most, and the edge of these maps, texels.
const POSES: usize = 12;
const PAST_SHADOW_SIZE: usize = 1024;

/// The scene of a still, with what it was like before where surfaces keep light and something moves.
fn remembered(gpu: &Gpu, traced: &TracedScene, view: &View) -> Result<World, GpuError> {
    let now = world(gpu, traced.scene(), view)?;
    let moment = Glow::of(traced.scene()).moment;
    // In the middle of as many poses as stand for one.
    let poses = traced.past();
    let each = poses.len().div_ceil(POSES).max(1);
    // Lamps that had shone for long did so before the first pose alone.
    let long = usize::from(Glow::of(traced.scene()).start == Start::LitForLong).min(poses.len());
    let (first, later) = poses.split_at(long);
    let groups = || first.chunks(1).chain(later.chunks(each));
    let starts: Vec<f32> = groups().map(|group| group[0].0).collect();
    let mut past = Vec::new();
    for (index, group) in groups().enumerate() {
        let (_, pose) = &group[group.len() / 2];
        let mut then = still(gpu, pose.scene(), view, PAST_SHADOW_SIZE)?;
        let to = starts.get(index + 1).map_or(moment, |next| next.min(moment));
        then.glow.set_stretch(&gpu.queue, index == 0, [starts[index], to], moment);
        let since = if index == 0 { f32::MAX } else { moment - starts[index] };
        past.push(([moment - to, since], then));
    }
    Ok(now.with_past(past))
}

impl<M: ScreenMethod + ?Sized> ScreenMethod for Box<M> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn effect(&self) -> Effect {
        (**self).effect()
    }

    fn attributes(&self) -> &'static [Attribute] {
        (**self).attributes()
    }

    fn looks_beyond(&self) -> bool {
        (**self).looks_beyond()
    }

    fn wants_even_fog(&self) -> bool {
        (**self).wants_even_fog()
    }

    fn gpu(&self) -> &Gpu {
        (**self).gpu()
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        (**self).uniforms(view)
    }

    fn steps(
        &self,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        (**self).steps(inputs, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        (**self).reference(inputs, view)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        (**self).on_processor(inputs, view)
    }
}
