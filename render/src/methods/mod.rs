//! The analytic methods, one folder each: `mod.rs` says what it is, `passes.rs` runs on the GPU, `reference.rs` is the
//! slow, plain version that the GPU is checked against.

pub mod hbao;
