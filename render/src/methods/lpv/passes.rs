//! What runs on the GPU: surfels, their light and what they block; the medium; light on its way; and what is
//! lit by it.

use super::LpvParameters;
use super::shining::Shining;
use super::shown::VolumeOnGpu;
use super::volume_buffers::{self, VolumeBuffers};
use crate::lpv::propagation::Kinds;
use crate::lpv::sides::SIDES;
use crate::raster::World;
use crate::scene::{Bounds, Density, Scene};
use crate::screen::{Device, MethodStep, Resources, View, Workgroups};
use crate::surfels::cloud::{self, SURFEL_GROUPS};
use crate::surfels::light;
use crate::surfels::{Cloud, SurfelLight};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};

/// Which uniform buffer has the camera.
pub const VIEW: usize = 0;
/// Which says how far light is propagated.
const REACH: usize = 1;

/// Radius of a surfel, cells.
const SURFEL: f32 = 0.1;
/// How far away, over the scene's diagonal, surfels are laid out as if they were, so that all are of a size
/// wherever the camera is.
const FAR: f32 = 1e3;

/// What is between surfaces, and what of the light there is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// Nothing, whatever the scene has.
    Clear,
    /// Nothing; there is no light but what surfaces kept.
    Kept,
    /// The scene's medium, if it has one, which dims light; of that which surfaces emit, what others have
    /// reflected once or more often.
    ReflectedEmission,
    /// The scene's medium; of light, what is said.
    Medium(MediumLight),
}

/// What of a scene shines by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shines {
    /// Whether surfaces emit.
    pub emits: bool,
    /// Whether surfaces give back light that they kept.
    pub gives_back: bool,
    /// Whether the medium does.
    pub medium_gives_back: bool,
    /// Whether the sky does.
    pub sky: bool,
}

/// What of the light in a medium is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MediumLight {
    /// Light that one surface has reflected and that met no medium yet, by the medium, or also by surfaces.
    Reflected {
        /// Whether by surfaces, too.
        by_surfaces: bool,
    },
    /// By the medium light that several surfaces have reflected, and by the medium and by surfaces light that
    /// was scattered.
    Multiple,
}

impl Filled {
    /// The kinds of light that are kept apart for it.
    pub const fn kinds(self) -> Kinds {
        match self {
            Self::Medium(MediumLight::Multiple) => Kinds { unscattered: 2, scattered: true, ..Kinds::ONE },
            Self::Medium(MediumLight::Reflected { by_surfaces: false }) => {
                Kinds { unscattered: SIDES, is_steady: true, ..Kinds::ONE }
            }
            Self::ReflectedEmission => Kinds { is_reflected: true, ..Kinds::ONE },
            Self::Clear | Self::Kept | Self::Medium(MediumLight::Reflected { by_surfaces: true }) => {
                Kinds::ONE
            }
        }
    }

    /// Whether there is the scene's medium.
    pub const fn has_medium(self) -> bool {
        matches!(self, Self::Medium(_) | Self::ReflectedEmission)
    }

    /// Whether what surfels send begins as emitted light does: shown is what others reflect of it.
    pub const fn begins_as_emitted(self) -> bool {
        matches!(self, Self::ReflectedEmission)
    }

    /// What of a scene shines into it by itself, as lamps do.
    pub fn shines(self, scene: &Scene) -> Shines {
        match self {
            Self::Clear => Shines { emits: scene.emits(), ..Shines::default() },
            Self::Kept | Self::ReflectedEmission => Shines::default(),
            Self::Medium(_) => Shines {
                emits: scene.emits(),
                gives_back: scene.keeps_light(),
                medium_gives_back: scene.medium_keeps_light(),
                sky: sees_sky(scene),
            },
        }
    }

    /// What surfels send into it.
    pub const fn lit(self) -> SurfelLight {
        match self {
            Self::Clear => SurfelLight::Reflected,
            Self::Kept => SurfelLight::Kept,
            Self::ReflectedEmission => SurfelLight::Emitted,
            Self::Medium(_) => SurfelLight::Dimmed { is_grey: false },
        }
    }
}

