//! Single scattering of lamps' light, as passes on the GPU ask for it point by point: what they bind, and the
//! plain version of `shared/single_scattering.wgsl` and `shared/mean_decay.wgsl`.

use super::shafts;
use crate::bvh::TracedScene;
use crate::path::lights::Arrival;
use crate::path::medium::HenyeyGreenstein;
use crate::raster::World;
use crate::raster::light::Lights;
use crate::raster::medium::MediumOnGpu;
use crate::scene::medium::POINTS;
use crate::scene::{Light, Medium};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, shows_surface};
use glam::Vec3;

/// What methods of single scattering on the GPU read of a g-buffer.
pub const ATTRIBUTES: &[Attribute] = &[Attribute::Position, Attribute::Valid];

/// What shaders are compiled for: how many lamps there are, and which kind of medium.
pub fn constants(world: &World) -> [(&'static str, u32); 2] {
    [("LIGHTS", world.gpu_lights.count as u32), ("MEDIUM", world.medium.kind)]
}

/// Lights, by their `records`, with their maps, from binding 2 to 6, and the medium, 11 and 12.
pub fn bindings<'a>(
    world: &'a World,
    records: &'a wgpu::Buffer,
    sampler: &'a wgpu::Sampler,
) -> impl Iterator<Item = (u32, wgpu::BindingResource<'a>)> {
    let Lights { map_views, pictures, .. } = &world.gpu_lights;
    let MediumOnGpu { record, densities, .. } = &world.medium;
    let lights = [records, map_views, pictures].map(|buffer| buffer.as_entire_binding());
    let maps =
        [wgpu::BindingResource::TextureView(&world.shadows.maps), wgpu::BindingResource::Sampler(sampler)];
    let medium = [record.as_entire_binding(), wgpu::BindingResource::TextureView(densities)];
    (2..).zip(lights.into_iter().chain(maps)).chain((11..).zip(medium))
}

/// A scene whose medium is lit.
#[derive(Clone, Copy, Debug)]
pub struct LitMedium<'a> {
    scene: &'a TracedScene,
    /// What scatters.
    pub medium: &'a Medium,
    phase: HenyeyGreenstein,
}

impl<'a> LitMedium<'a> {
    /// The medium of a scene, if it has one.
    pub fn of(scene: &'a TracedScene) -> Option<Self> {
        let medium = scene.scene().medium.as_deref()?;
        Some(Self { scene, medium, phase: HenyeyGreenstein::new(medium.anisotropy) })
    }

    /// What shines on it.
    pub fn lights(&self) -> &'a [Light] {
        &self.scene.scene().lights
    }

    /// Radiance that a metre of density 1 sends against a unit direction, over its scattering coefficient,
    /// with exact shadows. What is nearer to a lamp than `nearest`, metres, gets what it would there.
    pub fn scattered_of(&self, light: &Light, point: Vec3, direction: Vec3, nearest: f32) -> Vec3 {
        let arrived = Arrival::new(self.scene.scene(), light, point);
        if arrived.irradiance == Vec3::ZERO || self.scene.blocked(point, arrived.direction, arrived.distance)
        {
            return Vec3::ZERO;
        }
        let near = arrived.distance < nearest;
        let bounded_share = if near { (arrived.distance / nearest).powi(2) } else { 1.0 };
        bounded_share * self.turned(&arrived, point, direction)
    }

    /// Whether something is between a lamp and a point.
    pub fn is_hidden(&self, light: &Light, point: Vec3) -> bool {
        let Arrival { direction, distance, .. } = Arrival::new(self.scene.scene(), light, point);
        self.scene.blocked(point, direction, distance)
    }

    /// What [`Self::scattered_of`] is where nothing hides a lamp.
    pub fn unhidden(&self, light: &Light, point: Vec3, direction: Vec3) -> Vec3 {
        self.turned(&Arrival::new(self.scene.scene(), light, point), point, direction)
    }

    fn turned(&self, arrived: &Arrival, point: Vec3, direction: Vec3) -> Vec3 {
        let Arrival { direction: towards, distance, irradiance } = *arrived;
        let passed = self.medium.passed_share(point, towards, distance, POINTS);
        irradiance * passed * self.phase.evaluate(towards.dot(direction))
    }
}

/// Mean of `exp(-x)` from 0 to a depth, of each colour.
pub fn mean_decay(depth: Vec3) -> Vec3 {
    Vec3::from_array(depth.to_array().map(shafts::mean_decay))
}

/// How far away each pixel's surface is, along its view ray, metres; 1e30 where none is seen.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn distances(gbuffer: &GBuffer) -> Result<Vec<f32>, MissingAttribute> {
    let planes = gbuffer.select(ATTRIBUTES)?;
    let pixel = |i: usize| {
        let position = Vec3::from([0, 1, 2].map(|channel| planes.plane(channel)[i]));
        if shows_surface(planes.plane(3)[i]) { position.length() } else { 1e30 }
    };
    Ok((0..gbuffer.height() * gbuffer.width()).map(pixel).collect())
}
