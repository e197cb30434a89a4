//! Scene files: real ones load with the triangles that are in them, small ones give what can be worked out by
//! hand, and damaged ones give errors that name the damage.

mod build;
mod compressed;
mod damaged;
mod data;
mod environment;
mod fuzz;
mod glowing;
mod ktx2;
mod layers;
mod malformed;
mod moving;
mod obj;
mod on_gpu;
mod on_stage;
mod posed;
#[path = "../real_data/mod.rs"]
mod real_data;
mod shaded;
mod shapes;
mod since;
mod surfels;
mod tolerated;
