//! Methods that shade the screen in passes on the GPU: they compute an effect from what the camera sees, some
//! also from the scene behind it, and each has a plain version on the CPU that it is checked against.
//!
//! A [`Technique`] says which attributes it reads and which passes it has; on a device it is a
//! [`ScreenMethod`]. [`MethodPasses`] are those passes bound to a g-buffer on the GPU, whoever made that: the
//! frame loop, which renders it there, or [`Method::shade`], which sends one over. They are made once for a
//! size of image; from frame to frame only their uniforms change.

mod device;
mod gbuffer;
mod halved;
pub mod host;
mod method_passes;
mod processor;
pub mod reprojection;
pub(crate) mod surface;
mod technique;
pub mod upsampling;

pub use device::Device;
pub use gbuffer::GpuGBuffer;
pub use halved::Halved;
pub use method_passes::{MethodPasses, MethodStep, PassDispatch, PassTime, Workgroups};
pub use reprojection::Reprojection;
pub use surface::Surface;
pub use technique::{About, Resources, Technique};

use crate::bvh::TracedScene;

use crate::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use crate::raster::World;
use crate::raster::view::perspective;
use crate::scene::glow::Start;
use crate::scene::{Camera, Environment, Glow, Scene};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::wgsl::uniforms::FrameView;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use std::borrow::Cow;
use std::sync::Arc;

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

    /// Its camera as passes over a scene read it.
    pub(crate) fn perspective(&self) -> FrameView {
        perspective(&self.camera, self.height, self.width, f32::MIN_POSITIVE)
    }
}

impl From<&Frame<'_>> for View {
    fn from(frame: &Frame<'_>) -> Self {
        let Frame { camera, gbuffer, radius, seed, .. } = *frame;
        Self { height: gbuffer.height(), width: gbuffer.width(), camera: *camera, radius, seed }
    }
}

/// What a method's passes read besides their uniforms.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// What the camera sees.
    pub gbuffer: &'a GpuGBuffer,
    /// What shines from infinitely far away.
    pub environment: Option<&'a Environment>,
    /// The scene, for methods that [look beyond](About::looks_beyond) the screen.
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

impl<'a> PlainInputs<'a> {
    /// The image that a plain version makes of the scene, as [`Technique::reference`] returns it.
    pub(crate) fn image_of_scene<E>(
        &self,
        image: impl FnOnce(&'a TracedScene) -> Result<Planes, E>,
    ) -> Result<Written, E> {
        let shaded = self.scene.map(|scene| image(scene).map(|image| image.data().to_vec()));
        shaded.into_iter().collect()
    }
}

/// The contents of buffers, one after the other.
pub type Written = Vec<Vec<f32>>;

/// A method that shades the screen, on a device. Clones share their compiled passes.
#[derive(Clone, Debug)]
pub struct ScreenMethod {
    gpu: Arc<Gpu>,
    device: Device,
    technique: Arc<dyn Technique>,
}

impl ScreenMethod {
    /// A technique on a device; its passes are compiled where they are first bound.
    pub fn new(gpu: &Gpu, technique: impl Technique + 'static) -> Self {
        Self::of(gpu, Arc::new(technique))
    }

    /// The same of a technique that others have, too.
    pub fn of(gpu: &Gpu, technique: Arc<dyn Technique>) -> Self {
        let (gpu, device) = (Arc::new(gpu.clone()), Device::new(&gpu.device));
        Self { gpu, device, technique }
    }

    /// Another technique with the same passes, such as other parameters; what was compiled stays.
    #[must_use]
    pub fn with(&self, technique: impl Technique + 'static) -> Self {
        Self { technique: Arc::new(technique), ..self.clone() }
    }

    /// What is known of it.
    pub fn about(&self) -> About {
        self.technique.about()
    }

    /// Its name on the command line.
    pub fn name(&self) -> &'static str {
        self.about().name
    }

    /// What it computes.
    pub fn effect(&self) -> Effect {
        self.about().effect
    }

