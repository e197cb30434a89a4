//! What the page's script asks for: `Page` is the device with what is shown.

use super::canvas::{Canvas, Drawing};
use super::shown_scene::{PageRequest, ShownScene, scores};
use crate::live::camera_controller::CameraController;
use crate::methods::{self, LEARNED, TRUTH};
use crate::render::picture::Exposure;
use anyhow::{Context, Result};
use deepshade_infer::Model;
use deepshade_render::scene::procedural::Family;
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Effect, Planes, wgsl};
use glam::Vec2;
use serde_json::json;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::HtmlCanvasElement;

/// The device, the canvas, and what is shown on it.
#[wasm_bindgen]
pub struct Page {
    gpu: Gpu,
    canvas: Canvas,
    shown: Option<PageState>,
    /// What the device found wrong and nobody was told yet.
    wrong: Arc<Mutex<Vec<String>>>,
}

/// What is shown.
struct PageState {
    wish: PageRequest,
    shown_scene: ShownScene,
    controller: CameraController,
    exposure: Exposure,
    /// Truth, and where the device has it.
    truth: Option<(Planes, wgpu::Buffer)>,
    time: f32,
}

/// What there is to be shown, as JSON: scenes; effects, each with the methods that can run in a browser,
/// those that cannot, and whether fog changes it.
#[wasm_bindgen]
pub fn choices() -> String {
    let effect = |effect: &Effect| {
        let can = |name: &&str| *name == LEARNED || methods::screen_names(*effect).contains(name);
        let all = methods::names_of(*effect).into_iter().filter(|name| *name != TRUTH);
        let (can, cannot): (Vec<_>, Vec<_>) = all.partition(can);
        json!({
            "name": effect.name(),
            "unit": effect.unit(),
            "methods": can,
            "processor": cannot,
            "fog": effect.listens_to(EffectSetting::Medium),
        })
    };
    let scene = |family: &Family| json!({ "name": family.name(), "about": family.about() });
    let effects: Vec<_> = Effect::ALL.iter().map(effect).collect();
    let scenes: Vec<_> = Family::ALL.iter().map(scene).collect();
    json!({ "effects": effects, "scenes": scenes }).to_string()
}

/// Every shader of the program, as JSON: its name and its source. Browsers hold WGSL to more rules than
/// programs do.
#[wasm_bindgen]
pub fn shaders() -> String {
    json!(wgsl::all().map(|shader| (shader.name(), shader.source())).collect::<Vec<_>>()).to_string()
}

