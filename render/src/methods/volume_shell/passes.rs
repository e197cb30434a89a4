//! What runs on the GPU: surfels, their light through the medium and their tree; the interval map; the levels one after the
//! other, and their sum.

use super::Parameters;
use super::pyramid::{Pyramid, Room};
use crate::methods::surfel::passes::groups_of_level;
use crate::raster::World;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{GpuGBuffer, Inputs, MethodStep, Step, View};
use crate::surfels::{self, Cloud, Lit, Tree, frame};
use bytemuck::bytes_of;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader, TILE, uniforms};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: surfels::Passes,
    intervals: Pass,
    splat: Pass,
    pyramid: Pyramid,
    add: Pass,
}

/// The contents of the passes' uniform buffers: surfels and their tree, march, splats, then of each level splat and sum.
pub fn uniforms(parameters: &Parameters, view: &View) -> Vec<Vec<u8>> {
    let mut settings = parameters.surfels;
    // Near is over the effect's radius, which is not how far surfels matter.
    settings.near *= view.radius / super::far_reaching(view).radius;
    let mut all: Vec<Vec<u8>> = frame::uniforms(&settings, &super::far_reaching(view)).collect();
    all.push(bytes_of(&parameters.marching(view)).to_vec());
    all.push(bytes_of(&parameters.splatting(view)).to_vec());
    for level in 0..parameters.levels {
        all.push(bytes_of(&parameters.level(level, view)).to_vec());
        let (width, height) = (view.width as u32, view.height as u32);
        let first = u32::from(level == 0);
        let last = u32::from(level + 1 == parameters.levels);
        all.push(bytes_of(&uniforms::LevelSum { width, height, first, last, background: 0.0 }).to_vec());
    }
    all
}

/// The interval map of a frame.
struct IntervalMap {
    /// `[height, width, 4]` f32: where rays enter and leave, density times length, random offset.
    rays: wgpu::Buffer,
    /// `[height, width, SAMPLES]` u16: shares of the way.
    distances: wgpu::Buffer,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self {
            surfels: surfels::Passes::new(device, Tree::Lit)?,
            intervals: pass(&wgsl::VOLUME_SHELL_INTERVALS)?,
            splat: pass(&wgsl::VOLUME_SHELL_SPLAT)?,
            pyramid: Pyramid::new(device)?,
            add: pass(&wgsl::VOLUME_SHELL_ADD)?,
        })
    }

    /// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let world = frame::scene(inputs.world)?;
        let (of_surfels, [march, volume, levels @ ..]) = uniforms.split_at(frame::UNIFORMS) else {
            unreachable!("march and splats have a uniform buffer each")
        };
        let lit = Some(Lit::Dimmed);
        let (cloud, mut steps) = frame::steps(&self.surfels, device, inputs.world, of_surfels, lit)?;
        let (map, step) = self.map(device, inputs.gbuffer, world, [march, &of_surfels[1]])?;
        steps.push(step);
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let sums = gpu::empty::<[f32; 4]>(device, "volume-shell.sums", height * width)?;
        let room = Room::new(device, [width, height], levels.len() / 2 - 1)?;
        for (level, uniforms) in levels.chunks_exact(2).enumerate() {
            let [splat, sum] = uniforms else { unreachable!("a level has two uniform buffers") };
            let workgroups = groups_of_level([width, height], level);
            let read = [splat, volume, &of_surfels[1]];
            steps.push(self.splat(device, world, read, &cloud, &map, &sums, workgroups)?);
            let smooth = if level == 0 { &sums } else { &room.smooth };
            if level > 0 {
                steps.extend(self.pyramid.steps(device, &sums, &room, level)?);
            }
            let whole = gpu::groups(height, width, TILE);
            steps.push(MethodStep::bind(device, &self.add, whole, &[sum, &sums, smooth], &[image])?);
        }
        Ok(steps)
    }

    /// The interval map and the pass that makes it.
    fn map(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        world: &World,
        [march, view]: [&wgpu::Buffer; 2],
    ) -> Result<(IntervalMap, MethodStep), GpuError> {
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let rays = gpu::empty::<[f32; 4]>(device, "volume-shell.rays", height * width)?;
        let distances = gpu::empty::<[u32; 8]>(device, "volume-shell.distances", height * width)?;
        let MediumOnGpu { record, densities } = &world.medium;
        let [valid, position] = [Attribute::Valid, Attribute::Position].map(|a| gbuffer.buffer(a));
        let pass = self.intervals.bind(
            device,
            &[
                march.as_entire_binding(),
                view.as_entire_binding(),
                record.as_entire_binding(),
                wgpu::BindingResource::TextureView(densities),
                valid.as_entire_binding(),
                position.as_entire_binding(),
                rays.as_entire_binding(),
                distances.as_entire_binding(),
            ],
        )?;
        let workgroups = gpu::groups(height, width, TILE).into();
        let writes = vec![rays.clone(), distances.clone()];
        Ok((IntervalMap { rays, distances }, MethodStep { step: Step { pass, workgroups }, writes }))
    }

    #[allow(clippy::too_many_arguments, reason = "what a pass binds")]
    fn splat(
        &self,
        device: &wgpu::Device,
        world: &World,
        [level, volume, view]: [&wgpu::Buffer; 3],
        cloud: &Cloud,
        map: &IntervalMap,
        sums: &wgpu::Buffer,
        workgroups: [u32; 3],
    ) -> Result<MethodStep, GpuError> {
        let MediumOnGpu { record, densities } = &world.medium;
        let buffers = [level, volume, view, record, &cloud.totals, &cloud.surfels, &cloud.nodes, sums];
        let more = cloud.sent.iter().chain([&map.rays, &map.distances]);
        let buffers = buffers.into_iter().chain(more).map(|buffer| buffer.as_entire_binding());
        let resources: Vec<_> = buffers.chain([wgpu::BindingResource::TextureView(densities)]).collect();
        let pass = self.splat.bind(device, &resources)?;
        Ok(MethodStep { step: Step { pass, workgroups: workgroups.into() }, writes: vec![sums.clone()] })
    }
}
