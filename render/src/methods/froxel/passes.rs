//! What runs on the GPU: froxels, their sums, the image.

use super::Parameters;
use crate::methods::single_scattering;
use crate::raster::light::shadow_sampler;
use crate::screen::{Inputs, MethodStep, Step};
use crate::surfels::frame;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader, TILE};

/// The pass that is the same for every scene; the others are compiled for its lights and medium.
#[derive(Clone, Debug)]
pub struct Passes {
    integrate: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let shader = &wgsl::FROXEL_INTEGRATE;
        Ok(Self { integrate: Pass::new(device, shader.name, &shader.source())? })
    }

    /// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room for the froxels.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        parameters: Parameters,
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (gbuffer, world) = (inputs.gbuffer, frame::scene(inputs.world)?);
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let [settings, view] = uniforms else { unreachable!("it has two uniform buffers") };
        let [rows, columns] = parameters.grid([height, width]);
        let slices = parameters.slices_of([height, width]);
        let count = rows * columns * slices as usize;
        let scattered = gpu::empty::<[f32; 4]>(device, "froxel.scattered", count)?;
        let sums = gpu::empty::<[f32; 4]>(device, "froxel.sums", count)?;
        let [valid, position] = [Attribute::Valid, Attribute::Position].map(|a| gbuffer.buffer(a));
        let record = &world.medium.record;

        let [lights, medium] = single_scattering::constants(world);
        let pass = |shader: &Shader, constants: &[(&str, u32)]| {
            Pass::new(device, shader.name, &shader.specialised(constants))
        };
        let sampler = shadow_sampler(device);
        let own = [(0, settings), (1, view), (7, &scattered)]
            .map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let resources =
            own.into_iter().chain(single_scattering::bindings(world, &world.gpu_lights.records, &sampler));
        let scatter = pass(&wgsl::FROXEL_SCATTER, &[lights, medium])?.bind_at(device, resources)?;
        let [x, y, _] = gpu::groups(rows, columns, TILE);
        let scatter = Step { pass: scatter, workgroups: [x, y, slices].into() };
        let apply = pass(&wgsl::FROXEL_APPLY, &[medium])?;
        let whole = gpu::groups(height, width, TILE);
        let read = [settings, view, record, valid, position, &sums];
        Ok(vec![
            MethodStep { step: scatter, writes: vec![scattered.clone()] },
            MethodStep::bind(device, &self.integrate, [x, y, 1], &[settings, record, &scattered], &[&sums])?,
            MethodStep::bind(device, &apply, whole, &read, &[image])?,
        ])
    }
}
