//! A frame on the GPU, from the moment and the camera to the g-buffer, in stages that can be timed one by one. All is
//! allocated when it is made; from frame to frame only small uniforms are written.

use super::attributes::{self, Materials};
use super::geometry::Geometry;
use super::light::{self, Lights};
use super::pose::Posing;
use super::reflective::ReflectiveMap;
use super::shadow::{self, MapPlan, Seen, ShadowPass};
pub use super::stage::Stage;
use super::surface::{SurfaceImage, SurfacePass};
use super::texture::Textures;
use super::view::perspective;
use crate::scene::gltf::Rig;
use crate::scene::{AnimatedScene, Bounds, Camera, Light};
use crate::screen::{GpuGBuffer, Step};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu, GpuError, Stamps};
use deepshade_shaders::wgsl::uniforms::FrameView;

/// Nothing nearer to the eye than this share of the scene's diagonal is drawn.
const NEAR: f32 = 1e-5;

/// What a frame is made for.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// What the g-buffer holds.
    pub attributes: Vec<Attribute>,
    /// Edge of shadow maps, texels; smaller where there are many lights.
    pub shadow_size: usize,
}

/// A scene on the GPU, and all passes that make its g-buffer.
#[derive(Debug)]
pub struct Frame {
    rigs: Vec<Rig>,
    lights: Vec<Light>,
    bounds: Bounds,
    geometry: Geometry,
    posing: Option<Posing>,
    surface: SurfacePass,
    image: SurfaceImage,
    materials: Materials,
    pub(super) gpu_lights: Lights,
    map_plan: MapPlan,
    shadows: ShadowPass,
    attributes: Vec<Step>,
    light: Option<Step>,
    gbuffer: GpuGBuffer,
    /// From where the last frame that was set is seen.
    view: Option<FrameView>,
    camera: Option<Camera>,
    view_before: wgpu::Buffer,
    /// Whether the maps show what they did in the frame before.
    maps_stay: bool,
    map_views: Vec<FrameView>,
    /// What the device cannot do as it was asked to, in words.
    pub notes: Vec<String>,
}

impl Frame {
    /// Sends a scene to the GPU and compiles the passes.
    ///
    /// # Errors
    /// If the device refuses or has no room; the buffer, texture or pass is named.
    pub fn new(gpu: &Gpu, animated: &AnimatedScene, settings: &Settings) -> Result<Self, GpuError> {
        let AnimatedScene { scene, rigs } = animated;
        let Settings { height, width, shadow_size, .. } = *settings;
        let device = &gpu.device;
        let is_light =
            |attribute: &Attribute| matches!(attribute, Attribute::Light | Attribute::DiffuseLight);
        let lit = settings.attributes.iter().any(is_light);
        let held: Vec<Attribute> = settings.attributes.iter().copied().filter(|a| !is_light(a)).collect();
        let light = if lit { &[Attribute::Light, Attribute::DiffuseLight][..] } else { &[] };
        let gbuffer = GpuGBuffer::empty(device, height, width, &[&held[..], light].concat())?;

        let textures = Textures::new(gpu, &scene.textures)?;
        let geometry = Geometry::new(device, animated)?;
        let posing = Posing::new(gpu, animated, &geometry)?;
        let surface = SurfacePass::new(device, &scene.materials, &textures)?;
        let image = surface.image(device, height, width)?;
        let materials = Materials::new(device, scene)?;
        let map_plan =
            if lit { MapPlan::new(&scene.lights, shadow_size) } else { MapPlan::without(&scene.lights) };
        let gpu_lights = Lights::new(device, scene, &map_plan)?;
        let shadows = ShadowPass::new(device, &map_plan, &scene.materials, &textures)?;
        let attributes = attributes::steps(device, &image, &materials, &gbuffer)?;
        let light = lit
            .then(|| light::step(device, &image, &materials, &gpu_lights, &shadows, &gbuffer))
            .transpose()?;
        Ok(Self {
            rigs: rigs.clone(),
            lights: scene.lights.clone(),
            bounds: animated.reach(),
            notes: notes(&textures, lit.then_some((&map_plan, shadow_size))),
            geometry,
            posing,
            surface,
            image,
            materials,
            gpu_lights,
            map_plan,
            shadows,
            attributes,
            light,
            gbuffer,
            view: None,
            camera: None,
            view_before: gpu::uniform::<FrameView>(
                device,
                "frame.view_before",
                &bytemuck::Zeroable::zeroed(),
            )?,
            maps_stay: false,
            map_views: Vec::new(),
        })
    }

