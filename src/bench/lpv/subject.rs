//! A scene in fog with a lamp, what light propagation volumes make of it and what is right.

use crate::arguments::Size;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::methods::lpv::Parameters;
use deepshade_render::methods::lpv::in_medium::{Indirect, IndirectScattering, Multiple, MultipleScattering};
use deepshade_render::methods::lpv::passes::Pixel;
use deepshade_render::path::{self, Part, Sampling, Shot};
use deepshade_render::raster::frame::{Frame, Settings, Stage as FrameStage};
use deepshade_render::scene::{Camera, Density, Light, Material, Medium, Scene, SceneSource};
use deepshade_render::screen::{Inputs, Plan, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::Vec3;

/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 1024;
/// Mean free paths along the scene's diagonal.
const OPTICAL_DEPTH: f32 = 4.0;
/// What of a collision is scattered.
const ALBEDO: Vec3 = Vec3::new(0.9, 0.92, 0.95);

/// The frame.
pub struct Subject<'a> {
    /// Where it is shaded.
    pub gpu: &'a Gpu,
    scene: TracedScene,
    frame: Frame,
    view: View,
}

impl<'a> Subject<'a> {
    /// Makes it.
    ///
    /// # Errors
    /// If the scene cannot be read or the device has no room.
    pub fn new(gpu: &'a Gpu, source: &SceneSource, Size { width, height }: Size) -> Result<Self> {
        let (scene, camera) = foggy(source.scene(0.0)?)?;
        let scene = TracedScene::new(scene)?;
        let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
        let settings = Settings { height, width, attributes, shadow_size: SHADOW_SIZE };
        let mut frame = Frame::new(gpu, &scene.scene().clone().into(), &settings)?;
        frame.set(&gpu.queue, 0.0, 0.0, &camera);
        gpu::submit(&gpu.device, &gpu.queue, "bench.lpv", |encoder| {
            FrameStage::ALL.into_iter().for_each(|stage| frame.encode(stage, encoder, None));
        })?;
        let view = View { height, width, camera, radius: scene.diagonal(), seed: 0 };
        Ok(Self { gpu, scene, frame, view })
    }

    /// The passes of multiple scattering.
    ///
    /// # Errors
    /// If the device fails.
    pub fn plan(&self, parameters: Parameters) -> Result<Plan, GpuError> {
        self.planned(&MultipleScattering::new(self.gpu, Multiple(parameters))?)
    }

    /// Multiple scattering.
    ///
    /// # Errors
    /// If the device fails.
    pub fn multiple(&self, parameters: Parameters) -> Result<Planes, GpuError> {
        self.image(&self.plan(parameters)?)
    }

    /// Light of surfaces, where it is shown.
    ///
    /// # Errors
    /// If the device fails.
    pub fn indirect(&self, parameters: Parameters, pixel: Pixel) -> Result<Planes, GpuError> {
        let method = IndirectScattering::new(self.gpu, Indirect(parameters, pixel))?;
        self.image(&self.planned(&method)?)
    }

    /// Path-traced truth of so many samples a pixel.
    pub fn truth(&self, effect: Effect, part: Part, samples: u32) -> Planes {
        let View { height, width, camera, radius, .. } = self.view;
        let shot = Shot { part, ..Shot::new(&self.scene, &camera, [height, width], radius) };
        path::render(effect, &shot, Sampling::one(samples, 1)).mean
    }

    fn planned(&self, method: &impl ScreenMethod) -> Result<Plan, GpuError> {
        let inputs =
            Inputs { gbuffer: self.frame.gbuffer(), environment: None, world: Some(self.frame.world()) };
        Plan::new(method, &inputs, &self.view)
    }

    fn image(&self, plan: &Plan) -> Result<Planes, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        gpu::submit(device, queue, "bench.lpv", |encoder| plan.encode(encoder))?;
        let data = gpu::read(device, queue, plan.output())?;
        Ok(Planes::from_data(3, self.view.height, self.view.width, data))
    }
}

/// A scene in fog with a spot that shines across it from above, as in the paper's figures, and a camera that looks
/// along it.
fn foggy(scene: Scene) -> Result<(Scene, Camera)> {
    let (bounds, size) = (scene.bounds(), scene.bounds().size());
    let at = |x: f32, y: f32, z: f32| bounds.centre() + size * Vec3::new(x, y, z);
    let position = at(0.05, 0.3, 0.0);
    let spot = Light::Spot {
        position,
        direction: (at(-0.2, -0.5, 0.02) - position).normalize(),
        intensity: Vec3::new(1.0, 0.9, 0.75) * bounds.diagonal().powi(2),
        range: f32::INFINITY,
        cos_inner: 0.95,
        cos_outer: 0.9,
        slide: None,
    };
    let extinction = Vec3::splat(OPTICAL_DEPTH / bounds.diagonal());
    let medium = Medium::new(extinction * (1.0 - ALBEDO), extinction * ALBEDO, 0.0, Density::Within(bounds))?;
    let dark = |material: Material| Material { emission: Vec3::ZERO, ..material };
    let materials = scene.materials.iter().cloned().map(dark).collect();
    let scene =
        Scene { lights: vec![spot], environment: None, medium: Some(medium.into()), materials, ..scene };
    Ok((scene, Camera::look_at(at(0.4, -0.1, 0.05), at(-0.2, -0.15, 0.0))))
}