/// Whether the sky shines into a scene's medium: none does through one without an end.
fn sees_sky(scene: &Scene) -> bool {
    let has_end = scene.medium.as_ref().is_some_and(|medium| medium.density != Density::Everywhere);
    has_end && scene.environment.is_some()
}

/// What of a pixel is lit by the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// The medium in front of its surface.
    pub medium: bool,
    /// Its surface.
    pub surface: bool,
}

/// The contents of the uniform buffers: the camera, and how far light is propagated, metres.
pub fn uniforms(view: &View, reach: f32) -> Vec<Vec<u8>> {
    vec![bytes_of(&view.perspective()).to_vec(), bytes_of(&uniforms::Propagation { reach }).to_vec()]
}

/// How surfels are laid out for cells of such an edge: all of one size, wherever the camera is.
pub fn surfel_settings(cell: f32, bounds: Bounds) -> uniforms::Surfels {
    let far = FAR * bounds.diagonal().max(1e-6);
    let slope = 0.5 * SURFEL * cell / far;
    // Nothing is to the side of such a camera.
    uniforms::Surfels { slope, near: far, reach: f32::MAX.sqrt(), slope_x: 0.0, slope_y: 0.0 }
}

/// The surfels of a scene that is filled, whatever of its light is shown, and the passes that light them.
///
/// # Errors
/// If there is no scene, or the device has no room.
pub fn lit_surfels(
    to: &Resources<'_>,
    parameters: LpvParameters,
    filled: Filled,
) -> Result<(Surfels, Vec<MethodStep>), GpuError> {
    let frame = Frame::new(to)?;
    let cell = parameters.finest_cell(filled, frame.world.bounds);
    let surfels = Surfels::new(to.device, frame, cell, filled)?;
    let steps = surfel_steps(to.device, frame, &surfels)?;
    Ok((surfels, steps))
}

/// The volumes of a frame, one around a scene and finer ones in it.
pub struct FilledVolumes {
    /// Light that surfaces or the medium turned.
    pub light: Vec<VolumeOnGpu>,
    /// What a scene and the sky send by themselves, on its way to them; empty where nothing is.
    pub emission: Vec<VolumeOnGpu>,
}

/// The passes that fill volumes with the light of surfels and hand it on.
///
/// # Errors
/// If there is no scene, or the device has no room.
pub fn volume_steps(
    to: &Resources<'_>,
    parameters: LpvParameters,
    filled: Filled,
    surfels: &Surfels,
) -> Result<(FilledVolumes, Vec<MethodStep>), GpuError> {
    let device = to.device;
    let frame = Frame::new(to)?;
    let grids = parameters.grids(filled, frame.world.bounds, frame.world.bounds.centre());
    let mut steps = Vec::new();
    let mut levels: Vec<Level> = Vec::new();
    for grid in &grids {
        let outside = levels.last();
        let record = match outside {
            None => gpu::uniform(device, "lpv.grid", &grid.record())?,
            Some(outside) => {
                let (record, step) = volume_buffers::nest_step(device, &outside.light.record, frame.view)?;
                steps.push(step);
                record
            }
        };
        let (kinds, is_nested) = (filled.kinds(), outside.is_some());
        let room = VolumeBuffers::new(device, (grid, record), (kinds, is_nested), parameters.scheme)?;
        let level = level_steps(device, frame, surfels, room, outside, (parameters, filled))?;
        steps.extend(level.1);
        levels.push(level.0);
    }
    let mut volumes = FilledVolumes { light: Vec::new(), emission: Vec::new() };
    for Level { light, emission } in levels {
        volumes.emission.extend(emission);
        volumes.light.push(light);
    }
    Ok((volumes, steps))
}

