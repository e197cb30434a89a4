//! What runs on the GPU: surfels, their light and what they block; the medium; light on its way; and what is lit by it.

use super::Parameters;
use crate::lpv::propagation::Kinds;
use crate::lpv::{LightGrid, Scheme, flight};
use crate::methods::single_scattering;
use crate::raster::World;
use crate::raster::light::shadow_sampler;
use crate::raster::medium::MediumOnGpu;
use crate::raster::view::perspective;
use crate::scene::Bounds;
use crate::screen::{GpuGBuffer, Inputs, MethodStep, Step, View, Workgroups};
use crate::surfels::cloud::{self, SURFEL_GROUPS};
use crate::surfels::light::LightPass;
use crate::surfels::{self, Cloud, Lit, Tree, frame};
use bytemuck::bytes_of;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader, TILE, uniforms};

/// Which uniform buffer has the camera.
pub const VIEW: usize = 0;
/// Which says how far light is propagated.
const REACH: usize = 1;

/// Radius of a surfel, cells.
const SURFEL: f32 = 0.1;
/// How far away, over the scene's diagonal, surfels are laid out as if they were, so that all are of a size wherever
/// the camera is.
const FAR: f32 = 1e3;
/// Words of a cell's light and of a cube of blockers.
const LIGHT_WORDS: usize = 24;
const CUBE_WORDS: usize = 18;

/// What is between surfaces, and what of the light there is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// Nothing, whatever the scene has.
    Clear,
    /// The scene's medium; of light, what is said.
    Medium(Shown),
}

/// What of the light in a medium is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Light that one surface has reflected and that met no medium yet.
    Reflected,
    /// By the medium light that several surfaces have reflected, and by the medium and by surfaces light that was
    /// scattered.
    Multiple,
}

impl Filled {
    /// The kinds of light that are kept apart for it.
    pub const fn kinds(self) -> Kinds {
        match self {
            Self::Clear | Self::Medium(Shown::Reflected) => Kinds { unscattered: 1, scattered: false },
            Self::Medium(Shown::Multiple) => Kinds { unscattered: 2, scattered: true },
        }
    }

    /// What surfels send into it.
    pub const fn lit(self) -> Lit {
        match self {
            Self::Clear => Lit::Reflected,
            Self::Medium(_) => Lit::Dimmed { is_grey: false },
        }
    }
}

/// What of a pixel is lit by the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// The medium in front of its surface.
    pub medium: bool,
    /// Its surface.
    pub surface: bool,
}

/// The passes that are the same for every scene; the others are compiled for its lights and medium.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: surfels::Passes,
    clear: Pass,
    inject: Pass,
    links: Pass,
}

/// The contents of the uniform buffers: the camera, and how far light is propagated, metres.
pub fn uniforms(view: &View, reach: f32) -> Vec<Vec<u8>> {
    let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
    vec![bytes_of(&camera).to_vec(), bytes_of(&uniforms::Propagation { reach }).to_vec()]
}

/// How surfels are laid out: all of one size, wherever the camera is.
pub fn surfel_settings(grid: &LightGrid, bounds: Bounds) -> uniforms::Surfels {
    let far = FAR * bounds.diagonal().max(1e-6);
    uniforms::Surfels { slope: 0.5 * SURFEL * grid.cell / far, near: far, reach: f32::MAX.sqrt() }
}

