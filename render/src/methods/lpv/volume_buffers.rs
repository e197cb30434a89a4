//! The buffers of a volume between the passes that fill it, and the passes over its cells.

use super::shown::VolumeOnGpu;
use crate::lpv::flight::Factors;
use crate::lpv::lobe::Lobes;
use crate::lpv::moments::SECONDS;
use crate::lpv::propagation::Kinds;
use crate::lpv::{LightGrid, Scheme, flight};
use crate::methods::single_scattering;
use crate::raster::light::shadow_sampler;
use crate::raster::medium::MediumOnGpu;
use crate::raster::{World, groups};
use crate::screen::{Device, MethodStep, PassDispatch, Workgroups};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};

/// Words of a cell's light and of a cube of blockers.
const LIGHT_WORDS: usize = 24;
const CUBE_WORDS: usize = 18;

/// What lies between the passes.
#[derive(Clone)]
pub struct VolumeBuffers {
    /// The grid.
    pub record: wgpu::Buffer,
    /// `[cells, 3, 4, 2]` u32: light of surfels, in fixed point.
    pub sums: wgpu::Buffer,
    /// `[cubes, 9, 2]` u32: blockers, in fixed point.
    pub cubes: wgpu::Buffer,
    /// `[cells, 4]` u32.
    pub links: wgpu::Buffer,
    /// `[cells, 3, 4]` f32.
    pub media: wgpu::Buffer,
    /// `[kinds, 3, cells, 4]` f32, before and after an iteration; if there is scattered light also
    /// `[cells, 4]`, what is sent out again; of three bands also `[kinds, 5, cells, 4]`, second moments.
    states: [wgpu::Buffer; 2],
    /// `[3, cells, 4]` f32: what each iteration adds to steady light.
    source: wgpu::Buffer,
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
    nesting: Nesting,
    cells: usize,
}

/// Which volumes there are beside one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nesting {
    /// Whether it is in a coarser one.
    pub is_nested: bool,
    /// Whether a finer one is in it.
    pub has_finer: bool,
}

