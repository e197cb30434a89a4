//! What runs before and after a trained network on a card, compiled once.

use super::estimates::{estimator, no_estimate};
use super::recorded::{EstimatePasses, NetworkRun, Recorded};
use super::{LEARNED, failed};
use deepshade_infer::forward::{FrameScale, ImageBuffers, ImagePass, InputPasses, InputSource, Runner};
use deepshade_infer::{NetSpec, Scaling};
use deepshade_render::method::{Clock, Frame, MethodError, Repeats, Shaded};
use deepshade_render::methods::estimate::{EstimateInputs, Estimator};
use deepshade_render::screen::{GpuGBuffer, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};
use std::sync::Arc;

/// The passes around a network on an adapter.
pub struct Card {
    gpu: Gpu,
    spec: NetSpec,
    estimators: Vec<Estimator>,
    /// Their passes.
    methods: Vec<ScreenMethod>,
    input: InputPasses,
    image: ImagePass,
}

impl Card {
    /// Compiles them.
    ///
    /// # Errors
    /// If there is no method that the network's spec names, or the adapter refuses.
    pub fn new(gpu: &Gpu, spec: &NetSpec) -> Result<Self, MethodError> {
        let estimators = spec.estimates.iter().map(|estimate| estimator(spec, estimate));
        let estimators: Vec<Estimator> = estimators.collect::<Result<_, _>>()?;
        Ok(Self {
            gpu: gpu.clone(),
            spec: spec.clone(),
            methods: estimators.iter().map(|estimator| estimator.on(gpu)).collect(),
            estimators,
            input: InputPasses::new(&gpu.device, spec).map_err(failed)?,
            image: ImagePass::new(&gpu.device, spec).map_err(failed)?,
        })
    }

    /// What the network makes of a g-buffer. The time is that of all its passes, without sending the g-buffer
    /// to the card and the image back.
    ///
    /// # Errors
    /// If the g-buffer lacks something or the device fails.
    pub async fn image(
        &self,
        runner: Arc<Runner>,
        inputs: &EstimateInputs<'_>,
        repeats: Repeats,
    ) -> Result<Shaded, MethodError> {
        let Gpu { device, queue, .. } = &self.gpu;
        let radius = inputs.radius;
        let (gbuffer, of_scene) = self.with_estimates_of_scene(inputs, repeats)?;
        let gbuffer = gbuffer.as_ref().unwrap_or(inputs.gbuffer);
        let seen = GpuGBuffer::upload(device, gbuffer, &self.reads(gbuffer))
            .map_err(|error| error.of_method(LEARNED))?;
        let (view, channels) = (inputs.view(), self.spec.effect.channels());
        let missing = |source: MissingAttribute| MethodError::Missing { method: LEARNED, source };
        let scaling = self.spec.scaling(gbuffer, radius).map_err(missing)?;
        let image = gpu::empty::<f32>(device, "learned.image", channels * view.height * view.width);
        let image = image.map_err(refused)?;
        let recorded = self.record(runner, &seen, &view, scaling, &image)?;
        let Repeats { warm_up, timed } = repeats;
        let record = |encoder: &mut wgpu::CommandEncoder| recorded.encode(encoder, None);
        let timing =
            gpu::time_async(device, queue, LEARNED, warm_up, timed, record).await.map_err(refused)?;
        let data = gpu::read_async(device, queue, &image).await.map_err(refused)?;
        Ok(Shaded {
            image: Planes::from_data(channels, view.height, view.width, data),
            milliseconds: timing.milliseconds + of_scene,
            clock: if timing.by_gpu { Clock::Gpu } else { Clock::Cpu },
            device: self.gpu.info.name.clone(),
        })
    }

    /// The g-buffer with what methods estimate that look beyond the screen, by their own passes, and the
    /// milliseconds of these; none where it has it, or none do.
    fn with_estimates_of_scene(
        &self,
        inputs: &EstimateInputs<'_>,
        repeats: Repeats,
    ) -> Result<(Option<GBuffer>, f64), MethodError> {
        let EstimateInputs { gbuffer, radius, seed, scene } = *inputs;
        let (mut with, mut milliseconds) = (None, 0.0);
        for (estimator, method) in self.estimators.iter().zip(&self.methods) {
            if estimator.reads_scene() && !estimator.is_made(gbuffer.attributes()) {
                let (scene, camera) = scene.ok_or_else(|| no_estimate(estimator.wants_scene()))?;
                let shaded =
                    method.shade_in_passes(&Frame { scene, camera, gbuffer, radius, seed }, repeats)?;
                milliseconds += shaded.milliseconds;
                let before = with.as_ref().unwrap_or(gbuffer);
                with = Some(before.with(estimator.makes(), shaded.image.data()));
            }
        }
        Ok((with, milliseconds))
    }

