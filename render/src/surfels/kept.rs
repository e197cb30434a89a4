//! Light that surfaces kept, as surfels send it: each patch has states of its own, which one pass moves on
//! every frame under the lamps' shadow maps, and surfels give back what their patches keep (thesis 8.5).
//!
//! What surfels send is packed, and packed radiance has few bits below 2^-15 W/m²/sr and none below 2^-24. So
//! it is in a unit that the scene's paints tell: full states give back at most 2^15 of it. Nine bits are left
//! after a decay to 2^-30 of that. The image is brought to W/m²/sr at its end.

use super::cloud::{Cloud, SURFEL_GROUPS};
use crate::raster::World;
use crate::raster::glow::{Keeping, keeper_words};
use crate::raster::groups;
use crate::scene::Glow;
use crate::screen::{Device, MethodStep, Workgroups};
use deepshade_glow::paint::{MOST_STATES, PaintFactors};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// The power of two that what surfels give back has at most.
const FULL: f32 = 15.0;

/// The passes that move states on through all of the past that a frame shows, and write what surfels send,
/// `[surfels, 2]` u32.
///
/// # Errors
/// If the device refuses, or has no room.
pub fn steps(
    device: &Device,
    world: &World,
    cloud: &Cloud,
    sent: &wgpu::Buffer,
) -> Result<Vec<MethodStep>, GpuError> {
    let paints = world.patch_paints();
    // A binding holds at least one.
    let count = paints.len().max(1);
    let words = |(paint, factors): (Option<usize>, Option<PaintFactors>)| {
        keeper_words(world.glow.glow(), paint.map_or(0, |paint| paint as u32 + 1), move || factors)
    };
    let mut painted: Vec<u32> = paints.into_iter().flat_map(words).collect();
    painted.resize(count * world.glow.words().1 as usize, 0);
    let numbers = 2 * count * world.glow.states();
    let states = gpu::empty::<f32>(device, "surfels.states", numbers)?;
    let painted_there = gpu::storage(device, "surfels.painted", &painted)?;
    let keeping = Keeping {
        euler: 0,
        shaders: [Shader::at("surfels/keep"), Shader::at("surfels/keep_dimmed")],
        keepers: [&cloud.patches, &painted_there],
        count,
        states: &states,
    };
    let poses = world.poses().map(|pose| keeping.steps(device, pose));
    let mut steps = poses.collect::<Result<Vec<_>, _>>()?.concat();
    let unit = unit(world.glow.glow());
    let constants =
        [("STATES", world.glow.states() as u32), world.glow.paint_states(), world.glow.words(), unit];
    let pass = device.pass(Shader::at("surfels/give_back"), &constants)?;
    let reads = [&world.glow.paints, &painted_there, &cloud.starts, &cloud.totals, &cloud.surfels, &states];
    let groups = Workgroups::Counted(cloud.totals.clone(), SURFEL_GROUPS);
    steps.push(MethodStep::bind(device, &pass, groups, &reads, &[sent])?);
    Ok(steps)
}

/// The pass that brings an image of what surfels send, `[3, height, width]`, to W/m²/sr.
///
/// # Errors
/// If the device refuses.
pub fn in_watts(device: &Device, world: &World, image: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
    let pass = device.pass(Shader::at("surfels/in_watts"), &[unit(world.glow.glow())])?;
    let values = (image.size() / 4) as usize;
    MethodStep::bind(device, &pass, groups(values), &[], &[image])
}

/// The powers of two of what surfels give back that make a W/m²/sr, and 128 more, by the brightest that a
/// surface can be.
pub fn unit(glow: &Glow) -> (&'static str, u32) {
    let full = glow.surfaces.iter().map(|surface| surface.paint.emission(&[1.0; MOST_STATES]).max_element());
    let brightest = full.fold(0.0, f32::max);
    // Of nothing, and of what is no number, any unit will do.
    let powers = if brightest > 0.0 { FULL - brightest.log2().ceil() } else { 0.0 };
    ("UNIT", (powers.clamp(-100.0, 100.0) + 128.0) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::glow::tests::glow;

    #[test]
    fn full_states_are_as_bright_as_packed_radiance_is_sure_to_hold() {
        for scale in [1e-20, 1e-6, 0.3, 1.0, 7.0, 1e9] {
            let mut glow = glow(&[1.0, 0.5], &[], 0.0);
            glow.surfaces[0].paint.states.iter_mut().for_each(|state| state.emission *= scale);
            let (_, unit) = unit(&glow);
            let brightest = 1.5 * scale * (unit as f32 - 128.0).exp2();
            assert!((16_384.0..=32_768.0).contains(&brightest), "{scale}: {brightest}");
        }
        let mut dark = glow(&[1.0], &[], 0.0);
        dark.surfaces[0].paint.states[0].emission = glam::Vec3::ZERO;
        assert_eq!(unit(&dark), ("UNIT", 128));
    }
}
