//! The thread that makes frames: a scene on the GPU and the methods that are wanted. It has a device of its
//! own, so that the window stays responsive while a frame takes its time, and outlives a device that is lost.

mod method_frame;

use super::Args;
use super::catch_panic::catch_panic;
use super::display_image::DisplayImage;
use super::request_slot::RequestSlot;
use super::subject::PreparedScene;
use super::workers::{SendUpdate, Update};
use crate::learned::{self, Learned};
use crate::live::{Live, LiveSettings};
use crate::methods::{self, LEARNED, Runs, Setup};
use crate::output::message;
use crate::radius;
use crate::render::picture::Exposure;
use anyhow::{Context, Result};
use deepshade_infer::Model;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::{Changes, Tuning};
use deepshade_render::scene::{Camera, Glow, Light, SceneSource};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes};
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::path::PathBuf;
use std::sync::Arc;

pub use method_frame::{MethodFrame, Request};

/// What is made of every frame; where this changes, the scene goes to the GPU anew.
#[derive(Clone, PartialEq)]
pub struct Show {
    /// The scene.
    pub source: SceneSource,
    /// How often the user has opened a scene: its files are read anew each time.
    pub scenes_opened: u32,
    /// What is computed.
    pub effect: Effect,
    /// By which methods, in the order in which they are shown.
    pub methods: Vec<&'static str>,
    /// How much time they may take.
    pub quality: Quality,
    /// What is set by hand of which of them.
    pub changes: BTreeMap<&'static str, Changes>,
    /// How far the effect reaches, metres; by default as far as it does everywhere.
    pub radius: Option<f32>,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Whether images are mixed with those of the frames before.
    pub temporal: bool,
    /// What of the g-buffer is shown beside.
    pub inspected: Option<Attribute>,
    /// Folder of the trained network; by default the usual one of the effect.
    pub model: Option<PathBuf>,
    /// How often the user has opened a network, as of scenes.
    pub models_opened: u32,
    /// Its weights, where a training run makes new ones; by default those in the folder.
    pub trained: Option<Trained>,
    /// What keeps light, where it was designed in the window; by default what the scene has.
    pub glow: Option<Arc<Glow>>,
}

/// Weights that a training run has come to; others than these where they were read at another time.
#[derive(Clone)]
pub struct Trained(pub Arc<Model>);

impl PartialEq for Trained {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Display for Show {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {} by {}", self.effect, self.source, self.methods.join(", "))
    }
}

impl Show {
    /// How a method runs.
    pub fn tuning(&self, method: &str) -> Tuning {
        Tuning { quality: self.quality, changes: self.changes.get(method).cloned().unwrap_or_default() }
    }
}

/// Makes what is requested until the slot is closed.
pub fn run(args: &Args, requests: &RequestSlot<Request>, send: SendUpdate<'_>) {
    let mut worker = MethodWorker::default();
    while let Some(request) = requests.take() {
        let doing = request.show.to_string();
        match catch_panic(&doing, || worker.make(args, request, send)) {
            Ok(picture) => {
                let picture = Arc::new(picture);
                worker.made = Some(Arc::clone(&picture));
                send(Update::Picture(picture));
            }
            Err(error) => {
                worker = MethodWorker::default();
                send(Update::NoPicture(message(&error)));
            }
        }
    }
}

/// What is kept from frame to frame.
#[derive(Default)]
struct MethodWorker {
    gpu: Option<Gpu>,
    /// The scene, and how often one had been opened when it was read.
    subject: Option<(u32, Arc<PreparedScene>)>,
    scene: Option<LiveScene>,
    passes: Vec<Pass>,
    /// The picture that was made last.
    made: Option<Arc<MethodFrame>>,
}

/// A scene on the GPU with its methods.
struct LiveScene {
    show: Show,
    live: Live,
    /// Methods of the live scene, in its order.
    live_names: Vec<&'static str>,
    on_processor: Vec<Box<dyn Method>>,
    radius: f32,
    /// What is to be said of what a camera sees where it is unlike what the network was trained on.
    outside: Option<(Camera, Option<String>)>,
}

