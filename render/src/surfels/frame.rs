//! Everything that lays out a frame's surfels, in order: the surfels, their light where it is wanted, their tree.

use super::cloud::{self, Cloud};
use super::light::{self, Lit};
use super::{HEIGHT, Parameters, Passes};
use crate::raster::World;
use crate::raster::view::perspective;
use crate::screen::{MethodStep, View};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;

/// Uniform buffers that the passes read: surfels, view, levels of the tree.
pub const UNIFORMS: usize = 2 + HEIGHT as usize;

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &Parameters, view: &View) -> impl Iterator<Item = Vec<u8>> {
    let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
    let first = [bytes_of(&parameters.settings(view)).to_vec(), bytes_of(&camera).to_vec()];
    first.into_iter().chain(cloud::tree_levels().map(|level| bytes_of(&level).to_vec()))
}

/// The scene of a method that looks beyond the screen.
///
/// # Errors
/// If there is none.
pub fn scene(world: Option<&World>) -> Result<&World, GpuError> {
    let missing = || GpuError::Refused {
        label: "deepshade.scene".to_owned(),
        what: "there is no scene whose surface a method could read".to_owned(),
    };
    world.ok_or_else(missing)
}

/// The surfels of a scene, and the passes that lay them out; `uniforms` are the [`UNIFORMS`].
///
/// # Errors
/// If there is no scene, or the device has no room.
pub fn steps(
    passes: &Passes,
    device: &wgpu::Device,
    world: Option<&World>,
    uniforms: &[wgpu::Buffer],
    lit: Option<Lit>,
) -> Result<(Cloud, Vec<MethodStep>), GpuError> {
    let world = scene(world)?;
    let [settings, view, tree @ ..] = uniforms else { unreachable!("surfels and view come first") };
    let cloud = Cloud::new(device, world, lit)?;
    let uniforms = cloud::Uniforms { settings, view };
    let mut steps = passes.surfel_steps(device, world, &cloud, uniforms)?;
    if let (Some(lit), Some(sent)) = (lit, &cloud.sent) {
        steps.extend(light::steps(device, world, lit, &cloud, [view, sent])?);
    }
    steps.extend(passes.tree_steps(device, &cloud, tree)?);
    Ok((cloud, steps))
}
