//! The method `learned`: a trained network, run by `infer`.

mod card;
#[cfg(not(target_arch = "wasm32"))]
mod embedded;
mod estimates;
mod folder;
mod recorded;
#[cfg(feature = "train")]
pub mod run;

use crate::engine::{self, Engine};
use crate::methods::LEARNED;
use anyhow::{Result, ensure};
use card::Card;
#[cfg(feature = "view")]
use deepshade_infer::TrainedUnder;
use deepshade_infer::forward::ForwardError;
use deepshade_infer::{Model, NetSpec};
use deepshade_render::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use deepshade_render::methods::estimate::EstimateInputs;
use deepshade_render::screen::{GpuGBuffer, ScreenMethod, View};
#[cfg(feature = "train")]
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};
use estimates::Estimates;
pub use estimates::{SEED, estimator};
#[cfg(any(feature = "train", feature = "view"))]
pub use folder::is_run;
pub use folder::{files, is_network, place, usual_folder};
use std::path::Path;

pub use recorded::Recorded;

/// What the network in a folder is; of a training run, before it has weights.
///
/// # Errors
/// If there is none or it is damaged.
#[cfg(feature = "view")]
pub fn spec(folder: &Path) -> Result<NetSpec> {
    #[cfg(feature = "train")]
    if is_run(folder) {
        return run::spec(folder);
    }
    Ok(network(folder, None)?.spec)
}

/// The environment that the network of an effect in a folder knows by heart; `None` where there is no such
/// network, or that is not known.
#[cfg(feature = "view")]
pub fn environment(folder: &Path, effect: Effect) -> Option<TrainedUnder> {
    let spec = spec(folder).ok()?;
    spec.environment.filter(|_| spec.effect == effect)
}

/// The network in a folder: a model, or what a training run has come to.
///
/// # Errors
/// If there is none, it is damaged, or it computes another effect than the one that is wanted.
pub fn network(folder: &Path, effect: Option<Effect>) -> Result<Model> {
    let place = folder.display();
    ensure!(
        is_network(folder),
        "no network in {place}{}: --model names one, `deepshade train` and `deepshade export --run RUN --out \
         {place}` make one",
        beside(folder)
    );
    #[cfg(feature = "train")]
    let model = if is_run(folder) { run::newest(folder)? } else { Model::load(folder)? };
    #[cfg(not(feature = "train"))]
    let model = Model::load(folder)?;
    let (made, wanted) = (model.spec.effect, effect.unwrap_or(model.spec.effect));
    ensure!(made == wanted, "the network in {place} is for {made}, not for {wanted}");
    Ok(model)
}

/// The networks in the folder that one was looked for in, in words; nothing where there is none.
fn beside(folder: &Path) -> String {
    let entries = folder.parent().into_iter().flat_map(std::fs::read_dir).flatten().flatten();
    let networks = entries.map(|entry| entry.path()).filter(|path| is_network(path));
    let mut names: Vec<String> =
        networks.filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned())).collect();
    names.sort();
    if names.is_empty() { String::new() } else { format!("; there are {}", names.join(", ")) }
}

/// What a network reads of a renderer's g-buffer: its inputs, and what the others are made of.
///
/// # Errors
/// If it names a method that makes no estimates.
pub fn reads(spec: &NetSpec) -> Result<Vec<Attribute>> {
    let mut reads: Vec<Attribute> =
        spec.inputs.iter().copied().filter(|a| !Attribute::MADE.contains(a)).collect();
    let mut add = |attribute: &Attribute| {
        if !reads.contains(attribute) {
            reads.push(*attribute);
        }
    };
    spec.inputs.iter().flat_map(|input| input.made_of()).for_each(&mut add);
    for estimate in &spec.estimates {
        let estimator = estimator(spec, estimate)?;
        // Of a file nobody knows the scene: it has to have what that alone tells.
        let of_file = if estimator.reads_scene() { estimator.makes() } else { estimator.reads() };
        of_file.iter().for_each(&mut add);
    }
    Ok(reads)
}

