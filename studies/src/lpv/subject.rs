//! A scene in fog with a lamp, what light propagation volumes make of it and what is right.

use super::reflective::Texels;
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade_dataset::vary::Lamp;
use deepshade_dataset::views::sample_view;
use deepshade_render::bvh::TracedScene;
use deepshade_render::lpv::LightGrid;
use deepshade_render::methods::Quality;
use deepshade_render::methods::gpu_epipolar;
use deepshade_render::methods::lpv::LpvParameters;
use deepshade_render::methods::lpv::in_medium::InMedium;
use deepshade_render::methods::lpv::passes::Pixel;
use deepshade_render::path::{self, LightPart, Sampling, Shot};
use deepshade_render::raster::frame::{Frame, FrameStage, RasterSettings};
use deepshade_render::scene::{Camera, Density, Light, Look, Material, Medium, SceneSource};
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
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

/// What its g-buffer holds: what the passes read, and light, without which a frame draws no shadow maps and
/// lamps shine through everything.
const ATTRIBUTES: [Attribute; 5] =
    [Attribute::Position, Attribute::Normal, Attribute::Light, Attribute::Diffuse, Attribute::Valid];

/// The frame.
pub struct LpvFrame<'a> {
    /// Where it is shaded.
    pub gpu: &'a Gpu,
    scene: TracedScene,
    frame: Frame,
    view: View,
}

impl<'a> LpvFrame<'a> {
    /// Makes it.
    ///
    /// # Errors
    /// If the scene cannot be read or the device has no room.
    pub fn new(gpu: &'a Gpu, source: &SceneSource, Size { width, height }: Size) -> Result<Self> {
        let (scene, camera) = foggy(&source.trace(0.0)?, [height, width])?;
        let attributes = ATTRIBUTES.to_vec();
        let settings = RasterSettings { height, width, attributes, shadow_size: Some(SHADOW_SIZE) };
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
    pub fn passes(&self, parameters: LpvParameters) -> Result<MethodPasses, GpuError> {
        self.planned(&ScreenMethod::new(self.gpu, InMedium::multiple(parameters)))
    }

    /// Multiple scattering.
    ///
    /// # Errors
    /// If the device fails.
    pub fn multiple(&self, parameters: LpvParameters) -> Result<Planes, GpuError> {
        self.image(&self.passes(parameters)?)
    }

    /// Light of surfaces, where it is shown.
    ///
    /// # Errors
    /// If the device fails.
    pub fn indirect(&self, parameters: LpvParameters, pixel: Pixel) -> Result<Planes, GpuError> {
        let method = ScreenMethod::new(self.gpu, InMedium::indirect_at(parameters, pixel));
        self.image(&self.planned(&method)?)
    }

    /// Light that the medium scatters once, by the epipolar method of `fog-direct`.
    ///
    /// # Errors
    /// If the device fails.
    pub fn single(&self) -> Result<Planes, GpuError> {
        let parameters = gpu_epipolar::GpuEpipolarParameters::of(Quality::High);
        self.image(&self.planned(&ScreenMethod::new(self.gpu, parameters))?)
    }

    /// Path-traced truth of so many samples a pixel.
    pub fn truth(&self, effect: Effect, part: LightPart, samples: u32) -> Planes {
        let View { height, width, camera, radius, .. } = self.view;
        let shot = Shot { part, ..Shot::new(&self.scene, &camera, [height, width], radius) };
        path::render(effect, &shot, Sampling::one(samples, 1)).mean
    }

    /// Of which pixels the lamp lights the surface.
    ///
    /// # Errors
    /// If the device fails.
    pub fn lit(&self) -> Result<Vec<bool>, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        let light: Vec<f32> = gpu::read(device, queue, self.frame.gbuffer().buffer(Attribute::Light))?;
        let pixels = self.view.height * self.view.width;
        Ok((0..pixels).map(|at| (0..3).any(|c| light[at + c * pixels] > 0.0)).collect())
    }

    /// The grid around the scene.
    pub fn grid(&self, parameters: LpvParameters) -> LightGrid {
        LightGrid::around(self.frame.world().bounds, parameters.cells)
    }

    /// The passes of indirect light without a medium.
    ///
    /// # Errors
    /// If the device fails.
    pub fn clear(&self, parameters: LpvParameters) -> Result<MethodPasses, GpuError> {
        self.planned(&ScreenMethod::new(self.gpu, parameters))
    }

    /// What surfels have put into each cell, red, watts, once the passes of [`Self::clear`] have run;
    /// `face` is the area of a cell's.
    ///
    /// # Errors
    /// If the device fails.
    pub fn sent_by_surfels(&self, passes: &MethodPasses, face: f64) -> Result<Vec<f64>, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        gpu::submit(device, queue, "bench.lpv", |encoder| passes.encode(encoder))?;
        let inject = passes.steps().iter().find(|step| step.step.pass.is_of("lpv.inject"));
        let sums = inject.and_then(|step| step.writes.first()).expect("light is injected");
        let sums: Vec<[[u32; 2]; 12]> = gpu::read(device, queue, sums)?;
        // 64 bits of which 40 are behind the point, over the area of a cell's face; the fourth is red's
        // energy.
        let value = |[low, high]: [u32; 2]| (f64::from(high) + f64::from(low) * 2f64.powi(-32)) / 256.0;
        Ok(sums.iter().map(|of_cell| face * value(of_cell[3])).collect())
    }

    /// What the lamp's reflective shadow map of so many texels along an edge holds, and what drawing it
    /// takes, milliseconds.
    ///
    /// # Errors
    /// If the device fails.
    pub fn reflective(&self, size: usize, runs: usize) -> Result<(Texels, f64), GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        let map = self.frame.reflective_map(self.gpu, 0, size)?;
        let (mut all, mut milliseconds) = (Vec::new(), 0.0);
        for view in self.frame.world().light_views(0, size) {
            map.set(queue, &view);
            let draw = |encoder: &mut wgpu::CommandEncoder| self.frame.encode_reflective(&map, encoder);
            milliseconds += gpu::time(device, queue, "bench.reflective", 0, runs, draw)?.milliseconds;
            let texels: Vec<f32> = gpu::read(device, queue, &map.texels)?;
            let plane = |c: usize, at: usize| texels[c * size * size + at];
            let vector = |c: usize, at: usize| Vec3::new(plane(c, at), plane(c + 1, at), plane(c + 2, at));
            all.extend((0..size * size).map(|at| (vector(0, at), vector(3, at), plane(6, at))));
        }
        Ok((all, milliseconds))
    }

    fn planned(&self, method: &ScreenMethod) -> Result<MethodPasses, GpuError> {
        let inputs =
            Inputs { gbuffer: self.frame.gbuffer(), environment: None, world: Some(self.frame.world()) };
        MethodPasses::new(method, &inputs, &self.view)
    }

    fn image(&self, passes: &MethodPasses) -> Result<Planes, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        gpu::submit(device, queue, "bench.lpv", |encoder| passes.encode(encoder))?;
        let data = gpu::read(device, queue, passes.output())?;
        Ok(Planes::from_data(3, self.view.height, self.view.width, data))
    }
}

/// A scene in fog with a spot that shines into what a camera sees, at a place and to a point that are in the
/// open.
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
