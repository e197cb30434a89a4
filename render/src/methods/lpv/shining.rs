//! Light that a scene sends by itself: what surfaces emit, what they and a medium give back of what they
//! kept, and what comes from the sky.

use super::passes::{Filled, Shines};
use super::volume_buffers::VolumeBuffers;
use crate::lpv::sky::Sky;
use crate::methods::phosphor::cells::Cells;
use crate::raster::World;
use crate::screen::{Device, MethodStep, PassDispatch, Workgroups};
use crate::surfels::cloud::SURFEL_GROUPS;
use crate::surfels::{Cloud, SurfelLight, light};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// What of it there is.
pub struct Shining {
    /// Radiance that patches emit, if any do.
    emissions: Option<wgpu::Buffer>,
    /// What surfels give back, as they send light of lamps, if any do and it is light like others.
    kept: Option<wgpu::Buffer>,
    /// What a medium keeps, if it does.
    cells: Option<Cells>,
    /// What the sky sends in, `[27, 4]` f32, if there is one: [`Sky::record`].
    pub sky: Option<wgpu::Buffer>,
}

impl Shining {
    /// That of a frame whose surfels write as many bytes of what they `send`; a medium has cells of about
    /// such an edge.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        device: &Device,
        world: &World,
        (filled, edge): (Filled, f32),
        sends: u64,
    ) -> Result<Self, GpuError> {
        let Shines { emits, gives_back, medium_gives_back, sky } = filled.shines(world.scene());
        let emissions = || gpu::storage(device, "lpv.emissions", &world.emissions());
        let kept = || gpu::empty::<u8>(device, "lpv.kept", sends as usize);
        let cells = || Cells::new(device, world, edge);
        let environment = world.scene().environment.as_deref().filter(|_| sky);
        let sky = |environment| gpu::storage(device, "lpv.sky", &Sky::new(environment).record());
        Ok(Self {
            emissions: emits.then(emissions).transpose()?,
            kept: gives_back.then(kept).transpose()?,
            cells: medium_gives_back.then(cells).transpose()?.flatten(),
            sky: environment.map(sky).transpose()?,
        })
    }

    /// Whether there is any.
    pub const fn is_any(&self) -> bool {
        self.emissions.is_some() || self.kept.is_some() || self.cells.is_some() || self.sky.is_some()
    }

    /// The passes that move what is kept on by the time since the frame before.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn keeping_steps(
        &self,
        device: &Device,
        world: &World,
        (cloud, view): (&Cloud, &wgpu::Buffer),
    ) -> Result<Vec<MethodStep>, GpuError> {
        let mut steps = Vec::new();
        if let Some(kept) = &self.kept {
            steps.extend(light::steps(device, world, SurfelLight::Kept, cloud, [view, kept])?);
        }
        if let Some(cells) = &self.cells {
            for pose in world.poses() {
                steps.extend(cells.steps(device, pose, 0)?);
            }
        }
        Ok(steps)
    }

    /// The passes that add what surfaces and the medium send to a volume's sums.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn sending_steps(
        &self,
        device: &Device,
        world: &World,
        (cloud, view): (&Cloud, &wgpu::Buffer),
        room: &VolumeBuffers,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let gives_back = [light::kept_unit(world)];
        let starts = Some((7, &cloud.starts));
        let emissions = self.emissions.as_ref();
        let emissions = emissions.map(|it| (Shader::at("methods/lpv/shine"), &[][..], it, starts));
        let kept = self.kept.as_ref();
        let kept = kept.map(|it| (Shader::at("methods/lpv/shine_kept"), &gives_back[..], it, None));
        let mut steps = Vec::new();
        for (shader, constants, radiances, starts) in [emissions, kept].into_iter().flatten() {
            let pass = device.pass(shader, constants)?;
            let read = [&room.record, view, &cloud.totals, &cloud.surfels, radiances];
            let read: Vec<_> = (0..).zip(read).chain(starts).collect();
            let groups = Workgroups::Counted(cloud.totals.clone(), SURFEL_GROUPS);
            steps.push(MethodStep::bind_at(device, &pass, groups, &read, &[(5, &room.sums)])?);
        }
        if let Some(cells) = &self.cells {
            steps.push(medium_step(device, world, cells, room)?);
        }
        Ok(steps)
    }
}

/// The pass that adds what a medium gives back.
fn medium_step(
    device: &Device,
    world: &World,
    cells: &Cells,
    room: &VolumeBuffers,
) -> Result<MethodStep, GpuError> {
    let pass = device.pass(Shader::at("methods/lpv/shine_medium"), &Cells::constants(world))?;
    let (paints, medium) = (&world.glow.paints, &world.medium.record);
    let buffers = [&room.record, paints, &cells.record, medium, &cells.states, &room.sums];
    let mut resources: Vec<_> = buffers.map(|buffer| buffer.as_entire_binding()).into();
    resources.push(wgpu::BindingResource::TextureView(&world.medium.densities));
    let step = PassDispatch { pass: pass.bind(device, &resources)?, workgroups: room.groups.clone() };
    Ok(MethodStep { step, writes: vec![room.sums.clone()] })
}