/// The buffers of a volume.
#[derive(Clone, Debug)]
pub struct VolumeOnGpu {
    record: wgpu::Buffer,
    /// `[planes, 3, cells]`: flux and energy times lengths of ways, watts times cells; as the medium and, if there is
    /// scattered light, as surfaces show it.
    shown: wgpu::Buffer,
    scheme: Scheme,
    kinds: Kinds,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self {
            surfels: surfels::Passes::new(device, Tree::All)?,
            clear: pass(&wgsl::LPV_CLEAR)?,
            inject: pass(&wgsl::LPV_INJECT)?,
            links: pass(&wgsl::LPV_LINKS)?,
        })
    }

    /// The passes that fill a volume around a scene and hand its light on.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room.
    pub fn volume_steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        parameters: Parameters,
        uniforms: &[wgpu::Buffer],
        filled: Filled,
    ) -> Result<(VolumeOnGpu, Vec<MethodStep>), GpuError> {
        let world = frame::scene(inputs.world)?;
        let grid = LightGrid::around(world.bounds, parameters.cells);
        let room = Room::new(device, &grid, filled.kinds())?;
        let mut steps = self.injection(device, world, &grid, &room, &uniforms[VIEW], filled.lit())?;
        steps.push(room.fresh_step(device, parameters.scheme)?);
        if filled != Filled::Clear {
            steps.push(room.media_step(device, world, parameters.scheme)?);
        }
        if room.kinds.scattered {
            steps.push(room.begin_step(device, world, parameters.scheme)?);
        }
        let constants = [room.constants(), parameters.scheme.constants()].concat();
        let shader = wgsl::LPV_PROPAGATE.specialised(&constants);
        let pass = Pass::new(device, wgsl::LPV_PROPAGATE.name, &shader)?;
        for iteration in 0..parameters.iterations {
            let number = uniforms::Iteration { number: iteration as u32 };
            let number = gpu::uniform(device, "lpv.iteration", &number)?;
            let [from, to] = [iteration % 2, 1 - iteration % 2].map(|i| &room.states[i]);
            let reads = [&room.record, &world.medium.record, &room.links, &room.media, from];
            let reads: Vec<_> = (0..).zip(reads).chain([(7, &number), (8, &uniforms[REACH])]).collect();
            let writes = [(5, to), (6, &room.shown)];
            steps.push(MethodStep::bind_at(device, &pass, room.groups.clone(), &reads, &writes)?);
        }
        let Room { record, shown, kinds, .. } = room;
        Ok((VolumeOnGpu { record, shown, scheme: parameters.scheme, kinds }, steps))
    }

    /// Surfels, what they send and what they block.
    fn injection(
        &self,
        device: &wgpu::Device,
        world: &World,
        grid: &LightGrid,
        room: &Room,
        view: &wgpu::Buffer,
        lit: Lit,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let Room { record, sums, cubes, links, groups, .. } = room;
        let settings = gpu::uniform(device, "lpv.surfels", &surfel_settings(grid, world.bounds))?;
        let cloud = Cloud::new(device, world, Some(lit))?;
        let of_surfels = cloud::Uniforms { settings: &settings, view };
        let mut steps = self.surfels.surfel_steps(device, world, &cloud, of_surfels)?;
        let sent = cloud.sent.as_ref().expect("they are lit");
        steps.push(LightPass::new(device, world, lit)?.step(device, world, &cloud, view, sent)?);
        let bind =
            |pass: &Pass, workgroups: &Workgroups, reads: &[&wgpu::Buffer], writes: &[&wgpu::Buffer]| {
                MethodStep::bind(device, pass, workgroups.clone(), reads, writes)
            };
        let words = LIGHT_WORDS.max(CUBE_WORDS) * grid.cells() * 2;
        let counted = Workgroups::Counted(cloud.totals.clone(), SURFEL_GROUPS);
        let read = [record, view, &cloud.totals, &cloud.surfels, sent];
        let read: Vec<_> = (0..).zip(read).chain([(7, &cloud.patches), (8, &cloud.starts)]).collect();
        steps.extend([
            bind(&self.clear, &surfels::groups(words).into(), &[], &[sums, cubes])?,
            MethodStep::bind_at(device, &self.inject, counted, &read, &[(5, sums), (6, cubes)])?,
            bind(&self.links, groups, &[record, cubes], &[links])?,
        ]);
        Ok(steps)
    }
}

