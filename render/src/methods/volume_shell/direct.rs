//! Direct single scattering by the transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.3): what the medium
//! scatters of the lamps' light, which is the effect `fog-direct`. The paper shows it beside the light of surfaces.
//!
//! Limits. Light of point, spot and directional lights only. A ray has as many points as intervals, so that what lies between
//! shafts of light is noise; methods that follow the shafts are [`epipolar`](crate::methods::epipolar) and its rivals.

use super::Parameters;
use super::map::{self, IntervalMap};
use super::reference::Rays;
use crate::bvh::TracedScene;
use crate::methods::single_scattering::{self, LitMedium};
use crate::raster::World;
use crate::raster::light::shadow_sampler;
use crate::raster::view::perspective;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Step, Technique, View, Written};
use crate::surfels::frame;
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// What can be set: of the parameters only how rays are divided matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct(Parameters);

/// The method, compiled for a device.
pub type VolumeShellDirect = Compiled<Direct>;

impl From<Parameters> for Direct {
    fn from(parameters: Parameters) -> Self {
        Self(parameters)
    }
}

impl Technique for Direct {
    const NAME: &'static str = "volume-shell";
    const EFFECT: Effect = Effect::FogDirect;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    /// Both depend on the scene.
    type Passes = ();

    fn compile(_device: &wgpu::Device) -> Result<(), GpuError> {
        Ok(())
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
        vec![
            bytes_of(&self.0.marching(view)).to_vec(),
            bytes_of(&camera).to_vec(),
            bytes_of(&self.0.scattering(view)).to_vec(),
        ]
    }

    fn steps(
        &self,
        _passes: &(),
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let [march, view, volume] = uniforms else { unreachable!("march, view and scattering") };
        let world = frame::scene(inputs.world)?;
        let read = map::Uniforms { march, view };
        let (map, march) = IntervalMap::step(device, &self.0, inputs.gbuffer, world, read)?;
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let workgroups = gpu::groups(height, width, TILE).into();
        let pass = scatter_pass(device, &self.0, world)?;
        let sampler = shadow_sampler(device);
        let own = [(0, volume), (1, view), (7, &map.rays), (8, &map.samples), (9, output)];
        let own = own.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let resources =
            own.into_iter().chain(single_scattering::bindings(world, &world.gpu_lights.records, &sampler));
        let pass = pass.bind_at(device, resources)?;
        let scatter = MethodStep { step: Step { pass, workgroups }, writes: vec![output.clone()] };
        Ok(vec![march, scatter])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let shaded = |scene| Ok(shade(inputs.gbuffer, scene, &self.0, view)?.data().to_vec());
        inputs.scene.map(shaded).into_iter().collect()
    }
}

fn scatter_pass(device: &wgpu::Device, parameters: &Parameters, world: &World) -> Result<Pass, GpuError> {
    let shader = &wgsl::VOLUME_SHELL_DIRECT;
    let [lights, medium] = single_scattering::constants(world);
    let constants = [("SAMPLES", parameters.samples), lights, medium];
    Pass::new(device, shader.name, &shader.specialised(&constants))
}

/// The image in plain Rust, with exact shadows, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &Parameters,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let Some(lit) = LitMedium::of(scene) else {
        return Ok(Planes::filled(3, height, width, 0.0));
    };
    let rays = Rays::new(gbuffer, lit.medium, parameters, view)?;
    let nearest = parameters.nearest * view.radius;
    let radiance = |index: usize| {
        let ray = rays.of(UVec2::new((index % width) as u32, (index / width) as u32));
        let at = |distance: f32| {
            let point = view.camera.position + distance * ray.direction;
            let of = |light| lit.scattered_of(light, point, ray.direction, nearest);
            lit.lights().iter().map(of).sum::<Vec3>()
        };
        ray.intervals.iter().map(|interval| interval.weight * at(interval.distance)).sum::<Vec3>()
    };
    let radiance: Vec<Vec3> = (0..height * width).into_par_iter().map(radiance).collect();
    Ok(Planes::from_fn(3, height, width, |channel, y, x| radiance[y * width + x][channel]))
}