impl VolumeBuffers {
    /// Makes it.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        device: &Device,
        (grid, record): (&LightGrid, wgpu::Buffer),
        (kinds, nesting): (Kinds, Nesting),
        scheme: Scheme,
    ) -> Result<Self, GpuError> {
        let cells = grid.cells();
        let cubes = (grid.size + 1).as_usizevec3().element_product();
        let scattered = usize::from(kinds.scattered);
        let planes = 1 + scattered + usize::from(keeps_first(kinds, nesting));
        let kept = kept_planes(scheme.lobes) * kinds.count() + scattered;
        let state = || gpu::empty::<[f32; 4]>(device, "lpv.state", kept * cells);
        Ok(Self {
            record,
            sums: gpu::empty::<u32>(device, "lpv.sums", LIGHT_WORDS * cells)?,
            cubes: gpu::empty::<u32>(device, "lpv.cubes", CUBE_WORDS * cubes)?,
            links: gpu::empty::<[u32; 4]>(device, "lpv.links", cells)?,
            media: gpu::empty::<[[f32; 4]; 3]>(device, "lpv.media", cells)?,
            states: [state()?, state()?],
            source: source(device, kinds, cells)?,
            shown: gpu::empty::<[f32; 4]>(device, "lpv.shown", 3 * planes * cells)?,
            groups: groups(cells).into(),
            kinds,
            scheme,
            is_similar: kinds.scattered,
            nesting,
            cells,
        })
    }

    /// That of light which a scene sends by itself: blockers and medium are the same, and so is the room for
    /// light on its way, which is there before what surfaces reflect.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn of_emission(&self, device: &Device) -> Result<Self, GpuError> {
        Ok(Self {
            sums: gpu::empty::<u32>(device, "lpv.emitted_sums", LIGHT_WORDS * self.cells)?,
            cubes: gpu::empty::<u32>(device, "lpv.no_cubes", CUBE_WORDS)?,
            shown: gpu::empty::<[f32; 4]>(device, "lpv.emitted", 3 * self.cells)?,
            source: source(device, EMITTED, self.cells)?,
            kinds: EMITTED,
            ..self.clone()
        })
    }

    /// What is shown of it; which volume is in it is not known yet.
    pub fn volume(self) -> VolumeOnGpu {
        let Self { record, shown, scheme, kinds, nesting: Nesting { is_nested, .. }, .. } = self;
        VolumeOnGpu { record, shown, scheme, kinds, is_nested, finer: None }
    }

    /// Workgroups of a pass over all words of sums.
    pub fn words(&self) -> Workgroups {
        let bytes = self.sums.size().max(self.cubes.size()) as usize;
        groups(bytes / size_of::<u32>()).into()
    }

    /// Which kinds of light there are, as the passes have it.
    fn constants(&self) -> [(&'static str, u32); 2] {
        [("UNSCATTERED", self.kinds.unscattered as u32), scattered(self.kinds)]
    }

    /// Whether light is steady, as the passes have it.
    fn steady(&self) -> (&'static str, u32) {
        ("STEADY", u32::from(self.kinds.is_steady))
    }

    /// Whether the medium is thinned, as the passes have it.
    fn similar(&self) -> (&'static str, u32) {
        ("SIMILAR", u32::from(self.is_similar))
    }

    /// Whether the first kind is shown apart, as the passes have it.
    fn first(&self) -> (&'static str, u32) {
        ("FIRST", u32::from(keeps_first(self.kinds, self.nesting)))
    }

    /// Light that surfaces send, before the first iteration.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn fresh_step(&self, device: &Device, world: &World) -> Result<MethodStep, GpuError> {
        let own = [self.first(), self.similar(), self.steady()];
        let constants = [&self.constants()[..], &self.scheme.constants(), &own].concat();
        let pass = device.pass(Shader::at("methods/lpv/fresh"), &constants)?;
        let reads = [(0, &self.record), (1, &self.sums), (5, &world.medium.record), (6, &self.media)];
        let writes = [(3, &self.shown), (4, &self.source), (2, &self.states[0])];
        MethodStep::bind_at(device, &pass, self.groups.clone(), &reads, &writes)
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
    pub fn border_step(
        &self,
        device: &Device,
        world: &World,
        outside: &VolumeOnGpu,
    ) -> Result<MethodStep, GpuError> {
        let own = [self.similar(), self.steady()];
        let constants = [&self.constants()[..], &self.scheme.constants(), &own].concat();
        let pass = device.pass(Shader::at("methods/lpv/border"), &constants)?;
        let reads = [&self.record, &outside.record, &world.medium.record, &self.media, &outside.shown];
        MethodStep::bind(device, &pass, self.groups.clone(), &reads, &[&self.states[0], &self.source])
    }

    /// So many iterations; they end where light has gone as far as `reach` says.
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
        let nested = ("NESTED", u32::from(self.nesting.is_nested));
        let borders = ("BORDERS", u32::from(borders));
        let own = [borders, self.first(), nested, self.similar(), self.steady()];
        let constants = [&self.constants()[..], &self.scheme.constants(), &own].concat();
        let compiled = |shows: bool| {
            let constants = [&constants[..], &[("SHOWS", u32::from(shows))]].concat();
            device.pass(Shader::at("methods/lpv/propagate"), &constants)
        };
        let showing = compiled(true)?;
        // Of steady light the last iteration alone is shown.
        let hidden = self.kinds.is_steady.then(|| compiled(false)).transpose()?;
        let step = |iteration: usize| {
            let pass = hidden.as_ref().filter(|_| iteration + 1 < iterations).unwrap_or(&showing);
            let number = uniforms::Iteration { number: iteration as u32 };
            let number = gpu::uniform(device, "lpv.iteration", &number)?;
            let [from, to] = [iteration % 2, 1 - iteration % 2].map(|i| &self.states[i]);
            let reads = [&self.record, &world.medium.record, &self.links, &self.media, from];
            let others = [(7, &number), (8, reach), (9, &self.source)];
            let reads: Vec<_> = (0..).zip(reads).chain(others).collect();
            let writes = [(5, to), (6, &self.shown)];
            MethodStep::bind_at(device, pass, self.groups.clone(), &reads, &writes)
        };
        (0..iterations).map(step).collect()
    }
}

/// Light that a scene sends by itself, until something turns it.
pub const EMITTED: Kinds = Kinds { unscattered: 1, scattered: false, is_steady: false };

/// Planes of what cells keep of a kind of light: one of each colour and, of three bands, those of second
/// moments.
const fn kept_planes(lobes: Lobes) -> usize {
    match lobes {
        Lobes::Squared | Lobes::TwoBands => 3,
        Lobes::ThreeBands => 3 + SECONDS,
    }
}

/// Room for what each iteration adds, which only steady light needs.
fn source(device: &Device, kinds: Kinds, cells: usize) -> Result<wgpu::Buffer, GpuError> {
    gpu::empty::<[f32; 4]>(device, "lpv.source", if kinds.is_steady { 3 * cells } else { 1 })
}

/// Whether there is scattered light, as the passes have it.
pub const fn scattered(kinds: Kinds) -> (&'static str, u32) {
    ("SCATTERED", kinds.scattered as u32)
}

/// Whether the first of several kinds, which is not shown otherwise, is kept for a finer volume.
const fn keeps_first(kinds: Kinds, nesting: Nesting) -> bool {
    kinds.scattered && nesting.has_finer
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