/// The passes that light surfaces by volumes, in an image.
///
/// # Errors
/// As [`volume_steps`].
pub fn lit_steps(
    to: &Resources<'_>,
    parameters: LpvParameters,
    filled: Filled,
) -> Result<Vec<MethodStep>, GpuError> {
    let (surfels, mut steps) = lit_surfels(to, parameters, filled)?;
    let (volumes, filling) = volume_steps(to, parameters, filled, &surfels)?;
    steps.extend(filling);
    for volume in &volumes.light {
        steps.push(volume.lit_step(to, &to.uniforms[VIEW])?);
    }
    steps.extend(light::ending(to.device, to.scene()?, Some(filled.lit()), to.output)?);
    Ok(steps)
}

/// The passes of one volume.
fn level_steps(
    device: &Device,
    frame: Frame<'_>,
    surfels: &Surfels,
    room: VolumeBuffers,
    outside: Option<&Level>,
    (parameters, filled): (LpvParameters, Filled),
) -> Result<(Level, Vec<MethodStep>), GpuError> {
    let has_emission = surfels.shining.is_any() || filled.begins_as_emitted();
    let emission = || room.of_emission(device, surfels.shining.sky.is_some());
    let emission = has_emission.then(emission).transpose()?;
    let mut steps = Vec::new();
    for room in [Some(&room), emission.as_ref()].into_iter().flatten() {
        steps.push(clear_step(device, room)?);
    }
    let first = emission.as_ref().filter(|_| filled.begins_as_emitted()).unwrap_or(&room);
    steps.extend(injection(device, frame, surfels, (&room, &first.sums))?);
    if filled.has_medium() && frame.world.scene().medium.is_some() {
        steps.push(room.media_step(device, frame.world)?);
    }
    let iterations = parameters.iterations;
    if let Some(emission) = &emission {
        let outside = outside.and_then(|outside| outside.emission.as_ref());
        steps.extend(emission_steps(device, frame, surfels, (emission, &room), (outside, iterations))?);
    }
    let emission = emission.map(VolumeBuffers::volume);
    steps.push(room.fresh_step(device, frame.world)?);
    if room.kinds.scattered {
        steps.push(room.begin_step(device, frame.world, emission.as_ref().map(|light| &light.shown))?);
    }
    if let Some(outside) = outside {
        steps.push(room.border_step(device, &outside.light)?);
    }
    steps.extend(room.propagation_steps(device, frame.world, iterations, frame.reach)?);
    Ok((Level { light: room.volume(), emission }, steps))
}

/// Surfels, and what they reflect of the lamps' light.
fn surfel_steps(
    device: &Device,
    Frame { world, view, .. }: Frame<'_>,
    Surfels { cloud, sent, settings, lit, shining }: &Surfels,
) -> Result<Vec<MethodStep>, GpuError> {
    let of_surfels = cloud::Uniforms { settings, view };
    let mut steps = cloud.surfel_steps(device, world, of_surfels)?;
    steps.extend(light::steps(device, world, *lit, cloud, [view, sent])?);
    steps.extend(shining.keeping_steps(device, world, (cloud, view))?);
    Ok(steps)
}

/// Surfels as light, which is added to sums, and as blockers.
fn injection(
    device: &Device,
    Frame { view, .. }: Frame<'_>,
    surfels: &Surfels,
    (room, sums): (&VolumeBuffers, &wgpu::Buffer),
) -> Result<Vec<MethodStep>, GpuError> {
    let Surfels { cloud, sent, .. } = surfels;
    let VolumeBuffers { record, blockers, links, groups, .. } = room;
    let read = [record, view, &cloud.totals, &cloud.surfels, sent];
    let read: Vec<_> = (0..).zip(read).chain([(7, &cloud.patches), (8, &cloud.starts)]).collect();
    let written = [(5, sums), (6, blockers)];
    let [inject, link] = [Shader::at("methods/lpv/inject"), Shader::at("methods/lpv/links")];
    Ok(vec![
        MethodStep::bind_at(device, &device.pass(inject, &[])?, surfels.groups(), &read, &written)?,
        MethodStep::bind(device, &device.pass(link, &[])?, groups.clone(), &[record, blockers], &[links])?,
    ])
}

