//! What light does: scenes, cameras, g-buffers, path-traced truth, analytic methods, and the metrics that
//! compare them.
//!
//! Data flows one way: scene, frame, method, image, comparison.

pub mod bvh;
pub mod exr_file;
pub mod gbuffer;
pub mod intersection;
pub mod lpv;
pub mod method;
pub mod methods;
pub mod metrics;
pub mod nearest;
pub mod past;
pub mod path;
mod processor;
pub mod raster;
pub mod sampler;
pub mod scene;
pub mod scotopic;
pub mod screen;
pub mod surfels;

pub use processor::processor_name;
