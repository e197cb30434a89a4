//! A scene in motion on the GPU: frame after frame its g-buffer, and what methods make of it.
//!
//! Passes are timed one by one: by the GPU's own clock where it has one, some frames later, and else, as with
//! software Vulkan, by waiting for each.

pub mod animated_view;
#[cfg(any(feature = "view", target_arch = "wasm32"))]
pub mod camera_controller;
mod scene_estimate;

use crate::learned::{self, Learned, Recorded};
use crate::methods::LEARNED;
use anyhow::{Context, Result, ensure};
#[cfg(feature = "view")]
use deepshade_infer::Model;
use deepshade_render::method::{MethodError, Repeats};
use deepshade_render::raster::Frame;
use deepshade_render::raster::frame::{FrameStage, RasterSettings};
use deepshade_render::raster::since::Since;
use deepshade_render::scene::{AnimatedScene, Camera};
#[cfg(feature = "view")]
use deepshade_render::scene::{Glow, Light};
use deepshade_render::screen::reprojection::{Reprojection, ReprojectionParameters};
use deepshade_render::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError, PassClock, Stamps};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use scene_estimate::SceneEstimate;
use std::sync::Arc;
use web_time::Instant;

/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 2048;

/// What a live scene is to show.
pub struct LiveSettings {
    /// Rows and columns.
    pub size: [usize; 2],
    /// What computes images of each frame's g-buffer, on the screen alone.
    pub methods: Vec<ScreenMethod>,
    /// And a trained network.
    pub learned: Option<Learned>,
    /// What the g-buffer holds beside what the methods read.
    pub attributes: Vec<Attribute>,
    /// Whether images are mixed with those of the frames before.
    pub temporal: bool,
    /// How far effects reach, metres.
    pub radius: f32,
    /// How long the shutter is open, seconds.
    pub shutter: f32,
}

/// A scene on the GPU with all passes of a frame.
pub struct Live {
    gpu: Gpu,
    frame: Frame,
    since: Since,
    shading: Vec<Shading>,
    /// What the network reads of the scene beyond the screen.
    estimates: Vec<SceneEstimate>,
    clock: Option<PassClock>,
    view: View,
    shutter: f32,
}

/// A method, where its image is, and what mixes that with those before.
struct Shading {
    method: Running,
    output: wgpu::Buffer,
    temporal: Option<Reprojection>,
}

/// How a method runs.
enum Running {
    /// In passes that are recorded with the frame.
    Passes(Box<ScreenMethod>, Box<MethodPasses>),
    /// A network: recorded with the frame, or, where it cannot be, by itself once the frame's g-buffer has
    /// been read back.
    Network(Box<Learned>, Option<Box<Recorded>>),
}