/// Light that a scene sends by itself, on its way until surfaces reflect it or the medium scatters it: what
/// they reflect is added to the volume's.
fn emission_steps(
    device: &Device,
    Frame { world, view, .. }: Frame<'_>,
    surfels: &Surfels,
    (emitted, room): (&VolumeBuffers, &VolumeBuffers),
    (outside, iterations): (Option<&VolumeOnGpu>, usize),
) -> Result<Vec<MethodStep>, GpuError> {
    let Surfels { cloud, shining, .. } = surfels;
    let nested = ("NESTED", u32::from(outside.is_some()));
    let constants = [room.scheme.lookup_constant(), nested];
    let reflects = device.pass(Shader::at("methods/lpv/reflect"), &constants)?;
    let reads = [&room.record, view, &cloud.totals, &cloud.surfels, &cloud.patches];
    let others = [(6, &emitted.shown), (7, &cloud.starts)];
    let reflecting: Vec<_> = (0..).zip(reads).chain(others).collect();
    // However far it came: a radius is of what surfaces reflect.
    let reach = gpu::uniform(device, "lpv.reach", &uniforms::Propagation { reach: f32::MAX })?;
    let mut steps = shining.sending_steps(device, world, (cloud, view), emitted)?;
    steps.push(match &shining.sky {
        Some(sky) => emitted.enter_step(device, world, sky)?,
        None => emitted.fresh_step(device, world)?,
    });
    if let Some(outside) = outside {
        steps.push(emitted.border_step(device, outside)?);
    }
    steps.extend(emitted.propagation_steps(device, world, iterations, &reach)?);
    let written = [(5, &room.sums)];
    steps.push(MethodStep::bind_at(device, &reflects, surfels.groups(), &reflecting, &written)?);
    Ok(steps)
}

/// Sums of the frame before are forgotten.
fn clear_step(device: &Device, room: &VolumeBuffers) -> Result<MethodStep, GpuError> {
    let clear = device.pass(Shader::at("methods/lpv/clear"), &[])?;
    MethodStep::bind(device, &clear, room.words(), &[], &[&room.sums, &room.blockers])
}

/// What passes read of a frame: the scene, the camera and how far light is propagated.
#[derive(Clone, Copy)]
struct Frame<'a> {
    world: &'a World,
    view: &'a wgpu::Buffer,
    reach: &'a wgpu::Buffer,
}

impl<'a> Frame<'a> {
    fn new(to: &Resources<'a>) -> Result<Self, GpuError> {
        Ok(Self { world: to.scene()?, view: &to.uniforms[VIEW], reach: &to.uniforms[REACH] })
    }
}

/// One of the volumes, and light in it that a scene sends by itself, if it does.
struct Level {
    light: VolumeOnGpu,
    emission: Option<VolumeOnGpu>,
}

/// The surfels of a frame, and what shines by itself.
pub struct Surfels {
    cloud: Cloud,
    sent: wgpu::Buffer,
    settings: wgpu::Buffer,
    lit: SurfelLight,
    shining: Shining,
}

impl Surfels {
    fn new(device: &Device, frame: Frame<'_>, cell: f32, filled: Filled) -> Result<Self, GpuError> {
        let (world, lit) = (frame.world, filled.lit());
        let settings = gpu::uniform(device, "lpv.surfels", &surfel_settings(cell, world.bounds))?;
        let cloud = Cloud::new(device, world, Some(lit))?;
        let sent = cloud.sent.clone().expect("they are lit");
        let shining = Shining::new(device, world, (filled, cell), sent.size())?;
        Ok(Self { cloud, sent, settings, lit, shining })
    }

    /// Workgroups of passes over them.
    fn groups(&self) -> Workgroups {
        Workgroups::Counted(self.cloud.totals.clone(), SURFEL_GROUPS)
    }
}
