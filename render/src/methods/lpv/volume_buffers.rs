//! The buffers of a volume between the passes that fill it, and the passes over its cells.

use super::series;
use super::shown::VolumeOnGpu;
use crate::lpv::flight::Factors;
use crate::lpv::propagation::Kinds;
use crate::lpv::{LightGrid, Scheme, flight};
use crate::methods::single_scattering;
use crate::raster::light::shadow_sampler;
use crate::raster::medium::MediumOnGpu;
use crate::raster::{World, groups};
use crate::screen::{Device, MethodStep, PassDispatch, Workgroups};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};

/// Words of a cell's light, and of a cube of what surfaces cover.
const LIGHT_WORDS: usize = 24;
const BLOCKER_WORDS: usize = 17;

/// What lies between the passes.
#[derive(Clone)]
pub struct VolumeBuffers {
    /// The grid.
    pub record: wgpu::Buffer,
    /// `[cells, 3, 4, 2]` u32: light of surfels, in fixed point.
    pub sums: wgpu::Buffer,
    /// `[cubes, 17]` u32: what surfaces cover, in fixed point.
    pub blockers: wgpu::Buffer,
    /// `[cells, 4]` u32.
    pub links: wgpu::Buffer,
    /// `[cells, 3, 4]` f32.
    pub media: wgpu::Buffer,
    /// `[kinds, 3, cells, 4]` f32, before and after an iteration; if there is scattered light also
    /// `[cells, 4]`, what is sent out again.
    states: [wgpu::Buffer; 2],
    /// `[sides, 3, cells, 4]` f32: what each iteration adds to steady light.
    source: wgpu::Buffer,
    /// `[kinds, 4]` f32: by how much to multiply what an iteration shows.
    pub weights: wgpu::Buffer,
    /// As [`VolumeOnGpu`] has it.
    pub shown: wgpu::Buffer,
    /// Workgroups of passes over cells.
    pub groups: Workgroups,
    /// Which light there is.
    pub kinds: Kinds,
    /// How it is handed on.
    pub scheme: Scheme,
    /// Whether the medium is thinned by similarity, for light that is scattered in it.
    is_similar: bool,
    /// Whether it is in a coarser one.
    is_nested: bool,
    cells: usize,
}

