//! The GPU side of a frame: what a scene shows, rasterised. Vertices are posed, the g-buffer is drawn, shadow
//! maps are drawn from the lights, and direct light is gathered; methods go on from there.
//!
//! - [`world`] is the scene on the GPU, whoever looks at it.
//! - [`geometry`] holds the vertices and [`pose`] moves those that are animated.
//! - [`surface`] draws the nearest surface of each pixel into eight words, which [`attributes`] spreads over
//!   the planes of a [`GpuGBuffer`](crate::screen::GpuGBuffer): the same channels as those of
//!   [`crate::gbuffer`], which traces rays.
//! - [`shadow`] draws the lights' maps, [`light`] gathers what they send, [`reflective`] what a light's rays
//!   meet.
//! - [`patches`] cuts a scene's surface into parts, once, which surfels and volumes are made of.
//! - [`glow`] holds what surfaces keep light of, and the time that passes.
//! - [`since`] says how far surfaces moved since the frame before.
//! - [`frame`] is all of it in order.

pub mod attributes;
pub mod frame;
pub mod frame_stage;
pub mod geometry;
pub mod glow;
pub mod light;
pub mod material;
pub mod medium;
pub mod patches;
pub mod pose;
pub mod reflective;
pub mod shadow;
pub mod since;
pub mod surface;
#[cfg(test)]
mod tests;
pub mod texture;
pub mod view;
pub mod world;

pub use frame::Frame;
pub use world::World;

/// Invocations of a workgroup of passes over vertices, patches, surfels and texels.
const WORKGROUP: u32 = 64;
/// Most workgroups along an axis that every device has.
const MOST_GROUPS: u32 = 65_535;

/// Workgroups of so many invocations at least, in two dimensions where one is not enough.
pub(crate) fn groups(invocations: usize) -> [u32; 3] {
    let groups = (invocations as u32).div_ceil(WORKGROUP);
    [groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1]
}
