//! What holds for every method that integrates along view rays: closed forms, truth, and the places where
//! geometry degenerates.

mod closed_forms;
mod limits;
mod maps;
mod truth;

use super::{Integration, IntegrationInputs, Shafts};
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Method, MethodError, Repeats};
use crate::methods::{
    Quality, epipolar, epipolar_sampling, fog_march, froxel, gpu_epipolar, min_max, ray_march,
};
use crate::metrics::{exposed, exposure, relative_mse};
use crate::path::proving::{floor, quad};
use crate::scene::{Bounds, Camera, Density, Light, Material, Medium, Mesh, Scene};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::Vec3;
use std::sync::Arc;

/// All methods at a quality.
fn methods(quality: Quality) -> [Box<dyn Method>; 4] {
    [
        Box::new(Shafts(ray_march::RayMarchParameters::of(quality))),
        Box::new(Shafts(epipolar::EpipolarParameters::of(quality))),
        Box::new(Shafts(epipolar_sampling::EpipolarSamplingParameters::of(quality))),
        Box::new(Shafts(min_max::MinMaxParameters::of(quality))),
    ]
}

/// Those that run on the GPU, froxels as fine as pixels.
fn on_gpu() -> [Box<dyn Method>; 3] {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let fine = froxel::FroxelParameters { tile: 1, slices: 384, samples: 1 };
    [
        Box::new(ScreenMethod::new(&gpu, fog_march::FogMarchParameters::of(Quality::Ultra))),
        Box::new(ScreenMethod::new(&gpu, gpu_epipolar::GpuEpipolarParameters::of(Quality::Ultra))),
        Box::new(ScreenMethod::new(&gpu, fine)),
    ]
}

/// An image of `[height, width]`.
fn image(
    method: &dyn Method,
    scene: &TracedScene,
    camera: &Camera,
    size: [usize; 2],
) -> Result<Planes, MethodError> {
    let gbuffer = gbuffer::render(scene, camera, size[0], size[1], &[Attribute::Depth, Attribute::Valid]);
    let frame = Frame { scene, camera, gbuffer: &gbuffer, radius: 1.0, seed: 3 };
    method.shade(&frame, Repeats::ONCE).map(|shaded| shaded.image)
}

/// Relative squared error of an image, both being exposed as truth is.
fn error(image: &Planes, truth: &Planes) -> f64 {
    let exposure = exposure(Effect::FogDirect, truth);
    relative_mse(&exposed(image, exposure), &exposed(truth, exposure))
}

/// A way to integrate that is not told what hides the light.
struct Unshadowed<I>(I);

impl<I: Integration> Integration for Unshadowed<I> {
    const NAME: &'static str = I::NAME;
    const WANTS_EVEN_FOG: bool = I::WANTS_EVEN_FOG;

    fn shadow_size(&self) -> usize {
        self.0.shadow_size()
    }

    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]) {
        let map = lit.map.emptied();
        self.0.add(&IntegrationInputs { map: &map, ..*lit }, radiance);
    }
}

/// Matte meshes in a medium.
fn scene(meshes: Vec<Mesh>, lights: Vec<Light>, medium: Medium) -> TracedScene {
    let medium = Some(Arc::new(medium));
    let materials = vec![Material::default()];
    TracedScene::new(Scene { meshes: meshes.into(), materials, lights, medium, ..Scene::default() })
        .expect("triangles")
}

/// Fog of some colours in a box.
fn fog(anisotropy: f32, [min, max]: [[f32; 3]; 2]) -> Medium {
    let bounds = Bounds { min: min.into(), max: max.into() };
    let (absorption, scattering) = (Vec3::new(0.02, 0.05, 0.01), Vec3::new(0.1, 0.15, 0.2));
    Medium::new(absorption, scattering, anisotropy, Density::Within(bounds)).expect("fog")
}

fn sun(direction: Vec3) -> Light {
    let irradiance = Vec3::new(30.0, 20.0, 10.0);
    Light::Directional { direction: direction.normalize(), irradiance, pattern: None }
}

fn lamp(position: Vec3) -> Light {
    Light::Point { position, intensity: Vec3::new(20.0, 30.0, 40.0), range: f32::INFINITY }
}

fn spot(position: Vec3, direction: Vec3) -> Light {
    Light::Spot {
        position,
        direction: direction.normalize(),
        intensity: Vec3::new(200.0, 150.0, 100.0),
        range: 30.0,
        cos_inner: 0.95,
        cos_outer: 0.85,
        slide: None,
    }
}

/// A floor under a roof with slits and a beam.
fn pergola() -> Vec<Mesh> {
    let roof = |x: [f32; 2], z: [f32; 2]| {
        quad([(x[0], z[0]), (x[0], z[1]), (x[1], z[1]), (x[1], z[0])].map(|(x, z)| Vec3::new(x, 3.0, z)))
    };
    let long = [-9.0, 9.0];
    vec![
        floor(),
        roof([-9.0, -2.0], long),
        roof([-1.2, 0.3], long),
        roof([1.0, 1.4], long),
        roof([2.2, 9.0], long),
        roof([-2.0, 2.2], [-1.0, 0.5]),
    ]
}

/// The box of fog around it.
const AROUND: [[f32; 3]; 2] = [[-9.0, -0.5, -9.0], [9.0, 6.0, 9.0]];
