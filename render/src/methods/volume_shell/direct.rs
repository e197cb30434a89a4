//! Direct single scattering by the transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.3): what
//! the medium scatters of the lamps' light, which is the effect `fog-direct`. The paper shows it beside the
//! light of surfaces.
//!
//! Limits. Light of point, spot and directional lights only. A ray has as many points as intervals, so that
//! what lies between shafts of light is noise; methods that follow the shafts are
//! [`epipolar`](crate::methods::epipolar) and its rivals.

use super::VolumeShellParameters;
use super::map::{self, IntervalMap};
use super::reference::Rays;
use crate::bvh::TracedScene;
use crate::methods::single_scattering::{self, LitMedium};
use crate::raster::light::shadow_sampler;
use crate::screen::{About, MethodStep, PassDispatch, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// What can be set: of the parameters only how rays are divided matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct(pub VolumeShellParameters);

impl Technique for Direct {
    fn about(&self) -> About {
        About::beyond_screen("volume-shell", Effect::FogDirect, &[Attribute::Position, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        vec![
            bytes_of(&self.0.division(view.seed).marching(view)).to_vec(),
            bytes_of(&camera).to_vec(),
            bytes_of(&self.0.scattering(view)).to_vec(),
        ]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [march, view, volume] = to.uniforms else { unreachable!("march, view and scattering") };
        let (device, world, output) = (to.device, to.scene()?, to.output);
        let (map, march) = IntervalMap::step(&self.0.division(0), to, map::Uniforms { march, view })?;
        let [lights, medium] = single_scattering::constants(world);
        let constants = [("SAMPLES", self.0.samples), lights, medium];
        let pass = device.pass(Shader::at("methods/volume-shell/direct"), &constants)?;
        let sampler = shadow_sampler(device);
        let own = [(0, volume), (1, view), (7, &map.rays), (8, &map.samples), (9, output)];
        let own = own.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let resources =
            own.into_iter().chain(single_scattering::bindings(world, &world.gpu_lights.records, &sampler));
        let pass = pass.bind_at(device, resources)?;
        let step = PassDispatch { pass, workgroups: to.whole().into() };
        Ok(vec![march, MethodStep { step, writes: vec![output.clone()] }])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| shade(inputs.gbuffer, scene, &self.0, view))
    }
}

/// The image in plain Rust, with exact shadows, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: &VolumeShellParameters,
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
