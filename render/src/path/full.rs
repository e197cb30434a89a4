//! Truth for full path tracing: all light that reaches a pixel, radiance, through the camera's lens. Where
//! nothing is seen, the environment. Fog effects are the light of one [`Route`] of it.

use super::route::Route;
use super::transport::Transport;
use super::{Integrator, LightPart, Shot};
use crate::sampler::Stream;
use glam::{Vec2, Vec3};

/// Path-traced radiance, with any number of bounces.
#[derive(Debug)]
pub struct FullPath<'a> {
    shot: Shot<'a>,
    transport: Transport<'a>,
}

impl<'a> FullPath<'a> {
    /// All light; the shot's radius does not matter.
    pub fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot, transport: Transport::new(shot.scene) }
    }

    /// Light that took a route.
    pub fn along(route: Route, shot: &Shot<'a>) -> Self {
        Self { shot: *shot, transport: Transport::new(shot.scene).with_route(route) }
    }
}

impl Integrator for FullPath<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let Shot { camera, height, width, .. } = self.shot;
        let on_lens = if camera.lens.is_some() { stream.next_2d() } else { Vec2::ZERO };
        let (origin, direction) = camera.ray(at, height, width, on_lens);
        let split = |stream| self.transport.split(origin, direction, stream);
        match self.shot.part {
            LightPart::Emitted => split(stream).emitted,
            LightPart::Direct => split(stream).direct,
            LightPart::FirstIndirect => split(stream).first_indirect,
            LightPart::Rest => split(stream).rest,
            LightPart::All => self.transport.radiance(origin, direction, stream),
        }
    }
}