/// What lies between the passes.
struct Room {
    record: wgpu::Buffer,
    /// `[cells, 3, 4, 2]` u32: light of surfels, in fixed point.
    sums: wgpu::Buffer,
    /// `[cubes, 9, 2]` u32: blockers, in fixed point.
    cubes: wgpu::Buffer,
    /// `[cells, 4]` u32.
    links: wgpu::Buffer,
    /// `[cells, 2, 4]` f32.
    media: wgpu::Buffer,
    /// `[kinds, 3, cells, 4]` f32, before and after an iteration; if there is scattered light also `[cells, 4]`, what is
    /// sent out again.
    states: [wgpu::Buffer; 2],
    shown: wgpu::Buffer,
    groups: Workgroups,
    kinds: Kinds,
}

impl Room {
    fn new(device: &wgpu::Device, grid: &LightGrid, kinds: Kinds) -> Result<Self, GpuError> {
        let cells = grid.cells();
        let cubes = (grid.size + 1).as_usizevec3().element_product();
        let scattered = usize::from(kinds.scattered);
        let state = || gpu::empty::<[f32; 4]>(device, "lpv.state", (3 * kinds.count() + scattered) * cells);
        Ok(Self {
            record: gpu::uniform(device, "lpv.grid", &grid.record())?,
            sums: gpu::empty::<u32>(device, "lpv.sums", LIGHT_WORDS * cells)?,
            cubes: gpu::empty::<u32>(device, "lpv.cubes", CUBE_WORDS * cubes)?,
            links: gpu::empty::<[u32; 4]>(device, "lpv.links", cells)?,
            media: gpu::empty::<[[f32; 4]; 2]>(device, "lpv.media", cells)?,
            states: [state()?, state()?],
            shown: gpu::empty::<[f32; 4]>(device, "lpv.shown", 3 * (1 + scattered) * cells)?,
            groups: surfels::groups(cells).into(),
            kinds,
        })
    }

    /// Which kinds of light there are, as the passes have it.
    fn constants(&self) -> [(&'static str, u32); 2] {
        [("UNSCATTERED", self.kinds.unscattered as u32), scattered(self.kinds)]
    }

    /// Light that surfaces reflect, before the first iteration.
    fn fresh_step(&self, device: &wgpu::Device, scheme: Scheme) -> Result<MethodStep, GpuError> {
        let [_, lobes] = scheme.constants();
        let shader = wgsl::LPV_FRESH.specialised(&[&self.constants()[..], &[lobes]].concat());
        let pass = Pass::new(device, wgsl::LPV_FRESH.name, &shader)?;
        let writes = [&self.states[0], &self.shown];
        MethodStep::bind(device, &pass, self.groups.clone(), &[&self.record, &self.sums], &writes)
    }

    /// What the medium does in cells.
    fn media_step(
        &self,
        device: &wgpu::Device,
        world: &World,
        scheme: Scheme,
    ) -> Result<MethodStep, GpuError> {
        let MediumOnGpu { record: medium, densities, .. } = &world.medium;
        let [_, kind] = single_scattering::constants(world);
        let shader = wgsl::LPV_MEDIA.specialised(&[&[kind][..], &scheme.constants()].concat());
        let pass = Pass::new(device, wgsl::LPV_MEDIA.name, &shader)?;
        let table = gpu::storage(device, "lpv.table", flight::table())?;
        let buffers = [&self.record, &table, &self.media, medium].map(|buffer| buffer.as_entire_binding());
        let resources: Vec<_> =
            buffers.into_iter().chain([wgpu::BindingResource::TextureView(densities)]).collect();
        let step = Step { pass: pass.bind(device, &resources)?, workgroups: self.groups.clone() };
        Ok(MethodStep { step, writes: vec![self.media.clone()] })
    }

    /// What the medium scatters of the lamps' light.
    fn begin_step(
        &self,
        device: &wgpu::Device,
        world: &World,
        scheme: Scheme,
    ) -> Result<MethodStep, GpuError> {
        let constants =
            [&single_scattering::constants(world)[..], &self.constants(), &scheme.constants()].concat();
        let shader = wgsl::LPV_BEGIN.specialised(&constants);
        let pass = Pass::new(device, wgsl::LPV_BEGIN.name, &shader)?;
        let sampler = shadow_sampler(device);
        let own = [(0, &self.record), (7, &self.states[0]), (8, &self.media)];
        let own = own.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let bound =
            pass.bind_at(device, own.into_iter().chain(single_scattering::bindings(world, &sampler)))?;
        let step = Step { pass: bound, workgroups: self.groups.clone() };
        Ok(MethodStep { step, writes: vec![self.states[0].clone()] })
    }
}

/// Whether there is scattered light, as the passes have it.
const fn scattered(kinds: Kinds) -> (&'static str, u32) {
    ("SCATTERED", kinds.scattered as u32)
}

impl VolumeOnGpu {
    /// Which cells light a surface, as the passes have it.
    const fn lookup(&self) -> (&'static str, u32) {
        ("LOOKUP", self.scheme.lookup as u32)
    }