#[wasm_bindgen]
impl Page {
    /// Opens the browser's device and takes hold of the canvas.
    ///
    /// # Errors
    /// If there is no device.
    pub async fn open(canvas: HtmlCanvasElement) -> Result<Self, JsError> {
        let (gpu, canvas) = said(opened(canvas).await)?;
        let wrong = Arc::new(Mutex::new(Vec::new()));
        let list = Arc::clone(&wrong);
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            list.lock().unwrap_or_else(PoisonError::into_inner).push(error.to_string());
        }));
        Ok(Self { gpu, canvas, shown: None, wrong })
    }

    /// What the device has found wrong since this was asked last; a browser says so some time after the
    /// mistake.
    pub fn wrong(&self) -> Option<String> {
        let list = std::mem::take(&mut *self.wrong.lock().unwrap_or_else(PoisonError::into_inner));
        (!list.is_empty()).then(|| list.join("; "))
    }

    /// The device, in words.
    pub fn device(&self) -> String {
        let info = &self.gpu.info;
        let named = [&info.name, &info.driver].into_iter().find(|name| !name.is_empty());
        let kind = if self.gpu.is_software() { "software adapter" } else { "WebGPU adapter" };
        named.map_or_else(|| kind.to_owned(), |name| format!("{name}, {kind}"))
    }

    /// Prepares what is wished for, as JSON; with the two files of a model's folder where the network takes
    /// part. Gives the methods, in the order of [`Page::image`], what was added to the scene, and how far the
    /// effect reaches.
    ///
    /// # Errors
    /// If there is no such scene or method, or the device refuses.
    pub async fn show(
        &mut self,
        wish: &str,
        spec: Option<Vec<u8>>,
        weights: Option<Vec<u8>>,
    ) -> Result<String, JsError> {
        // What was shown goes first: its room is wanted.
        self.shown = None;
        let (shown, told) = said(self.prepared(wish, spec.zip(weights)).await)?;
        self.canvas.resize(&self.gpu, shown.wish.size);
        self.shown = Some(shown);
        Ok(told)
    }

    async fn prepared(&self, wish: &str, model: Option<(Vec<u8>, Vec<u8>)>) -> Result<(PageState, String)> {
        let wish: PageRequest = serde_json::from_str(wish)?;
        let model = model.map(|(spec, weights)| Model::from_bytes(Path::new(LEARNED), &spec, weights));
        let mut shown_scene = ShownScene::new(&self.gpu, &wish, model.transpose()?.as_ref())?;
        let controller =
            CameraController::new(shown_scene.animated_view.camera, shown_scene.animated_view.distance());
        shown_scene.make(0.0, &controller.camera).await?;
        let first = shown_scene.live.image_async(0).await?;
        let exposure = Exposure::new(wish.effect, &first, None);
        let animated = &shown_scene.animated_view.animated;
        let told = json!({
            "methods": shown_scene.names,
            "passes": shown_scene.live.passes(),
            "tells_later": shown_scene.live.tells_later(),
            "added": shown_scene.animated_view.added,
            "radius": shown_scene.radius,
            "triangles": animated.scene.triangle_count(),
            "goes_on": animated.span().is_some() || animated.scene.glow.is_some(),
            "exposure": exposure.to_string(),
        });
        Ok((PageState { wish, shown_scene, controller, exposure, truth: None, time: 0.0 }, told.to_string()))
    }

    /// Goes around what is looked at by angles, radians, and nearer to it by a factor.
    pub fn orbit(&mut self, right: f32, up: f32, nearer: f32) {
        let Some(shown) = &mut self.shown else { return };
        shown.controller.orbit(Vec2::new(right, up));
        shown.controller.approach(nearer);
        shown.truth = None;
    }

    /// Makes the frame of a moment, seconds. Gives the milliseconds of each pass, as JSON; `null` where they
    /// are not known yet.
    ///
    /// # Errors
    /// If nothing is shown or the device fails.
    pub async fn frame(&mut self, time: f32) -> Result<String, JsError> {
        let shown = said(self.shown.as_mut().context("nothing is shown"))?;
        if time != shown.time {
            (shown.time, shown.truth) = (time, None);
        }
        let times = said(shown.shown_scene.make(time, &shown.controller.camera).await)?;
        Ok(json!(times).to_string())
    }

    /// Draws two images, methods by their index or truth, beside a border at a share of the width.
    ///
    /// # Errors
    /// If there is no such image.
    pub fn draw(&self, left: &str, right: &str, border: f32) -> Result<(), JsError> {
        said(self.drawn([left, right], border))
    }

    fn drawn(&self, names: [&str; 2], border: f32) -> Result<()> {
        let shown = self.shown.as_ref().context("nothing is shown")?;
        let [left, right] =
            names.map(|name| shown.buffer(name).with_context(|| format!("no image `{name}`")));
        let (effect, size, exposure) = (shown.wish.effect, shown.wish.size, shown.exposure);
        self.canvas.draw(&self.gpu, &Drawing { images: [left?, right?], effect, size, border, exposure })
    }

    /// The values that a method made, `[channels, height, width]`.
    ///
    /// # Errors
    /// If there is no such method or the device fails.
    pub async fn image(&self, name: &str) -> Result<Vec<f32>, JsError> {
        let shown = said(self.shown.as_ref().context("nothing is shown"))?;
        Ok(said(shown.image(name).await)?.data().to_vec())
    }

    /// What truth is to be refined of, for the worker, as JSON.
    ///
    /// # Errors
    /// If nothing is shown.
    pub fn sight(&self) -> Result<String, JsError> {
        let shown = said(self.shown.as_ref().context("nothing is shown"))?;
        let (wish, radius, time) = (&shown.wish, shown.shown_scene.radius, shown.time);
        Ok(json!({ "wish": wish, "camera": shown.controller.camera, "radius": radius, "time": time })
            .to_string())
    }

    /// Takes truth, `[channels, height, width]`, and gives every method's scores against it, as JSON.
    ///
    /// # Errors
    /// If it is of another size, or the device fails.
    pub async fn score(&mut self, truth: Vec<f32>) -> Result<String, JsError> {
        let gpu = self.gpu.clone();
        let shown = said(self.shown.as_mut().context("nothing is shown"))?;
        said(shown.score(&gpu, truth).await)
    }
}

async fn opened(canvas: HtmlCanvasElement) -> Result<(Gpu, Canvas)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let gpu = Gpu::of(&instance).await?;
    let canvas = Canvas::new(&instance, &gpu, canvas)?;
    Ok((gpu, canvas))
}

impl PageState {
    fn index(&self, name: &str) -> Option<usize> {
        self.shown_scene.names.iter().position(|known| *known == name)
    }

    fn buffer(&self, name: &str) -> Option<&wgpu::Buffer> {
        match &self.truth {
            Some((_, buffer)) if name == TRUTH => Some(buffer),
            _ => self.index(name).map(|index| self.shown_scene.live.output(index)),
        }
    }

    async fn image(&self, name: &str) -> Result<Planes> {
        let index = self.index(name).with_context(|| format!("no method `{name}` is shown"))?;
        self.shown_scene.live.image_async(index).await
    }

    async fn score(&mut self, gpu: &Gpu, truth: Vec<f32>) -> Result<String> {
        let ([height, width], channels) = (self.wish.size, self.wish.effect.channels());
        anyhow::ensure!(truth.len() == channels * height * width, "truth of another size");
        let buffer = gpu::storage(&gpu.device, "web.truth", &truth)?;
        let truth = Planes::from_data(channels, height, width, truth);
        let mut all = serde_json::Map::new();
        for name in &self.shown_scene.names {
            let image = self.image(name).await?;
            all.insert((*name).to_owned(), json!(scores(self.wish.effect, &image, &truth)));
        }
        self.truth = Some((truth, buffer));
        Ok(serde_json::Value::Object(all).to_string())
    }
}

/// An error as the page's script gets it, with its causes.
pub fn said<T>(result: Result<T>) -> Result<T, JsError> {
    result.map_err(|error| JsError::new(&crate::output::message(&error)))
}
