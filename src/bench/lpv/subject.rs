//! A scene in fog with a lamp, what light propagation volumes make of it and what is right.

use crate::arguments::Size;
use anyhow::Result;
use deepshade_dataset::vary::Lamp;
use deepshade_dataset::views::sample_view;
use deepshade_render::bvh::TracedScene;
use deepshade_render::methods::lpv::Parameters;
use deepshade_render::methods::lpv::in_medium::{Indirect, IndirectScattering, Multiple, MultipleScattering};
use deepshade_render::methods::lpv::passes::Pixel;
use deepshade_render::path::{self, Part, Sampling, Shot};
use deepshade_render::raster::frame::{Frame, Settings, Stage as FrameStage};
use deepshade_render::scene::{Camera, Density, Light, Look, Material, Medium, SceneSource};
use deepshade_render::screen::{Inputs, Plan, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::Vec3;

/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 1024;
/// Mean free paths along the scene's diagonal.
const OPTICAL_DEPTH: f32 = 4.0;
/// Chooses view and lamp.
const SEED: u32 = 1;
/// What of a collision is scattered.
const ALBEDO: Vec3 = Vec3::new(0.9, 0.92, 0.95);

/// What its g-buffer holds: what the passes read, and light, without which a frame draws no shadow maps and lamps shine
/// through everything.
const ATTRIBUTES: [Attribute; 5] =
    [Attribute::Position, Attribute::Normal, Attribute::Light, Attribute::Diffuse, Attribute::Valid];

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
        let (scene, camera) = foggy(&source.trace(0.0)?, [height, width])?;
        let attributes = ATTRIBUTES.to_vec();
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

/// A scene in fog with a spot that shines into what a camera sees, at a place and to a point that are in the open.
fn foggy(scene: &TracedScene, size: [usize; 2]) -> Result<(TracedScene, Camera)> {
    let camera = sample_view(scene, size, SEED, 0, 0)?;
    let Lamp { position, intensity } = Lamp::drawn(scene, &camera, size, SEED);
    let ahead = -camera.rotation.z_axis;
    let met = scene.hit(camera.position, ahead, f32::INFINITY);
    let middle = camera.position + ahead * met.map_or(scene.diagonal(), |hit| hit.distance);
    let spot = Light::Spot {
        position,
        direction: (middle - position).normalize_or(ahead),
        intensity,
        range: f32::INFINITY,
        cos_inner: 0.8,
        cos_outer: 0.7,
        slide: None,
    };
    let extinction = Vec3::splat(OPTICAL_DEPTH / scene.diagonal());
    let fills = Density::Within(scene.bounds());
    let medium = Medium::new(extinction * (1.0 - ALBEDO), extinction * ALBEDO, 0.0, fills)?;
    let dark = |material: Material| Material { emission: Vec3::ZERO, ..material };
    let look = scene.scene().look();
    let materials = look.materials.iter().cloned().map(dark).collect();
    let medium = Some(medium.into());
    let look = Look { lights: vec![spot], environment: None, medium, materials, ..look };
    Ok((scene.with_look(look)?, camera))
}