    /// Says what the next frame shows: the scene at `time` seconds, with the shutter open for `shutter` seconds around it,
    /// seen by a camera.
    pub fn set(&mut self, queue: &wgpu::Queue, time: f32, shutter: f32, camera: &Camera) {
        let (height, width) = (self.gbuffer.height(), self.gbuffer.width());
        let view = perspective(camera, height, width, NEAR * self.bounds.diagonal());
        self.image.set(queue, &view);
        queue.write_buffer(&self.view_before, 0, bytemuck::bytes_of(&self.view.unwrap_or(view)));
        self.view = Some(view);
        if let Some(posing) = &mut self.posing {
            posing.set(queue, &self.rigs, time, shutter);
        }
        let were = self.lights.clone();
        self.rigs.iter().for_each(|rig| rig.light(&mut self.lights, time));
        if self.lights != were {
            self.gpu_lights.set(queue, &self.lights);
        }
        self.camera = Some(*camera);
        let seen = Seen { camera, aspect: width as f32 / height as f32, bounds: self.bounds };
        let views = self.map_plan.views(&self.lights, seen);
        let same = bytemuck::cast_slice::<_, u8>(&views) == bytemuck::cast_slice::<_, u8>(&self.map_views);
        self.maps_stay = same && self.posing.is_none();
        if !same {
            self.shadows.set(queue, &views);
            queue.write_buffer(&self.gpu_lights.map_views, 0, bytemuck::cast_slice(&views));
            self.map_views = views;
        }
    }

    /// Records a stage. Shadow maps that show what they already do are kept.
    pub fn encode(&self, stage: Stage, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        match stage {
            Stage::Pose => compute(encoder, stage, stamps, |pass| {
                self.posing.iter().for_each(|posing| posing.encode(pass));
            }),
            Stage::Shadows => self.encode_shadows(encoder, stamps),
            Stage::Surface => {
                self.surface.encode(encoder, &self.geometry, &self.image, stamps.map(Stamps::of_raster));
            }
            Stage::Attributes => compute(encoder, stage, stamps, |pass| dispatch(&self.attributes, pass)),
            Stage::Light => compute(encoder, stage, stamps, |pass| dispatch(self.light.as_slice(), pass)),
        }
    }

    fn encode_shadows(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        let maps = if self.maps_stay { 0 } else { self.map_plan.maps };
        if maps == 0 {
            return compute(encoder, Stage::Shadows, stamps, |_| {});
        }
        for map in 0..maps {
            let stamps = stamps.and_then(|stamps| stamps.of_one_raster(map == 0, map + 1 == maps));
            self.shadows.encode(encoder, &self.geometry, map, stamps);
        }
    }

    /// What the camera sees, once all stages have run.
    pub const fn gbuffer(&self) -> &GpuGBuffer {
        &self.gbuffer
    }

    /// For each pixel eight words, of which the last tells how far its surface came since the frame before.
    pub const fn image(&self) -> &SurfaceImage {
        &self.image
    }

    /// From where the frame before was seen.
    pub const fn view_before(&self) -> &wgpu::Buffer {
        &self.view_before
    }

    /// Which materials the words mean.
    pub const fn materials(&self) -> &Materials {
        &self.materials
    }

    /// A reflective shadow map of one of the scene's lights, `size` texels wide.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn reflective_map(&self, gpu: &Gpu, light: usize, size: usize) -> Result<ReflectiveMap, GpuError> {
        ReflectiveMap::new(&gpu.device, &self.surface, &self.materials, &self.gpu_lights, light, size)
    }

    /// From where the maps of one of the scene's lights look in this frame, `size` texels wide each; none before a frame is
    /// set.
    pub fn light_views(&self, light: usize, size: usize) -> Vec<FrameView> {
        let aspect = self.gbuffer.width() as f32 / self.gbuffer.height() as f32;
        let seen = |camera| Seen { camera, aspect, bounds: self.bounds };
        self.camera.iter().flat_map(|camera| shadow::views(&self.lights[light], size, seen(camera))).collect()
    }

    /// Draws a reflective shadow map of this frame.
    pub fn encode_reflective(&self, map: &ReflectiveMap, encoder: &mut wgpu::CommandEncoder) {
        map.encode(encoder, &self.surface, &self.geometry);
    }

    /// Vertices as they are posed, `[vertices, 16]`.
    pub const fn geometry(&self) -> &Geometry {
        &self.geometry
    }
}

/// What the device does in another way than asked; of shadows where any are asked for, with maps of which size.
fn notes(textures: &Textures, shadows: Option<(&MapPlan, usize)>) -> Vec<String> {
    let mut notes = Vec::new();
    if !textures.reduced.is_empty() {
        notes.push(format!(
            "{} textures are larger than the device allows and were halved",
            textures.reduced.len()
        ));
    }
    let Some((plan, shadow_size)) = shadows else { return notes };
    if plan.maps > 0 && plan.size < shadow_size {
        notes.push(format!(
            "shadow maps have {} texels to a side, since there are {} of them",
            plan.size, plan.maps
        ));
    }
    match plan.without_shadow() {
        0 => {}
        faint => notes
            .push(format!("{faint} of the fainter lights cast no shadow: there is no room for their maps")),
    }
    notes
}

/// Records a compute pass of its own.
fn compute(
    encoder: &mut wgpu::CommandEncoder,
    stage: Stage,
    stamps: Option<&Stamps<'_>>,
    record: impl FnOnce(&mut wgpu::ComputePass<'_>),
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(stage.name()),
        timestamp_writes: stamps.map(Stamps::of_compute),
    });
    record(&mut pass);
}

fn dispatch(steps: &[Step], pass: &mut wgpu::ComputePass<'_>) {
    for step in steps {
        step.pass.dispatch_in(pass, step.workgroups);
    }
}