/// What each method makes that estimates something of a g-buffer alone: a file may have that already.
///
/// # Errors
/// If a network names a method that makes no estimates.
pub fn estimated(spec: &NetSpec) -> Result<Vec<&'static [Attribute]>> {
    let estimators = spec.estimates.iter().map(|estimate| estimator(spec, estimate));
    let estimators: Vec<_> = estimators.collect::<Result<_, _>>()?;
    let on_screen = estimators.iter().filter(|estimator| !estimator.reads_scene());
    Ok(on_screen.map(|estimator| estimator.makes()).collect())
}

/// What is to be said of a frame that is unlike those that a network was trained on; nothing where it is like
/// them, or where that is not known.
pub fn outside(spec: &NetSpec, gbuffer: &GBuffer, radius: f32) -> Option<String> {
    let trained = spec.trained?;
    let outside = trained.outside(spec.effect, gbuffer, radius).ok()?;
    outside.warning(&trained)
}

/// A trained network on a device.
pub struct Learned {
    engine: Engine,
    /// What it reads where the processor runs it.
    estimates: Estimates,
    /// What runs around it where an adapter does.
    card: Option<Card>,
}

impl Learned {
    /// Prepares the network for the device, or for the processor where that is faster.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn new(gpu: &Gpu, model: &Model) -> Result<Self, MethodError> {
        Self::on(engine::card(gpu), model)
    }

    /// Prepares the network for the device, whatever it is, so that times of several methods are of one
    /// device.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn on_adapter(gpu: &Gpu, model: &Model) -> Result<Self, MethodError> {
        Self::on(Some(gpu), model)
    }

    /// Prepares the network for the processor.
    ///
    /// # Errors
    /// If the weights are not the spec's.
    pub fn on_processor(model: &Model) -> Result<Self, MethodError> {
        Self::on(None, model)
    }

    fn on(gpu: Option<&Gpu>, model: &Model) -> Result<Self, MethodError> {
        let card = gpu.map(|gpu| Card::new(gpu, &model.spec)).transpose()?;
        let estimates = Estimates::new(&model.spec)?;
        Ok(Self { engine: Engine::new(gpu, model).map_err(failed)?, estimates, card })
    }

    /// What the first of a network's runs reads of a g-buffer, with what methods estimate for it on the
    /// processor.
    ///
    /// # Errors
    /// If the g-buffer lacks something.
    #[cfg(feature = "train")]
    pub fn input(spec: &NetSpec, gbuffer: &GBuffer, radius: f32) -> Result<Planes, MethodError> {
        let missing = |source: MissingAttribute| MethodError::Missing { method: LEARNED, source };
        let (estimated, _) = Estimates::new(spec)?.of(&of_gbuffer(gbuffer, radius), Repeats::ONCE)?;
        let prepared = spec.prepared(estimated.as_ref().unwrap_or(gbuffer), radius).map_err(missing)?;
        let scaling = spec.scaling(&prepared, radius).map_err(missing)?;
        spec.input(&prepared, scaling, 0).map_err(missing)
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        self.engine.spec()
    }

    /// The methods that look at the scene itself and estimate what the network reads, with the layer that
    /// each makes.
    ///
    /// # Errors
    /// If there is no such method or quality.
    pub fn estimates_of_scene(&self, gpu: &Gpu) -> Result<Vec<(Attribute, ScreenMethod)>, MethodError> {
        estimates::of_scene(gpu, self.spec())
    }

    /// What the network makes of a g-buffer, for an effect that reaches so many metres. The time is that of
    /// all that its image takes: what methods estimate for it, what else is made for it to read, and the
    /// network, without sending the g-buffer to a card and the image back.
    ///
    /// # Errors
    /// If the g-buffer lacks something, an estimate asks for the scene, or the device fails.
    pub fn image(&self, gbuffer: &GBuffer, radius: f32, repeats: Repeats) -> Result<Shaded, MethodError> {
        self.image_of(&of_gbuffer(gbuffer, radius), repeats)
    }

    /// As [`Learned::image`], awaited.
    ///
    /// # Errors
    /// As [`Learned::image`].
    pub async fn image_async(
        &self,
        gbuffer: &GBuffer,
        radius: f32,
        repeats: Repeats,
    ) -> Result<Shaded, MethodError> {
        self.image_of_async(&of_gbuffer(gbuffer, radius), repeats).await
    }

    fn image_of(&self, inputs: &EstimateInputs<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let waited_for = gpu::wait(self.image_of_async(inputs, repeats));
        waited_for.map_err(|source| MethodError::Gpu { method: LEARNED, source })?
    }

    async fn image_of_async(
        &self,
        inputs: &EstimateInputs<'_>,
        repeats: Repeats,
    ) -> Result<Shaded, MethodError> {
        let size = [inputs.gbuffer.height(), inputs.gbuffer.width()];
        let runner = self.engine.on_card(size).map_err(failed)?;
        match self.card.as_ref().zip(runner) {
            Some((card, runner)) => card.image(runner, inputs, repeats).await,
            None => self.image_by_processor(inputs, repeats).await,
        }
    }

    /// What is made where the processor runs the network.
    async fn image_by_processor(
        &self,
        inputs: &EstimateInputs<'_>,
        repeats: Repeats,
    ) -> Result<Shaded, MethodError> {
        let missing = |source: MissingAttribute| MethodError::Missing { method: LEARNED, source };
        let (spec, EstimateInputs { gbuffer, radius, .. }) = (self.spec(), *inputs);
        let Repeats { warm_up, timed } = repeats;
        let (estimated, of_estimates) = self.estimates.of(inputs, repeats)?;
        let prepare = || spec.prepared(estimated.as_ref().unwrap_or(gbuffer), radius).map_err(missing);
        let (prepared, of_preparing) = estimates::timed(prepare, repeats)?;
        let mut milliseconds = of_estimates + of_preparing;
        let mut runs = Vec::new();
        let scaling = spec.scaling(&prepared, radius).map_err(missing)?;
        for run in 0..spec.runs() {
            let input = spec.input(&prepared, scaling, run).map_err(missing)?;
            let (image, timing) = self.engine.run_async(&input, warm_up, timed).await.map_err(failed)?;
            runs.push(image);
            milliseconds += timing.milliseconds;
        }
        let mut image = spec.image(&runs, scaling);
        spec.set_background(gbuffer, &mut image).map_err(missing)?;
        Ok(Shaded { image, milliseconds, clock: Clock::Cpu, device: self.engine.device() })
    }

    /// All that its image of a frame takes, to be recorded with the frame, from a g-buffer on its adapter
    /// into `image`, `[effect's channels, height, width]`. None where it reads light, of which a frame has to
    /// be exposed first, or the processor runs it.
    ///
    /// # Errors
    /// If the g-buffer lacks something or the device fails.
    pub fn record(
        &self,
        gbuffer: &GpuGBuffer,
        view: &View,
        image: &wgpu::Buffer,
    ) -> Result<Option<Recorded>, MethodError> {
        let Some(card) = self.card.as_ref().filter(|_| !self.spec().reads_light()) else { return Ok(None) };
        let runner = self.engine.on_card([view.height, view.width]).map_err(failed)?;
        let scaling = self.spec().scaling_of_lengths(view.radius);
        runner.map(|runner| card.record(runner, gbuffer, view, scaling, image)).transpose()
    }

    /// Tells what was recorded of another frame.
    pub fn look(&self, recorded: &Recorded, view: &View) {
        if let Some(card) = &self.card {
            card.look(recorded, view, self.spec().scaling_of_lengths(view.radius));
        }
    }
}

impl Method for Learned {
    fn name(&self) -> &'static str {
        LEARNED
    }

    fn effect(&self) -> Effect {
        self.spec().effect
    }

    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let scene = Some((frame.scene, frame.camera));
        self.image_of(&EstimateInputs { scene, ..of_gbuffer(frame.gbuffer, frame.radius) }, repeats)
    }
}

/// What estimates are made of where nothing but the g-buffer is known.
const fn of_gbuffer(gbuffer: &GBuffer, radius: f32) -> EstimateInputs<'_> {
    EstimateInputs { gbuffer, radius, seed: SEED, scene: None }
}

fn failed(error: ForwardError) -> MethodError {
    match error {
        ForwardError::Gpu(source) => MethodError::Gpu { method: LEARNED, source },
        other => MethodError::Other { method: LEARNED, what: other.to_string() },
    }
}
