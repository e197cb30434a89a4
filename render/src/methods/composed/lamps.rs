//! Light of lamps as truth has it of microfacets. The g-buffer's is by Phong's model. Its share of what that
//! model had without shadows is what of the lamps' light arrives; microfacets reflect as much of it.
//!
//! Of several lamps, what is hidden of one is hidden of the others, too. Beside highlights of metal, where
//! Phong's model has no light, nothing is taken to hide a lamp.

use crate::bvh::TracedScene;
use crate::gbuffer::OBJECT_IDS;
use crate::methods::picture::every_pixel;
use crate::path::bsdf::{Fresnel, Ggx, Phong};
use crate::path::lights::Arrival;
use crate::raster::World;
use crate::scene::{Gloss, Scene};
use crate::screen::surface::vector;
use crate::screen::{MethodStep, PlainInputs, Resources, View};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, MissingAttribute, Planes, shows_surface};
use glam::{IVec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Smoother lobes are as wide as this, as those of the g-buffer's light are.
const NARROWEST_ROUGHNESS: f32 = 0.141_421_36;
/// Less light than this says nothing of how much arrives.
const LEAST: f32 = 1e-12;

/// Whether a scene has lamps and something of microfacets that they light.
pub fn has(scene: &Scene) -> bool {
    !scene.lights.is_empty() && of_microfacets(scene).contains(&1)
}

/// For each object id 1 where it is of microfacets; of meshes that share an id, the last one.
pub fn of_microfacets(scene: &Scene) -> Vec<u32> {
    let mut objects = vec![0; scene.meshes.len().clamp(1, OBJECT_IDS as usize)];
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let gloss = scene.materials[mesh.material.0 as usize].gloss;
        objects[number % OBJECT_IDS as usize] = u32::from(gloss == Gloss::Microfacets);
    }
    objects
}

/// The passes that change an image of the g-buffer's light.
///
/// # Errors
/// If the device refuses them, or has no room.
pub fn steps(to: &Resources<'_>, world: &World, view: &wgpu::Buffer) -> Result<Vec<MethodStep>, GpuError> {
    let [height, width] = to.size();
    let device = to.device;
    let lobes = gpu::empty::<f32>(device, "composed.lobes", 4 * 3 * height * width)?;
    let lights = &world.gpu_lights;
    let count = ("LIGHTS", lights.count as u32);
    let [position, normal, valid, specular, glossiness] = to.seen([
        Attribute::Position,
        Attribute::Normal,
        Attribute::Valid,
        Attribute::Specular,
        Attribute::Glossiness,
    ]);
    let reads = [view, position, normal, valid, specular, glossiness, &lights.records, &lights.pictures];
    let pass = device.pass(Shader::at("methods/composed/lobes"), &[count])?;
    let lobes_step = MethodStep::bind(device, &pass, to.whole(), &reads, &[&lobes])?;

    let objects = of_microfacets(world.scene());
    let count = ("OBJECTS", objects.len() as u32);
    let objects = gpu::storage(device, "composed.of_microfacets", &objects)?;
    let [light, diffuse, ids] = to.seen([Attribute::Light, Attribute::Diffuse, Attribute::ObjectId]);
    let pass = device.pass(Shader::at("methods/composed/facets"), &[count])?;
    let reads = [view, &lobes, light, diffuse, specular, ids, &objects];
    Ok(vec![lobes_step, MethodStep::bind(device, &pass, to.whole(), &reads, &[to.output])?])
}

/// The same of an image in plain Rust.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn change(
    image: &mut Planes,
    scene: &TracedScene,
    inputs: &PlainInputs<'_>,
    view: &View,
) -> Result<(), MissingAttribute> {
    let of = |attribute| inputs.gbuffer.select(&[attribute]);
    let (valid, ids, glossiness) =
        (of(Attribute::Valid)?, of(Attribute::ObjectId)?, of(Attribute::Glossiness)?);
    let [position, normal, light, diffuse, specular] = [
        of(Attribute::Position)?,
        of(Attribute::Normal)?,
        of(Attribute::Light)?,
        of(Attribute::Diffuse)?,
        of(Attribute::Specular)?,
    ];
    let objects = of_microfacets(scene.scene());
    let change = |at: IVec2| {
        let (y, x) = (at.y as usize, at.x as usize);
        let object = (ids.at(0, y, x) as usize).min(objects.len() - 1);
        if !shows_surface(valid.at(0, y, x)) || objects[object] == 0 {
            return Vec3::ZERO;
        }
        let offset = view.camera.rotation * vector(&position, at);
        let seen = Seen {
            point: view.camera.position + offset,
            normal: view.camera.rotation * vector(&normal, at),
            to_camera: -offset.normalize(),
            specular: vector(&specular, at),
            roughness: 1.0 - glossiness.at(0, y, x),
        };
        let lobes = seen.lobes(scene.scene());
        let (diffuse, light) = (vector(&diffuse, at), vector(&light, at));
        let phong = diffuse * lobes.phong_diffuse + seen.specular * lobes.phong_specular;
        let reflected = diffuse * lobes.facets_diffuse + lobes.facets_specular;
        let least = Vec3::splat(LEAST);
        let share = Vec3::select(phong.cmpgt(least), (light / phong.max(least)).min(Vec3::ONE), Vec3::ONE);
        let is_known = phong.cmpgt(least) | light.cmple(least);
        Vec3::select(is_known, share * reflected - light, Vec3::ZERO)
    };
    let changes = every_pixel(view.height, view.width, change);
    for channel in 0..3 {
        let values = image.plane_mut(channel).iter_mut().zip(&changes);
        values.for_each(|(value, change)| *value += change[channel]);
    }
    Ok(())
}

/// What lamps send on if nothing hides them, of colours of 1.
#[derive(Default)]
struct Lobes {
    phong_diffuse: Vec3,
    phong_specular: Vec3,
    facets_diffuse: Vec3,
    facets_specular: Vec3,
}

/// A surface, world space.
struct Seen {
    point: Vec3,
    normal: Vec3,
    to_camera: Vec3,
    specular: Vec3,
    roughness: f32,
}

impl Seen {
    fn lobes(&self, scene: &Scene) -> Lobes {
        let Self { point, normal, to_camera, specular, roughness } = *self;
        let (phong, fresnel) = (Phong::new(roughness), Fresnel::new(specular));
        let ggx = Ggx::new(roughness.max(NARROWEST_ROUGHNESS));
        let viewer = normal.dot(to_camera);
        let mirrored = normal * (2.0 * viewer) - to_camera;
        let mut lobes = Lobes::default();
        for light in &scene.lights {
            let Arrival { direction, irradiance, .. } = Arrival::new(scene, light, point);
            let cosine = normal.dot(direction);
            if cosine <= 0.0 {
                continue;
            }
            let received = irradiance * cosine;
            lobes.phong_diffuse += received * FRAC_1_PI;
            lobes.phong_specular += received * phong.reflectance(mirrored.dot(direction));
            if viewer > 0.0 {
                let through = fresnel.let_through(viewer) * fresnel.let_out(cosine);
                lobes.facets_diffuse += received * FRAC_1_PI * through;
                let halfway = (to_camera + direction).normalize();
                let frame = crate::sampler::frame(normal).transpose();
                let facets = ggx.reflectance(frame * to_camera, frame * direction);
                lobes.facets_specular += received * fresnel.reflected(to_camera.dot(halfway)) * facets;
            }
        }
        lobes
    }
}
