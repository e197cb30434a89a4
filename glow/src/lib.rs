//! What keeps light and gives it back, after the thesis' chapter 8 (O. Nalbach, 2017), without a scene.
//!
//! A [`material::Material`] has states. A share `r` of each is excited: light fills it, and it empties at its
//! own rate, which is the light that is seen ([`rate`]). A [`paint::Paint`] is a material as images need it.
//!
//! Conventions: rates are per second, times in seconds, wavelengths in nanometres. What a spectrum has in a
//! band is its mean there; irradiance and radiance are relative, as the thesis' are (section 8.4.6), whose
//! excitation rates contain how wide a band is and how strong its lamp was.

pub mod file;
pub mod material;
pub mod paint;
pub mod rate;
pub mod spectrum;
