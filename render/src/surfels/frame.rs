//! Everything that lays out a frame's surfels, in order: the surfels, their light where it is wanted, their
//! tree.

use super::cloud::{self, Cloud, Tree};
use super::light::{self, SurfelLight};
use super::{HEIGHT, SurfelDensity};
use crate::raster::World;
use crate::screen::{Device, MethodStep, View};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;

/// Uniform buffers that the passes read: surfels, view, levels of the tree.
pub const UNIFORMS: usize = 2 + HEIGHT as usize;

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &SurfelDensity, view: &View) -> impl Iterator<Item = Vec<u8>> {
    let first = [bytes_of(&parameters.settings(view)).to_vec(), bytes_of(&view.perspective()).to_vec()];
    first.into_iter().chain(cloud::tree_levels().map(|level| bytes_of(&level).to_vec()))
}

/// The surfels of a scene, and the passes that lay them out, light them and put a tree over those that
/// matter; `uniforms` are the [`UNIFORMS`].
///
/// # Errors
/// If the device has no room, or refuses a pass.
pub fn steps(
    device: &Device,
    world: &World,
    uniforms: &[wgpu::Buffer],
    tree: Tree,
    lit: Option<SurfelLight>,
) -> Result<(Cloud, Vec<MethodStep>), GpuError> {
    let [settings, view, levels @ ..] = uniforms else { unreachable!("surfels and view come first") };
    let cloud = Cloud::new(device, world, lit)?;
    let mut steps = cloud.surfel_steps(device, world, cloud::Uniforms { settings, view })?;
    if let (Some(lit), Some(sent)) = (lit, &cloud.sent) {
        steps.extend(light::steps(device, world, lit, &cloud, [view, sent])?);
    }
    steps.extend(cloud.tree_steps(device, tree, levels)?);
    Ok((cloud, steps))
}