    /// What it reads of a g-buffer.
    pub fn attributes(&self) -> &'static [Attribute] {
        self.about().attributes
    }

    /// Where its passes run.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// As [`Technique::reference`].
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.technique.reference(inputs, view)
    }

    /// As [`Method::shade`], in passes whatever the adapter is, so that times of several methods are of one
    /// device.
    ///
    /// # Errors
    /// If the frame lacks something or the GPU fails.
    pub fn shade_in_passes(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let About { name: method, effect, .. } = self.about();
        let failed = |source: GpuError| MethodError::Gpu { method, source };
        let Gpu { device, queue, .. } = self.gpu();
        let view = View::from(frame);
        let passes = self.passes(frame)?;
        let timing = gpu::time(device, queue, method, repeats.warm_up, repeats.timed, |encoder| {
            passes.encode(encoder);
        })
        .map_err(failed)?;
        let image = gpu::read(device, queue, passes.output()).map_err(failed)?;
        let image = Planes::from_data(effect.channels(), view.height, view.width, image);
        let clock = if timing.by_gpu { Clock::Gpu } else { Clock::Cpu };
        let device = self.gpu.info.name.clone();
        Ok(Shaded { image, milliseconds: timing.milliseconds, clock, device })
    }

    /// What its passes take on a frame, as [`MethodPasses::times`] has it, by the names of shaders, after
    /// that of the part where the method has several: `sky/bounced-z.sky`.
    ///
    /// # Errors
    /// If the frame lacks something or the GPU fails.
    pub fn pass_times(
        &self,
        frame: &Frame<'_>,
        repeats: Repeats,
    ) -> Result<Vec<PassTime<String>>, MethodError> {
        let method = self.name();
        let failed = |source: GpuError| MethodError::Gpu { method, source };
        let passes = self.passes(frame)?;
        let name = |step: &MethodStep| step.step.pass.name().to_owned();
        passes.times(self.gpu(), repeats, name).map_err(failed)
    }

    /// Its passes, bound to a frame.
    fn passes(&self, frame: &Frame<'_>) -> Result<MethodPasses, MethodError> {
        let About { name: method, attributes, looks_beyond, .. } = self.about();
        let failed = |source: GpuError| MethodError::Gpu { method, source };
        let view = View::from(frame);
        let gbuffer = GpuGBuffer::upload(&self.gpu().device, &self.seen(frame), attributes)
            .map_err(|error| error.of_method(method))?;
        let world = looks_beyond.then(|| remembered(&self.gpu, frame.scene, &view));
        let world = world.transpose().map_err(failed)?;
        let environment = frame.scene.scene().environment.as_deref();
        let inputs = Inputs { gbuffer: &gbuffer, environment, world: world.as_ref() };
        MethodPasses::new(self, &inputs, &view).map_err(failed)
    }

    /// What it reads of a frame's g-buffer: one that looks beyond the screen knows the scene, so that what
    /// the g-buffer does not hold is rendered for it.
    fn seen<'a>(&self, frame: &Frame<'a>) -> Cow<'a, GBuffer> {
        let (gbuffer, About { attributes, looks_beyond, .. }) = (frame.gbuffer, self.about());
        if !looks_beyond || attributes.iter().all(|attribute| gbuffer.attributes().contains(attribute)) {
            return Cow::Borrowed(gbuffer);
        }
        let (height, width) = (gbuffer.height(), gbuffer.width());
        Cow::Owned(crate::gbuffer::render(frame.scene, frame.camera, height, width, attributes))
    }
}

impl Method for ScreenMethod {
    fn name(&self) -> &'static str {
        self.about().name
    }

    fn effect(&self) -> Effect {
        self.about().effect
    }

    fn wants_even_fog(&self) -> bool {
        self.about().wants_even_fog
    }

    /// The time is that of the passes on the GPU, without sending the g-buffer there and the image back, or
    /// that of the [version for the processor](Technique::on_processor) where that is taken.
    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        if self.gpu.is_software() {
            let environment = frame.scene.scene().environment.as_deref();
            let inputs = PlainInputs { gbuffer: &self.seen(frame), environment, scene: Some(frame.scene) };
            if let Some(shaded) =
                processor::shade(self.technique.as_ref(), &inputs, &View::from(frame), repeats)
            {
                let method = self.name();
                return shaded.map_err(|source| MethodError::Missing { method, source });
            }
        }
        self.shade_in_passes(frame, repeats)
    }
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
