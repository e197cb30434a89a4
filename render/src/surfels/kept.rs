//! Light that surfaces kept, as surfels send it: each patch has states of its own, which one pass moves on every frame under the
//! lamps' shadow maps, and surfels give back what their patches keep (thesis 8.5).

use super::cloud::{Cloud, SURFEL_GROUPS};
use crate::raster::World;
use crate::raster::glow::Keeping;
use crate::screen::{MethodStep, Workgroups};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl;

/// The passes that move states on through all of the past that a frame shows, and write what surfels send, `[surfels, 2]` u32.
///
/// # Errors
/// If the device refuses, or has no room.
pub fn steps(
    device: &wgpu::Device,
    world: &World,
    cloud: &Cloud,
    sent: &wgpu::Buffer,
) -> Result<Vec<MethodStep>, GpuError> {
    let mut painted: Vec<u32> =
        world.patch_paints().into_iter().map(|paint| paint.map_or(0, |paint| paint as u32 + 1)).collect();
    // A binding holds at least one.
    painted.resize(painted.len().max(1), 0);
    let numbers = 2 * painted.len() * world.glow.states();
    let states = gpu::empty::<f32>(device, "surfels.states", numbers)?;
    let painted_there = gpu::storage(device, "surfels.painted", &painted)?;
    let keeping = Keeping {
        shaders: [&wgsl::SURFELS_KEEP, &wgsl::SURFELS_KEEP_DIMMED],
        keepers: [&cloud.patches, &painted_there],
        count: painted.len(),
        states: &states,
    };
    let poses = world.poses().map(|pose| keeping.step(device, pose));
    let mut steps = poses.collect::<Result<Vec<_>, _>>()?;
    let constants = [("STATES", world.glow.states() as u32), world.glow.paint_states()];
    let source = wgsl::SURFELS_GIVE_BACK.specialised(&constants);
    let pass = Pass::new(device, wgsl::SURFELS_GIVE_BACK.name, &source)?;
    let reads = [&world.glow.paints, &painted_there, &cloud.starts, &cloud.totals, &cloud.surfels, &states];
    let groups = Workgroups::Counted(cloud.totals.clone(), SURFEL_GROUPS);
    steps.push(MethodStep::bind(device, &pass, groups, &reads, &[sent])?);
    Ok(steps)
}
