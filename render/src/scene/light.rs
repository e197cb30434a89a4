//! Lights without an extent. Emissive surfaces are materials.

use super::TextureId;
use glam::Vec3;

/// A light without an extent, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines alike in all directions.
    Point {
        /// Where it is.
        position: Vec3,
        /// Radiant intensity, W/sr, RGB.
        intensity: Vec3,
        /// Distance at which the light ends, metres; infinite for one that does not.
        range: f32,
    },
    /// Shines into a cone.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Unit axis of the cone, away from the light.
        direction: Vec3,
        /// Radiant intensity on the axis, W/sr, RGB.
        intensity: Vec3,
        /// Distance at which the light ends, metres; infinite for one that does not.
        range: f32,
        /// Cosine of the half angle inside which the light is full.
        cos_inner: f32,
        /// Cosine of the half angle outside which there is none.
        cos_outer: f32,
        /// A picture that the cone projects: multiplies the intensity, its inscribed circle is the outer cone.
        slide: Option<TextureId>,
    },
    /// Infinitely far away.
    Directional {
        /// Unit direction in which the light travels.
        direction: Vec3,
        /// Irradiance on a surface that faces it, W/m^2, RGB.
        irradiance: Vec3,
        /// A picture that multiplies the irradiance across the light's direction, like clouds, with the metres after
        /// which it repeats.
        pattern: Option<(TextureId, f32)>,
    },
}
