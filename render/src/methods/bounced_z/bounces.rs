//! Light of the environment that surfaces reflect before it arrives: a surfel that a pixel's ray meets
//! reflects what comes from a random direction, found in the same way. The filter averages the noise of
//! these paths with that of the directions. Light of lamps is not followed so: what they light brightly is
//! small, and few paths find it.

mod reference;

pub use reference::light_of_path;

use super::passes::TracedRays;
use crate::raster::groups;
use crate::screen::{MethodStep, Resources};
use crate::surfels::Cloud;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::Shader;

/// Most surfels of a path. In a closed room that reflects half of what falls on it, a quarter of the
/// reflected light is missing.
pub const BOUNCES: u32 = 2;

/// The pass that follows paths from what rays have met, and puts what arrives along them in its place.
///
/// # Errors
/// If the device has no room or refuses the pass.
pub fn step(
    traced: &TracedRays<'_>,
    cloud: &Cloud,
    [bounces, view, sky]: [&wgpu::Buffer; 3],
    to: &Resources<'_>,
) -> Result<MethodStep, GpuError> {
    let Cloud { totals, surfels, nodes, patches, starts, .. } = cloud;
    let bounce = to.device.pass(Shader::at("methods/bounced-z/bounce"), &[("BOUNCES", BOUNCES)])?;
    let reads = [bounces, view, totals, surfels, nodes, patches, starts, sky];
    MethodStep::bind(to.device, &bounce, groups(traced.count), &reads, &[&traced.met])
}