impl VolumeBuffers {
    /// Makes it.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        device: &Device,
        (grid, record): (&LightGrid, wgpu::Buffer),
        (kinds, is_nested): (Kinds, bool),
        scheme: Scheme,
    ) -> Result<Self, GpuError> {
        let cells = grid.cells();
        let cubes = (grid.size + 1).as_usizevec3().element_product();
        let scattered = usize::from(kinds.scattered);
        let kept = 3 * kinds.count() + scattered;
        let state = || gpu::empty::<[f32; 4]>(device, "lpv.state", kept * cells);
        Ok(Self {
            record,
            sums: gpu::empty::<u32>(device, "lpv.sums", LIGHT_WORDS * cells)?,
            blockers: gpu::empty::<u32>(device, "lpv.blockers", BLOCKER_WORDS * cubes)?,
            links: gpu::empty::<[u32; 4]>(device, "lpv.links", cells)?,
            media: gpu::empty::<[[f32; 4]; 3]>(device, "lpv.media", cells)?,
            states: [state()?, state()?],
            source: source(device, kinds, cells)?,
            weights: gpu::empty::<[f32; 4]>(device, "lpv.weights", kinds.count())?,
            shown: gpu::empty::<[f32; 4]>(device, "lpv.shown", 3 * (1 + scattered) * cells)?,
            groups: groups(cells).into(),
            kinds,
            scheme,
            is_similar: kinds.scattered,
            is_nested,
            cells,
        })
    }

    /// That of light which a scene sends by itself, and a sky if there is one: blockers and medium are the
    /// same, and so is the room for light on its way, which is there before what surfaces reflect.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn of_emission(&self, device: &Device, has_sky: bool) -> Result<Self, GpuError> {
        let kinds = Kinds { is_steady: has_sky, ..Kinds::ONE };
        Ok(Self {
            sums: gpu::empty::<u32>(device, "lpv.emitted_sums", LIGHT_WORDS * self.cells)?,
            blockers: gpu::empty::<u32>(device, "lpv.no_blockers", BLOCKER_WORDS)?,
            shown: gpu::empty::<[f32; 4]>(device, "lpv.emitted", 3 * self.cells)?,
            source: source(device, kinds, self.cells)?,
            kinds,
            ..self.clone()
        })
    }

    /// What is shown of it.
    pub fn volume(self) -> VolumeOnGpu {
        let Self { record, shown, scheme, kinds, is_nested, .. } = self;
        VolumeOnGpu { record, shown, scheme, kinds, is_nested }
    }

    /// Workgroups of a pass over all words of sums.
    pub fn words(&self) -> Workgroups {
        let bytes = self.sums.size().max(self.blockers.size()) as usize;
        groups(bytes / size_of::<u32>()).into()
    }

    /// Which kinds of light there are, as the passes have it.
    pub fn constants(&self) -> [(&'static str, u32); 2] {
        [("UNSCATTERED", self.kinds.unscattered as u32), scattered(self.kinds)]
    }

    /// Whether light is steady, as the passes have it.
    fn steady(&self) -> (&'static str, u32) {
        ("STEADY", u32::from(self.kinds.is_steady))
    }

    /// Whether it is in a coarser one, as the passes have it.
    fn nested(&self) -> (&'static str, u32) {
        ("NESTED", u32::from(self.is_nested))
    }

    /// Whether the medium is thinned, as the passes have it.
    fn similar(&self) -> (&'static str, u32) {
        ("SIMILAR", u32::from(self.is_similar))
    }

    /// Light that surfaces send, before the first iteration.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn fresh_step(&self, device: &Device, world: &World) -> Result<MethodStep, GpuError> {
        if self.kinds.is_steady {
            return self.sides_step(device, world);
        }
        let constants = [&self.constants()[..], &[self.scheme.lobes_constant()]].concat();
        let pass = device.pass(Shader::at("methods/lpv/fresh"), &constants)?;
        let reads = [(0, &self.record), (1, &self.sums)];
        let writes = [(3, &self.shown), (5, &self.weights), (2, &self.states[0])];
        MethodStep::bind_at(device, &pass, self.groups.clone(), &reads, &writes)
    }

    /// The same of light that is kept apart by sides.
    fn sides_step(&self, device: &Device, world: &World) -> Result<MethodStep, GpuError> {
        let constants = [&self.constants()[..], &self.scheme.constants(), &[self.similar()]].concat();
        let pass = device.pass(Shader::at("methods/lpv/sides"), &constants)?;
        let reads = [(0, &self.record), (1, &self.sums), (6, &world.medium.record)];
        let reads: Vec<_> = reads.into_iter().chain([(7, &self.media), (8, &self.links)]).collect();
        let writes = [(3, &self.shown), (4, &self.source), (5, &self.weights), (2, &self.states[0])];
        MethodStep::bind_at(device, &pass, self.groups.clone(), &reads, &writes)
    }

    /// The same of light that a scene and a sky of such a [record](crate::lpv::sky::Sky::record) send on and
    /// on.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn enter_step(
        &self,
        device: &Device,
        world: &World,
        sky: &wgpu::Buffer,
    ) -> Result<MethodStep, GpuError> {
        let MediumOnGpu { record: medium, densities, kind } = &world.medium;
        let own = [("MEDIUM", *kind), self.similar()];
        let constants = [&self.constants()[..], &self.scheme.constants(), &own].concat();
        let pass = device.pass(Shader::at("methods/lpv/enter"), &constants)?;
        let buffers = [&self.record, &self.sums, &self.states[0], &self.shown, &self.source];
        let buffers = buffers.into_iter().chain([&self.weights, medium, &self.media, sky]);
        let buffers = (0..).zip(buffers.map(|buffer| buffer.as_entire_binding()));
        let densities = (9, wgpu::BindingResource::TextureView(densities));
        let step = PassDispatch {
            pass: pass.bind_at(device, buffers.chain([densities]))?,
            workgroups: self.groups.clone(),
        };
        let writes = [&self.shown, &self.source, &self.weights, &self.states[0]];
        Ok(MethodStep { step, writes: writes.map(Clone::clone).into() })
    }

    /// What the medium does in cells.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn media_step(&self, device: &Device, world: &World) -> Result<MethodStep, GpuError> {
        let MediumOnGpu { record: medium, densities, .. } = &world.medium;
        let [_, kind] = single_scattering::constants(world);
        let pass = device.pass(
            Shader::at("methods/lpv/media"),
            &[&[kind, self.similar()][..], &self.scheme.constants()].concat(),
        )?;
        let table = gpu::storage(device, "lpv.table", flight::table())?;
        let buffers = [&self.record, &table, &self.media, medium].map(|buffer| buffer.as_entire_binding());
        let resources: Vec<_> =
            buffers.into_iter().chain([wgpu::BindingResource::TextureView(densities)]).collect();
        let step = PassDispatch { pass: pass.bind(device, &resources)?, workgroups: self.groups.clone() };
        Ok(MethodStep { step, writes: vec![self.media.clone()] })
    }

    /// What the medium scatters of the lamps' light, and of what the scene sends by itself.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn begin_step(
        &self,
        device: &Device,
        world: &World,
        emission: Option<&wgpu::Buffer>,
    ) -> Result<MethodStep, GpuError> {
        let constants =
            [&single_scattering::constants(world)[..], &self.constants(), &self.scheme.constants()].concat();
        let shader = if emission.is_some() {
            Shader::at("methods/lpv/begin_emitted")
        } else {
            Shader::at("methods/lpv/begin")
        };
        let pass = device.pass(shader, &constants)?;
        let sampler = shadow_sampler(device);
        let own = [(0, &self.record), (1, &self.links), (7, &self.states[0]), (8, &self.media)];
        let own = own.into_iter().chain(emission.map(|emitted| (9, emitted)));
        let own = own.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let lamps = single_scattering::bindings(world, &world.gpu_lights.shining, &sampler);
        let bound = pass.bind_at(device, own.chain(lamps))?;
        let step = PassDispatch { pass: bound, workgroups: self.groups.clone() };
        Ok(MethodStep { step, writes: vec![self.states[0].clone()] })
    }

    /// What the volume around it hands to it.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn border_step(&self, device: &Device, outside: &VolumeOnGpu) -> Result<MethodStep, GpuError> {
        let pass = device.pass(Shader::at("methods/lpv/border"), &self.scheme.constants())?;
        let reads = [&self.record, &outside.record, &outside.shown];
        MethodStep::bind(device, &pass, self.groups.clone(), &reads, &[&self.states[0]])
    }

    /// So many iterations; they end where light has gone as far as `reach` says. Of light that goes on and on
    /// the last stands for all that would follow.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn propagation_steps(
        &self,
        device: &Device,
        world: &World,
        iterations: usize,
        reach: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        // In a medium that is everywhere the same no cell is denser than another.
        let borders = self.kinds.scattered
            && self.scheme.factors == Factors::Placed
            && world.medium.kind != MediumOnGpu::EVERYWHERE;
        let borders = ("BORDERS", u32::from(borders));
        let reflects = ("REFLECTS", u32::from(self.kinds.goes_on()));
        let own = [borders, reflects, self.nested(), self.similar(), self.steady()];
        let constants = [&self.constants()[..], &self.scheme.constants(), &own].concat();
        let compiled = |shows: bool| {
            let constants = [&constants[..], &[("SHOWS", u32::from(shows))]].concat();
            device.pass(Shader::at("methods/lpv/propagate"), &constants)
        };
        let showing = compiled(true)?;
        // Of steady light the last iteration alone is shown.
        let hidden = self.kinds.is_steady.then(|| compiled(false)).transpose()?;
        let one = |iteration: usize| {
            let pass = hidden.as_ref().filter(|_| iteration + 1 < iterations).unwrap_or(&showing);
            let number = uniforms::Iteration { number: iteration as u32 };
            let number = gpu::uniform(device, "lpv.iteration", &number)?;
            let [from, to] = [self.state_after(iteration + 1), self.state_after(iteration)];
            let reads = [&self.record, &world.medium.record, &self.links, &self.media, from];
            let others = [(7, &number), (8, reach), (9, &self.source), (10, &self.weights)];
            let reads: Vec<_> = (0..).zip(reads).chain(others).collect();
            let writes = [(5, to), (6, &self.shown)];
            MethodStep::bind_at(device, pass, self.groups.clone(), &reads, &writes)
        };
        series::with_end(self, device, (0..iterations).map(one).collect::<Result<_, _>>()?)
    }

    /// What is kept of light after the iteration of a number.
    pub fn state_after(&self, iteration: usize) -> &wgpu::Buffer {
        &self.states[1 - iteration % 2]
    }
}

/// Room for what each iteration adds, which only steady light needs.
fn source(device: &Device, kinds: Kinds, cells: usize) -> Result<wgpu::Buffer, GpuError> {
    gpu::empty::<[f32; 4]>(device, "lpv.source", if kinds.is_steady { 3 * kinds.count() * cells } else { 1 })
}

/// Whether there is scattered light, as the passes have it.
pub const fn scattered(kinds: Kinds) -> (&'static str, u32) {
    ("SCATTERED", kinds.scattered as u32)
}

/// The grid of a finer volume, and the pass that lays it around the camera.
///
/// # Errors
/// If the device refuses it.
pub fn nest_step(
    device: &Device,
    coarser: &wgpu::Buffer,
    view: &wgpu::Buffer,
) -> Result<(wgpu::Buffer, MethodStep), GpuError> {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let nested = gpu::filled(device, "lpv.nested", &[0; size_of::<uniforms::LightGrid>()], usage)?;
    let pass = device.pass(Shader::at("methods/lpv/nest"), &[])?;
    let step = MethodStep::bind(device, &pass, [1, 1, 1], &[coarser, view], &[&nested])?;
    Ok((nested, step))
}