impl MethodWorker {
    fn make(&mut self, args: &Args, request: Request, send: SendUpdate<'_>) -> Result<MethodFrame> {
        if let Some(picture) = self.made.as_ref().and_then(|made| made.exposed(&request)) {
            return Ok(picture);
        }
        let show = &request.show;
        let subject = self.subject(args, show, send)?;
        let camera = request.camera.unwrap_or(subject.controller.camera);
        let kept = self.scene.take().map(|scene| scene.suited_to(show, &subject)).transpose()?.flatten();
        let scene = match kept {
            Some(scene) => scene,
            None => {
                self.passes.clear();
                LiveScene::new(args, self.gpu()?, &subject, show, &camera)?
            }
        };
        let scene = self.scene.insert(scene);
        let lights = subject.lights(request.lights.as_deref());
        scene.live.set_lights(&lights);
        if let Some(times) = scene.live.make(request.time, request.number, &camera)? {
            self.passes = scene.live.passes().into_iter().zip(times).collect();
        }
        let warning = scene.warning(&camera)?;
        let (images, of_processor) = scene.images(&subject, &request, &camera, &lights)?;
        let exposure = request.exposed(images.first().map(|(_, first)| first));
        let shown = exposure.unwrap_or(Exposure::Plain);
        let images = images.into_iter().map(|(name, image)| DisplayImage::new(name, image, shown)).collect();
        let inspected =
            show.inspected.map(|attribute| scene.live.attribute(attribute).map(|values| (attribute, values)));
        let inspected =
            inspected.transpose()?.map(|(attribute, values)| DisplayImage::of_attribute(attribute, values));
        let passes = self.passes.iter().cloned().chain(of_processor).collect();
        let radius = scene.radius;
        Ok(MethodFrame {
            subject,
            camera,
            lights,
            radius,
            warning,
            exposure,
            images,
            inspected,
            passes,
            request,
        })
    }

    /// The scene, read anew where another one is wanted, another effect of it, or the same as its files are
    /// now; with other paints where such were designed.
    fn subject(&mut self, args: &Args, show: &Show, send: SendUpdate<'_>) -> Result<Arc<PreparedScene>> {
        let known = self.subject.as_ref().filter(|(opened, subject)| {
            (&subject.source, subject.effect, *opened) == (&show.source, show.effect, show.scenes_opened)
        });
        let read = match known {
            Some((_, subject)) if subject.designed == show.glow => return Ok(Arc::clone(subject)),
            Some((_, subject)) => Arc::clone(subject),
            None => {
                self.scene = None;
                Arc::new(PreparedScene::load(args, &show.source, show.effect)?)
            }
        };
        let subject = read.with_glow(show.glow.as_ref());
        send(Update::PreparedScene(Arc::clone(&subject)));
        self.subject = Some((show.scenes_opened, Arc::clone(&subject)));
        Ok(subject)
    }

    fn gpu(&mut self) -> Result<Gpu> {
        let gpu = match self.gpu.take() {
            Some(gpu) => gpu,
            None => Gpu::new()?,
        };
        Ok(self.gpu.insert(gpu).clone())
    }
}

