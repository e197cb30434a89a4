//! Reflective shadow maps: where a light's rays meet the scene, and the power that is reflected there
//! (Dachsbacher and Stamminger 2005).

use super::attributes::seen_bindings;
use super::geometry::Geometry;
use super::surface::{SurfaceImage, SurfacePass};
use super::world::World;
use crate::screen::PassDispatch;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::uniforms::{Chosen, FrameView};
use deepshade_shaders::wgsl::{Shader, TILE};

/// Planes of a reflective shadow map: position, normal and flux.
pub const PLANES: usize = 9;

/// One view of a light, and what it sees.
#[derive(Debug)]
pub struct ReflectiveMap {
    image: SurfaceImage,
    step: PassDispatch,
    /// `[9, size, size]` f32: position in world space, metres; normal; flux that is reflected diffusely,
    /// watts. All 0 where nothing is met.
    pub texels: wgpu::Buffer,
}

impl ReflectiveMap {
    /// Room for a map of `size` x `size` texels of one of the scene's lights.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn new(
        device: &wgpu::Device,
        surface: &SurfacePass,
        world: &World,
        light: usize,
        size: usize,
    ) -> Result<Self, GpuError> {
        let image = surface.image(device, size, size)?;
        let texels = gpu::empty::<f32>(device, "frame.reflective", PLANES * size * size)?;
        let chosen = gpu::uniform(device, "frame.reflective_light", &Chosen { light: light as u32 })?;
        let pass = Pass::of(device, Shader::at("frame/reflective"), &[])?;
        let lights = &world.gpu_lights;
        let mut resources = seen_bindings(&image, &world.materials);
        resources
            .extend([&lights.records, &lights.pictures, &chosen, &texels].map(|b| b.as_entire_binding()));
        let step = PassDispatch {
            pass: pass.bind(device, &resources)?,
            workgroups: gpu::groups(size, size, TILE).into(),
        };
        Ok(Self { image, step, texels })
    }

    /// Says from where the light looks: one of [`World::light_views`], with as many texels as this
    /// map has.
    pub fn set(&self, queue: &wgpu::Queue, view: &FrameView) {
        self.image.set(queue, view);
    }

    /// Records the passes.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, surface: &SurfacePass, geometry: &Geometry) {
        surface.encode(encoder, geometry, &self.image, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("deepshade.frame.reflective"),
            timestamp_writes: None,
        });
        self.step.encode_in(&mut pass);
    }
}