impl Live {
    /// Prepares everything; on the GPU nothing is allocated afterwards, but for what carries a g-buffer and
    /// the image of a network there and back that is not recorded with the frame.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn new(gpu: &Gpu, animated: &AnimatedScene, camera: &Camera, wanted: LiveSettings) -> Result<Self> {
        let [height, width] = wanted.size;
        ensure!(height > 0 && width > 0, "a frame of {width} x {height} pixels shows nothing");
        let read = wanted.methods.iter().flat_map(|method| method.attributes()).copied();
        let network = wanted.learned.iter().flat_map(|learned| learned.spec().effect.attributes()).copied();
        let mut attributes: Vec<Attribute> = read.chain(network).chain(wanted.attributes).collect();
        attributes.sort_unstable();
        attributes.dedup();
        let asks_for_light = wanted.methods.iter().any(|method| method.about().looks_beyond)
            || attributes.iter().any(|of| matches!(of, Attribute::Light | Attribute::DiffuseLight));
        let shadow_size = asks_for_light.then_some(SHADOW_SIZE);
        let settings = RasterSettings { height, width, attributes, shadow_size };
        let frame = Frame::new(gpu, animated, &settings)?;
        frame.world().notes.iter().for_each(|line| note!("{line}"));
        let view = View { height, width, camera: *camera, radius: wanted.radius, seed: 0 };
        let environment = animated.scene.environment.as_ref().map(Arc::as_ref);
        let inputs = Inputs { gbuffer: frame.gbuffer(), environment, world: Some(frame.world()) };
        let mut running = Vec::new();
        for method in wanted.methods {
            let name = method.name();
            let passes =
                MethodPasses::new(&method, &inputs, &view).with_context(|| format!("method `{name}`"))?;
            running.push(Running::Passes(Box::new(method), Box::new(passes)));
        }
        let learned = wanted.learned.as_ref();
        let estimates = learned.map(|learned| SceneEstimate::all(gpu, learned, &inputs, &view));
        let estimates = estimates.transpose()?.unwrap_or_default();
        running.extend(wanted.learned.map(|learned| Running::Network(Box::new(learned), None)));
        let since = Since::new(&gpu.device, &frame)?;
        let shade = |method| Shading::new(gpu, wanted.size, method, wanted.temporal.then_some(&since));
        let mut shading: Vec<Shading> = running.into_iter().map(shade).collect::<Result<_, GpuError>>()?;
        shading.iter_mut().try_for_each(|shading| shading.record(frame.gbuffer(), &view))?;
        let (gpu, shutter) = (gpu.clone(), wanted.shutter);
        let mut live = Self { gpu, frame, since, shading, estimates, clock: None, view, shutter };
        let of_network = live.shading.iter().filter(|shading| !shading.is_recorded());
        let of_network: usize = of_network.map(|shading| 1 + usize::from(shading.temporal.is_some())).sum();
        let recorded = live.passes().len() - of_network;
        live.clock = PassClock::new(&live.gpu.device, &live.gpu.queue, recorded)?;
        Ok(live)
    }

    /// What is timed, in order: stages, methods, and, of those that are mixed with frames before, that.
    pub fn passes(&self) -> Vec<String> {
        let stages = FrameStage::ALL.iter().map(|stage| stage.name().to_owned());
        let mut passes: Vec<String> = stages.chain(["movement".to_owned()]).collect();
        for shading in self.shading.iter().filter(|shading| shading.is_recorded()) {
            let name = shading.method.name();
            passes.push(name.to_owned());
            passes.extend(shading.temporal.iter().map(|_| format!("{name}_temporal")));
        }
        for shading in self.shading.iter().filter(|shading| !shading.is_recorded()) {
            passes.push(LEARNED.to_owned());
            passes.extend(shading.temporal.iter().map(|_| format!("{LEARNED}_temporal")));
        }
        passes
    }

    /// Moves, turns, dims or brightens the scene's lights, as many and of the same kinds, from the next frame
    /// on.
    #[cfg(feature = "view")]
    pub fn set_lights(&mut self, lights: &[Light]) {
        self.frame.set_lights(&self.gpu.queue, lights);
    }

    /// Gives what keeps light other paints from the next frame on, as if it had always had these. Whether
    /// that can be without going to the GPU anew.
    #[cfg(feature = "view")]
    pub fn set_glow(&mut self, glow: &Arc<Glow>) -> bool {
        self.frame.set_glow(&self.gpu.queue, glow)
    }

    /// Runs the network with other weights from the next frame on. Whether it is the same but for these, and
    /// can; without a network nothing is left to do.
    ///
    /// # Errors
    /// If the device refuses.
    #[cfg(feature = "view")]
    pub fn train(&mut self, model: &Model) -> Result<bool> {
        for shading in &mut self.shading {
            let was_recorded = shading.is_recorded();
            let Running::Network(learned, _) = &mut shading.method else { continue };
            if *learned.spec() != model.spec {
                return Ok(false);
            }
            **learned = Learned::new(&self.gpu, model)?;
            shading.record(self.frame.gbuffer(), &self.view)?;
            if shading.is_recorded() != was_recorded {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Makes the frame of a moment, seen by a camera. Gives the milliseconds of each pass: of this frame, or,
    /// by the GPU's clock, of one before, where that is known.
    ///
    /// # Errors
    /// If the device fails.
    pub fn make(&mut self, time: f32, seed: u32, camera: &Camera) -> Result<Option<Vec<f64>>> {
        gpu::wait(self.make_async(time, seed, camera))?
    }

    /// As [`Live::make`], awaited.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn make_async(&mut self, time: f32, seed: u32, camera: &Camera) -> Result<Option<Vec<f64>>> {
        self.view = View { camera: *camera, seed, ..self.view };
        self.frame.set(&self.gpu.queue, time, self.shutter, camera);
        for shading in &self.shading {
            match &shading.method {
                Running::Passes(method, passes) => passes.look(&self.gpu.queue, method, &self.view),
                Running::Network(learned, Some(recorded)) => learned.look(recorded, &self.view),
                Running::Network(_, None) => {}
            }
        }
        let times = match self.clock.take() {
            Some(clock) => self.make_at_once(clock)?,
            None => Some(self.make_one_by_one().await?),
        };
        let network = self.run_network().await?;
        Ok(times.map(|times| times.into_iter().chain(network).collect()))
    }

    /// Runs the trained network, if there is one that was not recorded, on the g-buffer of the frame, and
    /// gives its milliseconds, and by the wall clock those of sending its image there and mixing it with the
    /// ones before.
    async fn run_network(&mut self) -> Result<Vec<f64>> {
        let Some(index) = self.shading.iter().position(|shading| !shading.is_recorded()) else {
            return Ok(Vec::new());
        };
        let Running::Network(learned, None) = &self.shading[index].method else { return Ok(Vec::new()) };
        let mut gbuffer = self.gbuffer_async(learned.spec().effect.attributes()).await?;
        let mut of_estimates = 0.0;
        for estimate in &self.estimates {
            let (with, milliseconds) = estimate.with(&self.gpu, &self.view, &gbuffer).await?;
            (gbuffer, of_estimates) = (with, of_estimates + milliseconds);
        }
        let shaded = learned.image_async(&gbuffer, self.view.radius, Repeats::ONCE).await?;
        let queue = &self.gpu.queue;
        let shading = &mut self.shading[index];
        queue.write_buffer(&shading.output, 0, bytemuck::cast_slice(shaded.image.data()));
        let mut times = vec![shaded.milliseconds + of_estimates];
        if let Some(temporal) = &mut shading.temporal {
            times.push(waited_for(&self.gpu, &mut |encoder| temporal.encode(queue, encoder, None)).await?);
        }
        Ok(times)
    }

    /// One submission; the clock tells of an earlier frame.
    fn make_at_once(&mut self, mut clock: PassClock) -> Result<Option<Vec<f64>>> {
        let (frame, since, shading, queue) = (&self.frame, &self.since, &mut self.shading, &self.gpu.queue);
        gpu::submit(&self.gpu.device, queue, "live", |encoder| {
            let mut stamps = (0..).map(|pass| clock.stamps(pass));
            for stage in FrameStage::ALL {
                frame.encode(stage, encoder, stamps.next().as_ref());
            }
            since.encode(encoder, stamps.next().as_ref());
            for shading in shading.iter_mut().filter(|shading| shading.is_recorded()) {
                shading.encode_method(encoder, stamps.next().as_ref());
                if let Some(temporal) = &mut shading.temporal {
                    temporal.encode(queue, encoder, stamps.next().as_ref());
                }
            }
        })?;
        let times = clock.collect(&self.gpu.device, queue);
        self.gpu.device.poll(wgpu::PollType::Poll).context("the device stopped")?;
        self.clock = Some(clock);
        Ok(times)
    }

    /// A submission a pass, each waited for.
    async fn make_one_by_one(&mut self) -> Result<Vec<f64>> {
        let (gpu, queue) = (&self.gpu, &self.gpu.queue);
        let mut times = Vec::with_capacity(FrameStage::ALL.len() + self.shading.len());
        for stage in FrameStage::ALL {
            times.push(waited_for(gpu, &mut |encoder| self.frame.encode(stage, encoder, None)).await?);
        }
        times.push(waited_for(gpu, &mut |encoder| self.since.encode(encoder, None)).await?);
        for shading in self.shading.iter_mut().filter(|shading| shading.is_recorded()) {
            times.push(waited_for(gpu, &mut |encoder| shading.encode_method(encoder, None)).await?);
            if let Some(temporal) = &mut shading.temporal {
                times.push(waited_for(gpu, &mut |encoder| temporal.encode(queue, encoder, None)).await?);
            }
        }
        Ok(times)
    }

    /// Whether the milliseconds of a frame are told some frames later.
    pub const fn tells_later(&self) -> bool {
        self.clock.is_some()
    }

    /// Where the image is that a method makes of each frame, `[channels, height, width]`.
    #[cfg(target_arch = "wasm32")]
    pub fn output(&self, method: usize) -> &wgpu::Buffer {
        let Shading { output, temporal, .. } = &self.shading[method];
        temporal.as_ref().map_or(output, Reprojection::output)
    }

    /// The image that a method made of the last frame, `[channels, height, width]`.
    ///
    /// # Errors
    /// If the device fails.
    pub fn image(&self, method: usize) -> Result<Planes> {
        gpu::wait(self.image_async(method))?
    }

    /// As [`Live::image`], awaited.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn image_async(&self, method: usize) -> Result<Planes> {
        let Shading { method, output, temporal } = &self.shading[method];
        let output = temporal.as_ref().map_or(output, Reprojection::output);
        self.read(output, method.effect().channels()).await
    }

    /// An attribute of the last frame.
    ///
    /// # Errors
    /// If the device fails.
    pub fn attribute(&self, attribute: Attribute) -> Result<Planes> {
        gpu::wait(self.attribute_async(attribute))?
    }

    async fn attribute_async(&self, attribute: Attribute) -> Result<Planes> {
        self.read(self.frame.gbuffer().buffer(attribute), attribute.width()).await
    }

    /// Several attributes of the last frame.
    ///
    /// # Errors
    /// If the device fails.
    #[cfg(feature = "view")]
    pub fn gbuffer(&self, attributes: &[Attribute]) -> Result<GBuffer> {
        gpu::wait(self.gbuffer_async(attributes))?
    }

    async fn gbuffer_async(&self, attributes: &[Attribute]) -> Result<GBuffer> {
        let mut planes = Vec::new();
        for attribute in attributes {
            planes.extend_from_slice(self.attribute_async(*attribute).await?.data());
        }
        let channels = attributes.iter().map(|attribute| attribute.width()).sum();
        let planes = Planes::from_data(channels, self.view.height, self.view.width, planes);
        Ok(GBuffer::new(attributes.to_vec(), planes))
    }

    /// What is to be said of the last frame where it is unlike those that the network was trained on; nothing
    /// without a network.
    ///
    /// # Errors
    /// If the device fails.
    pub fn outside(&self) -> Result<Option<String>> {
        let network = self.shading.iter().find_map(|shading| match &shading.method {
            Running::Network(learned, _) => Some(learned.spec()),
            Running::Passes(..) => None,
        });
        let Some(spec) = network.filter(|spec| spec.trained.is_some()) else { return Ok(None) };
        let gbuffer = gpu::wait(self.gbuffer_async(spec.effect.attributes()))??;
        Ok(learned::outside(spec, &gbuffer, self.view.radius))
    }

    /// How far each pixel's surface moved since the frame before (x to the right, y up, pixels), its depth,
    /// and the depth that it had then, `[4, height, width]`.
    ///
    /// # Errors
    /// If the device fails.
    pub fn since_before(&self) -> Result<Planes> {
        gpu::wait(self.read(self.since.planes(), Since::PLANES))?
    }

    /// Waits until all frames are made, and gives the milliseconds that the GPU's clock has not told of yet.
    /// Those of a network, which runs by itself, are not among them.
    ///
    /// # Errors
    /// If the device fails.
    pub fn finish(&mut self) -> Result<Vec<Vec<f64>>> {
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the device stopped")?;
        let recorded = self.shading.iter().all(Shading::is_recorded);
        Ok(self.clock.as_mut().filter(|_| recorded).map(PassClock::arrived_all).unwrap_or_default())
    }

    async fn read(&self, buffer: &wgpu::Buffer, channels: usize) -> Result<Planes> {
        let data = gpu::read_async(&self.gpu.device, &self.gpu.queue, buffer).await?;
        Ok(Planes::from_data(channels, self.view.height, self.view.width, data))
    }
}

