//! Directional occlusion by surfels (thesis 4.3): the environment's irradiance less what surfels block of it.

use super::around::Ending;
use super::{SurfelParameters, passes::Shading, reference};
use crate::methods::disks::{DiskEffect, Plain, SURFACE};
use crate::methods::environment_map::EnvironmentMap;
use crate::methods::prefiltered::filter;
use crate::scene::{Camera, Environment};
use crate::surfels::Tree;
use crate::surfels::reference::Disk;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Effect, MissingAttribute, Planes};
use glam::Vec3;

/// Rows of the map that says what a surfel hides: as coarse as the solid angle of those that matter.
const BLOCKED_HEIGHT: usize = 16;

/// The effect `do`.
pub const DIRECTIONAL: DiskEffect<SurfelParameters> = DiskEffect {
    effect: Effect::Do,
    attributes: SURFACE,
    lit: None,
    passes: Shading {
        tree: Tree::All,
        splat: Shader::at("methods/surfel/blocked"),
        add: Shader::at("methods/surfel/indirect"),
        channels: 3,
        ending: Ending::Open,
    },
    plain,
    on_processor: None,
};

/// What surfaces and surfels look up of an environment.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Means of its radiance.
    pub blocked: EnvironmentMap,
    /// Irradiance over pi for every normal.
    pub open: EnvironmentMap,
}

impl Sky {
    /// Of an environment; black without one.
    pub fn new(environment: Option<&Environment>) -> Self {
        let black = Environment::uniform(Vec3::ZERO);
        let environment = environment.unwrap_or(&black);
        Self { blocked: EnvironmentMap::new(environment, BLOCKED_HEIGHT), open: filter::diffuse(environment) }
    }

    /// Both maps on the GPU.
    ///
    /// # Errors
    /// If it has no room.
    pub fn upload(&self, device: &wgpu::Device) -> Result<[wgpu::Buffer; 2], GpuError> {
        let upload = |label, map: &EnvironmentMap| {
            gpu::storage(device, label, &map.padded().collect::<Vec<[f32; 4]>>())
        };
        Ok([upload("surfel.blocked", &self.blocked)?, upload("surfel.open", &self.open)?])
    }

    /// What a disk hides of it, irradiance over pi, as [`reference::Shade::of`] is given it.
    pub fn behind(&self, camera: &Camera, disk: &Disk, way: Vec3, normal: Vec3) -> Vec3 {
        let share = reference::form_factor(way, normal, disk);
        if share == 0.0 {
            Vec3::ZERO
        } else {
            share * self.blocked.radiance(camera.rotation * way.normalize())
        }
    }
}

/// The image in plain Rust.
fn plain(plain: &Plain<'_, SurfelParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    let (sky, camera) = (Sky::new(plain.environment), &plain.view.camera);
    let hides = |disk: &Disk, _, way, receiver: reference::Receiver| {
        sky.behind(camera, disk, way, receiver.normal).to_array()
    };
    let shade = reference::Shade { reach: &|_| f32::INFINITY, of: &hides };
    let blocked = reference::sums(plain.surface, disks, shade, plain.parameters, plain.view);
    Ok(plain.surface.image(0.0, |at| {
        let hidden = Vec3::from_array(std::array::from_fn(|c| blocked.at(c, at.y as usize, at.x as usize)));
        let open = sky.open.radiance(camera.rotation * plain.surface.normal_at(at));
        (open - hidden).max(Vec3::ZERO).to_array()
    }))
}
