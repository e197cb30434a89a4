//! A Bevy app without a window, and what deepshade makes of the same frames.

pub mod cameras;
pub mod clock;
pub mod frame;
pub mod glb;
pub mod headless;
pub mod lens;
pub mod lens_clock;
pub mod own;
pub mod pictures;
pub mod reading;
pub mod types;
