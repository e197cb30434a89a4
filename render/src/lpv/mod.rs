//! Light propagation volumes with multiple scattering, in plain Rust: the oracle of
//! `shaders/wgsl/methods/lpv`.
//!
//! Kaplanyan and Dachsbacher 2010, "Cascaded Light Propagation Volumes for Real-Time Indirect Illumination";
//! Billeter, Sintorn and Assarsson 2012, "Real-Time Multiple Scattering using Light Propagation Volumes". A
//! [`grid`] of cells holds light as energy and flux of three colours; each iteration takes it on to the 26
//! neighbours of a [`lattice`], spread over directions as a [`lobe`], through what [`blockers`] leave open,
//! and lets the medium on the way scatter it, as a [`flight`] says.

pub mod blockers;
pub mod cascade;
pub mod flight;
pub mod grid;
pub mod injection;
pub mod lattice;
pub mod lobe;
pub mod propagation;
pub mod scheme;
pub mod series;
pub mod sides;
pub mod sky;
pub mod studies;
#[cfg(test)]
mod tests;

pub use blockers::Blockers;
pub use flight::Flight;
pub use grid::LightGrid;
pub use propagation::{Light, Volume};
pub use scheme::Scheme;
