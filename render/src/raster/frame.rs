//! A frame on the GPU, from the moment and the camera to the g-buffer, in stages that can be timed one by
//! one. All is allocated when it is made; from frame to frame only small uniforms are written.

use super::attributes;
pub use super::frame_stage::FrameStage;
use super::light;
use super::reflective::ReflectiveMap;
use super::surface::{SurfaceImage, SurfacePass};
use super::view::perspective;
use super::world::World;
use crate::scene::{AnimatedScene, Camera, Glow, Light};
use crate::screen::{GpuGBuffer, PassDispatch};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu, GpuError, Stamps};
use deepshade_shaders::wgsl::uniforms::FrameView;
use std::sync::Arc;

/// Nothing nearer to the eye than this share of the scene's diagonal is drawn.
const NEAR: f32 = 1e-5;

/// What a frame is made for.
#[derive(Clone, Debug)]
pub struct RasterSettings {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// What the g-buffer holds.
    pub attributes: Vec<Attribute>,
    /// Edge of shadow maps, texels, smaller where there are many lights; without, lamps shine through
    /// everything.
    pub shadow_size: Option<usize>,
}

/// A scene on the GPU, and all passes that make its g-buffer.
#[derive(Debug)]
pub struct Frame {
    world: World,
    surface: SurfacePass,
    image: SurfaceImage,
    attributes: Vec<PassDispatch>,
    light: Option<PassDispatch>,
    gbuffer: GpuGBuffer,
    /// From where the last frame that was set is seen.
    view: Option<FrameView>,
    view_before: wgpu::Buffer,
}

impl Frame {
    /// Sends a scene to the GPU and compiles the passes.
    ///
    /// # Errors
    /// If the device refuses or has no room; the buffer, texture or pass is named.
    pub fn new(gpu: &Gpu, animated: &AnimatedScene, settings: &RasterSettings) -> Result<Self, GpuError> {
        let RasterSettings { height, width, shadow_size, .. } = *settings;
        let device = &gpu.device;
        let is_light =
            |attribute: &Attribute| matches!(attribute, Attribute::Light | Attribute::DiffuseLight);
        let lit = settings.attributes.iter().any(is_light);
        let held: Vec<Attribute> = settings.attributes.iter().copied().filter(|a| !is_light(a)).collect();
        let light = if lit { &[Attribute::Light, Attribute::DiffuseLight][..] } else { &[] };
        let gbuffer = GpuGBuffer::empty(device, height, width, &[&held[..], light].concat())?;

        let world = World::new(gpu, animated, shadow_size)?;
        let surface = SurfacePass::new(device, &animated.scene.materials, &world.textures)?;
        let image = surface.image(device, height, width)?;
        let attributes = attributes::steps(device, &image, &world.materials, &gbuffer)?;
        let light = lit.then(|| light::step(device, &image, &world, &gbuffer)).transpose()?;
        let nowhere: FrameView = bytemuck::Zeroable::zeroed();
        let view_before = gpu::uniform(device, "frame.view_before", &nowhere)?;
        Ok(Self { world, surface, image, attributes, light, gbuffer, view: None, view_before })
    }

    /// Says what the next frame shows: the scene at `time` seconds, with the shutter open for `shutter`
    /// seconds around it, seen by a camera.
    pub fn set(&mut self, queue: &wgpu::Queue, time: f32, shutter: f32, camera: &Camera) {
        let (height, width) = (self.gbuffer.height(), self.gbuffer.width());
        let view = perspective(camera, height, width, NEAR * self.world.bounds.diagonal());
        self.image.set(queue, &view);
        queue.write_buffer(&self.view_before, 0, bytemuck::bytes_of(&self.view.unwrap_or(view)));
        self.view = Some(view);
        self.world.set(queue, time, shutter, camera, width as f32 / height as f32);
    }

    /// As [`World::set_lights`], from the next frame on.
    ///
    /// # Panics
    /// As it does.
    pub fn set_lights(&mut self, queue: &wgpu::Queue, lights: &[Light]) {
        self.world.set_lights(queue, lights);
    }

    /// As [`World::set_glow`], from the next frame on.
    pub fn set_glow(&mut self, queue: &wgpu::Queue, glow: &Arc<Glow>) -> bool {
        self.world.set_glow(queue, glow)
    }

    /// Records a stage. Shadow maps that show what they already do are kept.
    pub fn encode(&self, stage: FrameStage, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        match stage {
            FrameStage::Pose => compute(encoder, stage, stamps, |pass| self.world.encode_pose(pass)),
            FrameStage::Shadows if self.world.maps_to_draw() == 0 => compute(encoder, stage, stamps, |_| {}),
            FrameStage::Shadows => self.world.encode_shadows(encoder, stamps),
            FrameStage::Surface => {
                let geometry = &self.world.geometry;
                self.surface.encode(encoder, geometry, &self.image, stamps.map(Stamps::of_raster));
            }
            FrameStage::Attributes => {
                compute(encoder, stage, stamps, |pass| dispatch(&self.attributes, pass))
            }
            FrameStage::Light => {
                compute(encoder, stage, stamps, |pass| dispatch(self.light.as_slice(), pass))
            }
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

    /// The scene that it shows.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// A reflective shadow map of one of the scene's lights, `size` texels wide.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn reflective_map(&self, gpu: &Gpu, light: usize, size: usize) -> Result<ReflectiveMap, GpuError> {
        ReflectiveMap::new(&gpu.device, &self.surface, &self.world, light, size)
    }

    /// Draws a reflective shadow map of this frame.
    pub fn encode_reflective(&self, map: &ReflectiveMap, encoder: &mut wgpu::CommandEncoder) {
        map.encode(encoder, &self.surface, &self.world.geometry);
    }
}

/// Records a compute pass of its own.
fn compute(
    encoder: &mut wgpu::CommandEncoder,
    stage: FrameStage,
    stamps: Option<&Stamps<'_>>,
    record: impl FnOnce(&mut wgpu::ComputePass<'_>),
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(stage.name()),
        timestamp_writes: stamps.map(Stamps::of_compute),
    });
    record(&mut pass);
}

fn dispatch(steps: &[PassDispatch], pass: &mut wgpu::ComputePass<'_>) {
    for step in steps {
        step.encode_in(pass);
    }
}
