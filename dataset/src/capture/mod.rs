//! Captures: aligned colour and depth images of a real camera, with what the camera was and, where known, where it stood.

pub mod error;
pub mod intrinsics;
pub mod surface;

pub use error::CaptureError;
pub use intrinsics::Intrinsics;
pub use surface::surface;