    /// The pass that lights surfaces: irradiance over pi, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn lit_step(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        view: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<MethodStep, GpuError> {
        let pass = Pass::new(device, wgsl::LPV_LIT.name, &wgsl::LPV_LIT.specialised(&[self.lookup()]))?;
        let [position, normal, valid] = surface(gbuffer);
        let reads = [&self.record, position, normal, valid, view, &self.shown];
        let groups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        MethodStep::bind(device, &pass, groups, &reads, &[image])
    }

    /// The passes that light the medium, of one pixel of `scale` x `scale`, and the surfaces behind it: radiance,
    /// `[3, height, width]`.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn march_steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        [view, march]: [&wgpu::Buffer; 2],
        (pixel, scale): (Pixel, usize),
        image: &wgpu::Buffer,
    ) -> Result<[MethodStep; 2], GpuError> {
        let MediumOnGpu { kind, record: medium, densities } = &frame::scene(inputs.world)?.medium;
        let gbuffer = inputs.gbuffer;
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let [rows, columns] = [height, width].map(|edge| edge.div_ceil(scale));
        let marched_light = gpu::empty::<f32>(device, "lpv.scattered", 3 * rows * columns)?;
        let [position, normal, valid] = surface(gbuffer);
        let diffuse = gbuffer.buffer(Attribute::Diffuse);
        let constants = [("MEDIUM", *kind), ("SCALE", scale as u32)];
        let shows = [
            ("SCATTERS", u32::from(pixel.medium)),
            ("LIT", u32::from(pixel.surface)),
            scattered(self.kinds),
            self.lookup(),
        ];
        let texture = || wgpu::BindingResource::TextureView(densities);
        let step = |shader: &Shader,
                    constants: &[_],
                    its: Bound<'_>,
                    size: [usize; 2],
                    written: &wgpu::Buffer| {
            let pass = Pass::new(device, shader.name, &shader.specialised(constants))?;
            let buffers = its.buffers.iter().map(|(binding, buffer)| (*binding, buffer.as_entire_binding()));
            let pass = pass.bind_at(device, buffers.chain([(its.densities, texture())]))?;
            let workgroups = gpu::groups(size[0], size[1], TILE).into();
            Ok::<_, GpuError>(MethodStep { step: Step { pass, workgroups }, writes: vec![written.clone()] })
        };
        let buffers = [&self.record, march, medium, valid, position, view, &self.shown, &marched_light];
        let marched = Bound { buffers: (0..).zip(buffers).collect(), densities: 8 };
        let buffers = [&self.record, position, normal, valid, view, &self.shown, image, march, medium];
        let more = [(10, diffuse), (11, &marched_light)];
        let applied = Bound { buffers: (0..).zip(buffers).chain(more).collect(), densities: 9 };
        Ok([
            step(&wgsl::LPV_MARCH, &constants, marched, [rows, columns], &marched_light)?,
            step(&wgsl::LPV_APPLY, &[&constants[..], &shows].concat(), applied, [height, width], image)?,
        ])
    }
}

/// What a pass through the medium is bound to: buffers by their numbers, and the number of the densities.
struct Bound<'a> {
    buffers: Vec<(u32, &'a wgpu::Buffer)>,
    densities: u32,
}

fn surface(gbuffer: &GpuGBuffer) -> [&wgpu::Buffer; 3] {
    [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|attribute| gbuffer.buffer(attribute))
}
