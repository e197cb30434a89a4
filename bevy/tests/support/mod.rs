//! A Bevy app without a window, and what deepshade makes of the same frames.

pub mod clock;
pub mod frame;
pub mod glb;
pub mod headless;
pub mod own;
pub mod pictures;
pub mod reading;
pub mod types;
