//! Truth for the three fog effects: light that met the medium on its way, by what else it met. They are
//! disjoint and add up to all such light:
//!
//! - `fog-direct`: light, medium, eye: single scattering.
//! - `fog-indirect`: light, surface, medium, eye.
//! - `fog-multiple`: every other path with a vertex in the medium, such as surfaces that scattered light
//!   shines on.
//!
//! All three are [`Transport`](super::transport::Transport), which knows the [`Route`] of each path, kept to
//! one of them, and radiance through the camera's lens. Emissive surfaces and the environment are lights here
//! like others: a path that ends there has met neither. The medium dims light on all pieces of a path, those
//! between surfaces and to the lights too. Light that met no medium vertex, dimmed, is in no fog effect, only
//! in `path`: [`Route::Surfaces`].

use super::Shot;
use super::full::FullPath;
use super::route::Route;

/// `fog-direct`.
pub fn direct<'a>(shot: &Shot<'a>) -> FullPath<'a> {
    FullPath::along(Route::Direct, shot)
}

/// `fog-indirect`.
pub fn indirect<'a>(shot: &Shot<'a>) -> FullPath<'a> {
    FullPath::along(Route::Indirect, shot)
}

/// `fog-multiple`.
pub fn multiple<'a>(shot: &Shot<'a>) -> FullPath<'a> {
    FullPath::along(Route::Multiple, shot)
}

#[cfg(test)]
mod tests;
