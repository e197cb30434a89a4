//! Truth for the three fog effects: light that met the medium on its way, by what else it met. They are disjoint and
//! add up to all such light:
//!
//! - `fog-direct`: light, medium, eye: single scattering.
//! - `fog-indirect`: light, surface, medium, eye.
//! - `fog-multiple`: every other path with a vertex in the medium, such as surfaces that scattered light shines on.
//!
//! All three are [`Transport`], which knows the [`Route`] of each path, kept to one of them. Emissive surfaces and the
//! environment are lights here like others: a path that ends there has met neither. The medium dims light on all
//! pieces of a path, those between surfaces and to the lights too. Light that met no medium vertex, dimmed, is in no
//! fog effect, only in `path`: [`Route::Surfaces`].

use super::route::Route;
use super::sampler::Stream;
use super::transport::Transport;
use super::{Integrator, Shot};
use glam::{Vec2, Vec3};

/// Path-traced light of one route, radiance, through the camera's lens.
#[derive(Debug)]
pub struct Fog<'a> {
    shot: Shot<'a>,
    transport: Transport<'a>,
}

impl<'a> Fog<'a> {
    /// `fog-direct`.
    pub fn direct(shot: &Shot<'a>) -> Self {
        Self::along(Route::Direct, shot)
    }

    /// `fog-indirect`.
    pub fn indirect(shot: &Shot<'a>) -> Self {
        Self::along(Route::Indirect, shot)
    }

    /// `fog-multiple`.
    pub fn multiple(shot: &Shot<'a>) -> Self {
        Self::along(Route::Multiple, shot)
    }

    fn along(route: Route, shot: &Shot<'a>) -> Self {
        Self { shot: *shot, transport: Transport::new(shot.scene).with_route(route) }
    }
}

impl Integrator for Fog<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { camera, height, width, .. } = self.shot;
        let on_lens = if camera.lens.is_some() { stream.next_2d() } else { Vec2::ZERO };
        let (origin, direction) = camera.ray(at, height, width, on_lens);
        self.transport.radiance(origin, direction, stream)
    }
}

#[cfg(test)]
mod tests;
