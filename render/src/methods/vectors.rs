//! Arithmetic on neighbouring pixels in vector instructions, for methods that have a version for the
//! processor.

mod lanes;
mod random;

pub use lanes::{Lanes, Mask, Words};
pub use random::{random, random_row};
