//! The GPU side of a frame: what a scene shows, rasterised. Vertices are posed, the g-buffer is drawn, shadow maps are drawn
//! from the lights, and direct light is gathered; methods go on from there.
//!
//! - [`world`] is the scene on the GPU, whoever looks at it.
//! - [`geometry`] holds the vertices and [`pose`] moves those that are animated.
//! - [`surface`] draws the nearest surface of each pixel into eight words, which [`attributes`] spreads over the planes of
//!   a [`GpuGBuffer`](crate::screen::GpuGBuffer): the same channels as those of [`crate::gbuffer`], which traces rays.
//! - [`shadow`] draws the lights' maps, [`light`] gathers what they send, [`reflective`] what a light's rays meet.
//! - [`glow`] holds what surfaces keep light of, and the time that passes.
//! - [`since`] says how far surfaces moved since the frame before.
//! - [`frame`] is all of it in order.

pub mod attributes;
pub mod frame;
pub mod geometry;
pub mod glow;
pub mod light;
pub mod material;
pub mod medium;
pub mod pose;
pub mod reflective;
pub mod shadow;
pub mod since;
pub mod stage;
pub mod surface;
#[cfg(test)]
mod tests;
pub mod texture;
pub mod view;
pub mod world;

pub use frame::Frame;
pub use world::World;