/// Milliseconds, by the wall clock, of a submission of its own.
async fn waited_for(gpu: &Gpu, record: &mut dyn FnMut(&mut wgpu::CommandEncoder)) -> Result<f64> {
    let start = Instant::now();
    gpu::submit(&gpu.device, &gpu.queue, "live", record)?;
    gpu::idle(&gpu.device, &gpu.queue, "live").await?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

impl Running {
    fn name(&self) -> &'static str {
        match self {
            Self::Passes(method, _) => method.name(),
            Self::Network(..) => LEARNED,
        }
    }

    fn effect(&self) -> Effect {
        match self {
            Self::Passes(method, _) => method.effect(),
            Self::Network(learned, _) => learned.spec().effect,
        }
    }
}

impl Shading {
    fn new(gpu: &Gpu, size: [usize; 2], method: Running, since: Option<&Since>) -> Result<Self, GpuError> {
        let (device, channels) = (&gpu.device, method.effect().channels());
        let pixels = size[0] * size[1];
        let output = match &method {
            Running::Passes(_, passes) => passes.output().clone(),
            Running::Network(..) => gpu::empty::<f32>(device, "live.learned", channels * pixels)?,
        };
        let temporal = since.map(|since| {
            Reprojection::new(
                device,
                size,
                since.planes(),
                &output,
                channels,
                ReprojectionParameters::default(),
            )
        });
        let temporal = temporal.transpose()?;
        Ok(Self { method, output, temporal })
    }

    /// Records a network's passes, where they can be, for every frame of a g-buffer.
    fn record(&mut self, gbuffer: &GpuGBuffer, view: &View) -> Result<(), MethodError> {
        if let Running::Network(learned, recorded) = &mut self.method {
            *recorded = learned.record(gbuffer, view, &self.output)?.map(Box::new);
        }
        Ok(())
    }

    /// Whether it runs in passes that are recorded with the frame.
    const fn is_recorded(&self) -> bool {
        matches!(self.method, Running::Passes(..) | Running::Network(_, Some(_)))
    }

    fn encode_method(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        let (method, passes) = match &self.method {
            Running::Passes(method, passes) => (method, passes),
            Running::Network(_, Some(recorded)) => return recorded.encode(encoder, stamps),
            Running::Network(_, None) => return,
        };
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(method.name()),
            timestamp_writes: stamps.map(Stamps::of_compute),
        });
        passes.encode_in(&mut pass);
    }
}

#[cfg(test)]
mod tests;