impl LiveScene {
    fn new(args: &Args, gpu: Gpu, subject: &PreparedScene, show: &Show, camera: &Camera) -> Result<Self> {
        let screen = methods::screen_names(show.effect);
        let (on_screen, others): (Vec<&str>, Vec<&str>) =
            show.methods.iter().partition(|name| screen.contains(name));
        let open = |name: &&str| methods::open_screen(show.effect, name, &gpu, show.tuning(name));
        let opened = on_screen.iter().map(open).collect::<Result<Vec<_>>>()?;
        let learned = others.contains(&LEARNED).then(|| network(show, &gpu)).transpose()?;
        let processor: Vec<&str> = others.into_iter().filter(|name| *name != LEARNED).collect();
        let mut on_processor = Vec::new();
        for name in processor {
            let setup = Setup { gpu: &gpu, runs: Runs::Fastest, model: None, tuning: &show.tuning(name) };
            on_processor.extend(methods::open(show.effect, &[name], setup)?);
        }
        let reach = learned.as_ref().map(|learned| learned.spec().reach);
        let radius = radius::wanted(show.radius, reach, &[show.effect], subject.space);
        let mut attributes = vec![Attribute::Valid];
        attributes.extend(show.inspected);
        if !on_processor.is_empty() {
            attributes.extend_from_slice(show.effect.attributes());
        }
        let mut live_names: Vec<&'static str> = opened.iter().map(|method| method.name()).collect();
        live_names.extend(learned.as_ref().map(|_| LEARNED));
        let wanted = LiveSettings {
            size: show.size,
            methods: opened,
            learned,
            attributes,
            temporal: show.temporal,
            radius,
            shutter: args.shutter(),
        };
        let live = Live::new(&gpu, &subject.animated, camera, wanted)?;
        Ok(Self { show: show.clone(), live, live_names, on_processor, radius, outside: None })
    }

    /// What is to be said of the last frame where it is unlike what the network was trained on, found out
    /// anew where the camera is another one.
    fn warning(&mut self, camera: &Camera) -> Result<Option<String>> {
        if let Some((seen, warning)) = &self.outside
            && seen == camera
        {
            return Ok(warning.clone());
        }
        let warning = self.live.outside()?;
        self.outside = Some((*camera, warning.clone()));
        Ok(warning)
    }

    /// Itself, where it makes what is wanted, or comes to by newer weights of its network, or other paints.
    fn suited_to(mut self, show: &Show, subject: &PreparedScene) -> Result<Option<Self>> {
        if self.show.glow != show.glow {
            // Passes of other effects are made for how bright paints are.
            let glow = subject.animated.scene.glow.as_ref().filter(|_| show.effect == Effect::Phosphor);
            if !glow.is_some_and(|glow| self.live.set_glow(glow)) {
                return Ok(None);
            }
            self.show.glow.clone_from(&show.glow);
        }
        if self.show == *show {
            return Ok(Some(self));
        }
        let before = Show { trained: show.trained.clone(), ..self.show.clone() };
        let (true, Some(Trained(model))) = (before == *show, &show.trained) else { return Ok(None) };
        self.show = before;
        Ok(self.live.train(model)?.then_some(self))
    }

    /// What each method made of the last frame, in the order asked for, and the milliseconds of those that
    /// run on the processor.
    fn images(
        &self,
        subject: &PreparedScene,
        request: &Request,
        camera: &Camera,
        lights: &[Light],
    ) -> Result<(Vec<Image>, Vec<Pass>)> {
        let (mut images, mut times) = (Vec::new(), Vec::new());
        for (index, name) in self.live_names.iter().enumerate() {
            images.push((*name, self.live.image(index)?));
        }
        if !self.on_processor.is_empty() {
            let scene = subject.traced(request.time, lights)?;
            let gbuffer = self.live.gbuffer(self.show.effect.attributes())?;
            let frame =
                Frame { scene: &scene, camera, gbuffer: &gbuffer, radius: self.radius, seed: request.number };
            for method in &self.on_processor {
                let shaded = method.shade(&frame, Repeats::ONCE)?;
                times.push((method.name().to_owned(), shaded.milliseconds));
                images.push((method.name(), shaded.image));
            }
        }
        let place = |name: &str| self.show.methods.iter().position(|method| *method == name);
        images.sort_by_key(|(name, _)| place(name));
        Ok((images, times))
    }
}

/// A pass and its milliseconds.
type Pass = (String, f64);

/// A method's name and its image.
type Image = (&'static str, Planes);

fn network(show: &Show, gpu: &Gpu) -> Result<Learned> {
    let folder = show.model.clone().unwrap_or_else(|| learned::usual_folder(show.effect));
    let model = match &show.trained {
        Some(Trained(model)) if model.spec.effect == show.effect => Arc::clone(model),
        _ => Arc::new(learned::network(&folder, Some(show.effect))?),
    };
    Learned::new(gpu, &model).with_context(|| format!("the network in {}", folder.display()))
}
