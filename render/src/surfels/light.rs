//! The passes that light surfels by a scene's lights, with shadows by the lights' maps (thesis 4.3,
//! "One-bounce Indirect Illumination"). What they send is in a buffer of its own, which effects without light
//! do not have.

use super::cloud::{Cloud, SURFEL_GROUPS};
use super::kept;
use crate::raster::World;
use crate::raster::light::{Lights, shadow_sampler};
use crate::raster::medium::MediumOnGpu;
use crate::raster::patches::Reflectance;
use crate::screen::{Device, MethodStep, PassDispatch, Workgroups};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// What surfels send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfelLight {
    /// What they reflect diffusely, on either side.
    Reflected,
    /// What they reflect of light that the medium between them and the lamps has dimmed.
    Dimmed {
        /// By the mean of its coefficients over the colours.
        is_grey: bool,
    },
    /// What they reflect of light that the medium between them and the lamps has dimmed, and what they emit.
    DimmedAndEmitted,
    /// What they emit alone.
    Emitted,
    /// What they receive, as white ones reflect it, of both sides together.
    Received,
    /// What they give back of light that they kept.
    Kept,
}

impl SurfelLight {
    /// What of a surface's reflectance its surfels know that send such light, as truth has it: through a
    /// medium all, and so of the sky, whose light is found by rays from surfels that are not lit.
    pub fn reflectance(lit: Option<Self>) -> Reflectance {
        match lit {
            None | Some(Self::Dimmed { .. } | Self::DimmedAndEmitted | Self::Emitted) => Reflectance::All,
            Some(Self::Reflected | Self::Received | Self::Kept) => Reflectance::Diffuse,
        }
    }
}

/// The pass, if there is one, at the end of an image of what surfels send, `[3, height, width]`: light that
/// they kept they send in a unit of its own.
///
/// # Errors
/// If the device refuses it.
pub fn ending(
    device: &Device,
    world: &World,
    lit: Option<SurfelLight>,
    image: &wgpu::Buffer,
) -> Result<Option<MethodStep>, GpuError> {
    (lit == Some(SurfelLight::Kept)).then(|| kept::in_watts(device, world, image)).transpose()
}

/// The constant that says in which unit surfels send what they kept.
pub fn kept_unit(world: &World) -> (&'static str, u32) {
    kept::unit(world.glow.glow())
}

/// The passes that write what a cloud's surfels send, `[surfels, 2]` u32.
///
/// # Errors
/// If the device refuses one, or has no room.
pub fn steps(
    device: &Device,
    world: &World,
    lit: SurfelLight,
    cloud: &Cloud,
    [view, sent]: [&wgpu::Buffer; 2],
) -> Result<Vec<MethodStep>, GpuError> {
    let count = ("LIGHTS", world.gpu_lights.count as u32);
    let (shader, constants) = match lit {
        SurfelLight::Kept => return kept::steps(device, world, cloud, sent),
        SurfelLight::Emitted => return Ok(vec![emit_step(device, world, cloud, (sent, false))?]),
        SurfelLight::Reflected => (Shader::at("surfels/reflected"), vec![count]),
        SurfelLight::Dimmed { .. } | SurfelLight::DimmedAndEmitted => {
            let grey = ("GREY", u32::from(lit == SurfelLight::Dimmed { is_grey: true }));
            (Shader::at("surfels/dimmed"), vec![count, ("MEDIUM", world.medium.kind), grey])
        }
        SurfelLight::Received => (Shader::at("surfels/received"), vec![count]),
    };
    let pass = device.pass(shader, &constants)?;
    let Lights { shining, map_views, pictures, .. } = &world.gpu_lights;
    let Cloud { patches, starts, totals, surfels, .. } = cloud;
    let sampler = shadow_sampler(device);
    let buffers = [view, patches, starts, totals, surfels, shining, map_views, pictures];
    let mut resources: Vec<_> = buffers.map(|buffer| buffer.as_entire_binding()).into();
    resources.extend([
        wgpu::BindingResource::TextureView(&world.shadows.maps),
        wgpu::BindingResource::Sampler(&sampler),
        sent.as_entire_binding(),
    ]);
    if matches!(lit, SurfelLight::Dimmed { .. } | SurfelLight::DimmedAndEmitted) {
        let MediumOnGpu { record, densities, .. } = &world.medium;
        resources.extend([record.as_entire_binding(), wgpu::BindingResource::TextureView(densities)]);
    }
    let pass = pass.bind(device, &resources)?;
    let workgroups = Workgroups::Counted(totals.clone(), SURFEL_GROUPS);
    let lamps = MethodStep { step: PassDispatch { pass, workgroups }, writes: vec![sent.clone()] };
    let emits = lit == SurfelLight::DimmedAndEmitted && world.scene().emits();
    let emission = emits.then(|| emit_step(device, world, cloud, (sent, true))).transpose()?;
    Ok([Some(lamps), emission].into_iter().flatten().collect())
}

/// The pass that writes what surfels emit, or `adds` it to what they send.
fn emit_step(
    device: &Device,
    world: &World,
    Cloud { totals, surfels, starts, .. }: &Cloud,
    (sent, adds): (&wgpu::Buffer, bool),
) -> Result<MethodStep, GpuError> {
    let emissions = gpu::storage(device, "surfels.emissions", &world.emissions())?;
    let pass = device.pass(Shader::at("surfels/emit"), &[("ADDS", u32::from(adds))])?;
    let workgroups = Workgroups::Counted(totals.clone(), SURFEL_GROUPS);
    MethodStep::bind(device, &pass, workgroups, &[totals, surfels, starts, &emissions], &[sent])
}