    /// All passes from a g-buffer on the card to an image, `[effect's channels, height, width]`, there.
    ///
    /// # Errors
    /// If the g-buffer lacks something or the device fails.
    pub fn record(
        &self,
        runner: Arc<Runner>,
        gbuffer: &GpuGBuffer,
        view: &View,
        scaling: Scaling,
        image: &wgpu::Buffer,
    ) -> Result<Recorded, MethodError> {
        let estimates = self.estimates(gbuffer, view)?;
        let mut attributes: Vec<(Attribute, &wgpu::Buffer)> =
            gbuffer.attributes().map(|attribute| (attribute, gbuffer.buffer(attribute))).collect();
        for (estimator, estimate) in self.estimators.iter().zip(&estimates) {
            let images = estimate.iter().flat_map(EstimatePasses::images);
            attributes.extend(estimator.makes().iter().copied().zip(images));
        }
        let (size, frame) = ([view.height, view.width], scale(view, scaling));
        let (valid, made) = (gbuffer.buffer(Attribute::Valid), runner.output());
        let run = |run| {
            let source = InputSource { size, attributes: &attributes, run, frame };
            let buffers = ImageBuffers { size, valid, made, image, run };
            Ok(NetworkRun {
                input: self.input.bind(&source, runner.input()).map_err(failed)?,
                image: self.image.bind(&buffers, frame).map_err(failed)?,
            })
        };
        let runs = (0..self.spec.runs()).map(run).collect::<Result<_, MethodError>>()?;
        Ok(Recorded { estimates, runs, runner: Arc::clone(&runner) })
    }

    /// Tells recorded passes of another frame.
    pub fn look(&self, recorded: &Recorded, view: &View, scaling: Scaling) {
        recorded.set(&self.gpu.queue, &self.methods, view, scale(view, scaling));
    }

    /// What is read of a g-buffer, by the methods that estimate, too.
    fn reads(&self, gbuffer: &GBuffer) -> Vec<Attribute> {
        let (given, made): (Vec<_>, Vec<_>) =
            self.estimators.iter().partition(|estimator| estimator.is_made(gbuffer.attributes()));
        let given: Vec<Attribute> = given.iter().flat_map(|estimator| estimator.makes()).copied().collect();
        let mut reads = self.input.reads();
        reads.retain(|attribute| !Attribute::MADE.contains(attribute) || given.contains(attribute));
        for attribute in made.iter().flat_map(|estimator| estimator.reads()) {
            if !reads.contains(attribute) {
                reads.push(*attribute);
            }
        }
        reads
    }

    /// The passes of each method that estimates something of the g-buffer alone; none where that is there.
    fn estimates(
        &self,
        gbuffer: &GpuGBuffer,
        view: &View,
    ) -> Result<Vec<Option<EstimatePasses>>, MethodError> {
        let held: Vec<Attribute> = gbuffer.attributes().collect();
        let passes = |(estimator, method): (&Estimator, &ScreenMethod)| {
            let is_made_here = !estimator.reads_scene() && !estimator.is_made(&held);
            let made = || EstimatePasses::new(method, estimator.makes().len() > 1, gbuffer, view);
            is_made_here.then(made).transpose()
        };
        let estimates = self.estimators.iter().zip(&self.methods).map(passes);
        estimates.collect::<Result<_, GpuError>>().map_err(refused)
    }
}

/// What pixels, lengths and light are to the network.
fn scale(view: &View, scaling: Scaling) -> FrameScale {
    FrameScale { focal_length: view.focal_length(), radius: view.radius, scaling }
}

const fn refused(source: GpuError) -> MethodError {
    MethodError::Gpu { method: LEARNED, source }
}

#[cfg(test)]
mod tests;
