//! deepshade: learned, analytic and path-traced screen-space shading side by side.
//!
//! The program is all of this. It is a library so that studies (`studies/`) can use the same parts:
//! [`shared`] has them. Whoever wants networks or methods in a program of their own takes the crates below,
//! such as [`deepshade_infer`] and [`deepshade_render`].

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "a web page has no command line")
)]

#[macro_use]
pub mod output;

mod arguments;
mod bench;
mod command_line;
mod compare;
mod complete;
mod dataset;
mod demo;
mod engine;
mod eval;
#[cfg(feature = "train")]
mod export;
mod exposure_time;
mod farm;
mod figures;
mod infer;
mod interrupt;
mod kernels;
mod learned;
mod live;
mod location;
mod methods;
#[cfg(feature = "train")]
mod onnxruntime;
mod parameters;
#[cfg(feature = "train")]
mod parity;
mod phosphor;
mod plot;
mod props;
mod radius;
mod render;
mod report;
#[cfg(feature = "train")]
mod room_frame;
mod samples;
mod scene;
pub mod shared;
mod statistics;
#[cfg(feature = "store")]
mod store;
mod table;
#[cfg(feature = "train")]
mod train;
mod tune;
#[cfg(feature = "view")]
mod view;
mod views;
mod web;

pub use command_line::main;
