//! A light without an extent as those see it who integrate along its rays: where rays come from, and what
//! varies from one to the other.

use crate::path::lights::Arrival;
use crate::scene::{Light, Scene};
use glam::Vec3;

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampPosition {
    /// Infinitely far away, in a unit direction.
    Distant(Vec3),
    /// From a point, world space, metres.
    Local(Vec3),
}

/// A light, taken apart.
#[derive(Clone, Copy, Debug)]
pub struct Lamp<'a> {
    scene: &'a Scene,
    /// The light with a power of 1 in every colour and no end.
    unit: Light,
    /// Where it is.
    pub position: LampPosition,
    /// Irradiance, W/m^2, of a distant light, intensity, W/sr, of others, RGB; [`Lamp::tint`] not counted.
    pub power: Vec3,
    /// Where the light ends, metres from it.
    pub range: f32,
}

impl<'a> Lamp<'a> {
    /// One of a scene's lights.
    pub fn new(scene: &'a Scene, light: &Light) -> Self {
        let mut unit = *light;
        let (position, power, range) = match &mut unit {
            Light::Point { position, intensity, range } | Light::Spot { position, intensity, range, .. } => (
                LampPosition::Local(*position),
                std::mem::replace(intensity, Vec3::ONE),
                std::mem::replace(range, f32::INFINITY),
            ),
            Light::Directional { direction, irradiance, .. } => {
                (LampPosition::Distant(-*direction), std::mem::replace(irradiance, Vec3::ONE), f32::INFINITY)
            }
        };
        Self { scene, unit, position, power, range }
    }

    /// Whether it is infinitely far away.
    pub const fn is_distant(&self) -> bool {
        matches!(self.position, LampPosition::Distant(_))
    }

    /// Whether all of its rays are alike.
    pub const fn is_even(&self) -> bool {
        matches!(self.unit, Light::Point { .. } | Light::Directional { pattern: None, .. })
    }

    /// Whether its rays differ in colour.
    pub const fn is_coloured(&self) -> bool {
        matches!(self.unit, Light::Spot { slide: Some(_), .. } | Light::Directional { pattern: Some(_), .. })
    }

    /// By what the power of the ray through a point is multiplied: cones and pictures.
    pub fn tint(&self, point: Vec3) -> Vec3 {
        match self.position {
            LampPosition::Distant(_) => Arrival::new(self.scene, &self.unit, point).irradiance,
            LampPosition::Local(position) => {
                let away = (point - position).normalize_or(Vec3::Y);
                Arrival::new(self.scene, &self.unit, position + away).irradiance
            }
        }
    }

    /// What is left so many metres from the light of what the inverse square leaves (KHR_lights_punctual).
    pub fn fade(&self, distance: f32) -> f32 {
        (1.0 - (distance / self.range).powi(4)).clamp(0.0, 1.0)
    }

    /// The axis of a spot and the cosine of the half angle that it lights.
    pub const fn cone(&self) -> Option<(Vec3, f32)> {
        match self.unit {
            Light::Spot { direction, cos_outer, .. } => Some((direction, cos_outer)),
            _ => None,
        }
    }
}
