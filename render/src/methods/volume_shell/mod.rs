//! Light that surfaces throw into a medium: volume shell splatting.
//!
//! Nalbach, Ritschel and Seidel, "Deep Screen Space for Indirect Lighting of Volumes", VMV 2014 (thesis chapter 5).

pub mod intervals;
