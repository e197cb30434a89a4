//! Phosphorescent materials measured and designed, after the thesis' chapter 8 (O. Nalbach, 2017).
//! `deepshade-glow` says what they are, its conventions hold here.
//!
//! What a material is can be measured ([`fit`]), or asked for by how it should look ([`design`]);
//! [`wish`] is that for one place, by key frames that are set by hand. [`self_test`] says whether fits can be
//! believed. [`simulation`] is a material at one place through time.
//! [`particles`] makes scene files of simulated particles that glow.

pub mod curves;
pub mod design;
pub mod difference;
pub mod fit;
mod least_squares;
pub mod noise;
pub mod particles;
pub mod self_test;
pub mod simulation;
pub mod table;
pub mod wish;
