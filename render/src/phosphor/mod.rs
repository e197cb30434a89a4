//! Phosphorescence: light that a surface keeps and gives back, after the thesis' chapter 8 (O. Nalbach, 2017).
//!
//! A [`material::Material`] has states. A share `r` of each is excited: light fills it, and it empties at its own rate,
//! which is the light that is seen ([`rate`], [`simulation`]). What a material is can be measured ([`fit`]), or asked
//! for by how it should look ([`design`]). [`glassner`] is the rival: the same light as an integral over the past.
//!
//! Conventions: rates are per second, times in seconds, wavelengths in nanometres. What a spectrum has in a band is its
//! mean there; irradiance and radiance are relative, as the thesis' are (section 8.4.6), whose excitation rates contain
//! how wide a band is and how strong its lamp was.

pub mod design;
pub mod difference;
pub mod fit;
pub mod glassner;
mod least_squares;
pub mod material;
pub mod noise;
pub mod paint;
pub mod rate;
pub mod self_test;
pub mod simulation;
pub mod spectrum;
pub mod table;
