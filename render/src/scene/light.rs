//! Lights without an extent. Emissive surfaces are materials.

use super::{Scene, SceneError, TextureId};
use glam::Vec3;
use std::fmt;

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
        /// Cosine of the half angle outside which there is none; below `cos_inner`.
        cos_outer: f32,
        /// A picture that the cone projects: multiplies the intensity, its inscribed circle is the outer
        /// cone.
        slide: Option<TextureId>,
    },
    /// Infinitely far away.
    Directional {
        /// Unit direction in which the light travels.
        direction: Vec3,
        /// Irradiance on a surface that faces it, W/m^2, RGB.
        irradiance: Vec3,
        /// A picture that multiplies the irradiance across the light's direction, like clouds, with the
        /// metres after which it repeats.
        pattern: Option<(TextureId, f32)>,
    },
}

/// Its kind, place and power in words.
impl fmt::Display for Light {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Point { position, intensity, .. } => {
                write!(f, "point at {position:.3} m, {intensity:.3} W/sr")
            }
            Self::Spot { position, direction, intensity, cos_outer, .. } => {
                let angle = cos_outer.acos().to_degrees();
                write!(
                    f,
                    "spot at {position:.3} m along {direction:.3}, {angle:.1} degrees, {intensity:.3} W/sr"
                )
            }
            Self::Directional { direction, irradiance, .. } => {
                write!(f, "directional along {direction:.3}, {irradiance:.3} W/m^2")
            }
        }
    }
}

impl Light {
    /// What keeps it from being a light.
    fn fault(&self) -> Option<&'static str> {
        let (power, place, range) = match *self {
            Self::Point { position, intensity, range } => (intensity, position, range),
            Self::Spot { position, direction, intensity, range, .. } => {
                (intensity, position + direction, range)
            }
            Self::Directional { direction, irradiance, .. } => (irradiance, direction, f32::INFINITY),
        };
        if !is_light(power) {
            return Some("its power is negative or not finite");
        }
        let axis = match *self {
            Self::Point { .. } => Vec3::X,
            Self::Spot { direction, .. } | Self::Directional { direction, .. } => direction,
        };
        if !place.is_finite() || !axis.is_normalized() {
            return Some("its place or direction is none");
        }
        let pattern_without_size = matches!(*self, Self::Directional { pattern: Some((_, size)), .. } if !(size.is_finite() && size > 0.0));
        if range.is_nan() || range <= 0.0 || pattern_without_size {
            return Some("its range or its pattern's size is not above 0");
        }
        match *self {
            Self::Spot { cos_inner, cos_outer, .. }
                if !(-1.0 <= cos_outer && cos_outer < cos_inner && cos_inner <= 1.0) =>
            {
                Some("its outer cone is not wider than its inner one")
            }
            _ => None,
        }
    }

    /// The same in another place and direction, of which it has what its kind has.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Vec3) -> Vec3, turned: impl Fn(Vec3) -> Vec3) -> Self {
        match &mut self {
            Self::Point { position, .. } => *position = to(*position),
            Self::Spot { position, direction, .. } => {
                (*position, *direction) = (to(*position), turned(*direction));
            }
            Self::Directional { direction, .. } => *direction = turned(*direction),
        }
        self
    }

    /// The same, brighter by a factor.
    #[must_use]
    pub fn brighter(mut self, factor: f32) -> Self {
        match &mut self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => *intensity *= factor,
            Self::Directional { irradiance, .. } => *irradiance *= factor,
        }
        self
    }

    /// Where it is, if it is anywhere.
    pub const fn position(&self) -> Option<Vec3> {
        match *self {
            Self::Point { position, .. } | Self::Spot { position, .. } => Some(position),
            Self::Directional { .. } => None,
        }
    }

    /// The unit direction in which it shines, if it has one.
    pub const fn direction(&self) -> Option<Vec3> {
        match *self {
            Self::Point { .. } => None,
            Self::Spot { direction, .. } | Self::Directional { direction, .. } => Some(direction),
        }
    }

    /// The picture that it projects.
    pub(crate) fn picture(&self) -> Option<TextureId> {
        match *self {
            Self::Point { .. } => None,
            Self::Spot { slide, .. } => slide,
            Self::Directional { pattern, .. } => pattern.map(|(texture, _)| texture),
        }
    }
}

impl Scene {
    /// Whether all lights and emissive materials shine with what light can be.
    ///
    /// # Errors
    /// Names the first light, by its index, or material that does not.
    pub fn check_lights(&self) -> Result<(), SceneError> {
        let invalid = |what: String| Err(SceneError::invalid(self.name.as_ref(), what));
        for (index, light) in self.lights.iter().enumerate() {
            if let Some(fault) = light.fault() {
                return invalid(format!("light {index}: {fault}"));
            }
            if let Some(texture) = light.picture().filter(|texture| !self.has_texture(*texture)) {
                return invalid(format!("light {index}: there is no texture {}", texture.0));
            }
        }
        match self.materials.iter().find(|material| !is_light(material.emission)) {
            Some(material) => {
                invalid(format!("material `{}` emits {}, not a radiance", material.name, material.emission))
            }
            None => Ok(()),
        }
    }
}

/// Whether three numbers can be an amount of light.
fn is_light(colour: Vec3) -> bool {
    colour.is_finite() && colour.min_element() >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Encoding, Material, Texture, Wrap};

    fn error(light: Light) -> String {
        let scene = Scene { name: "room".to_owned(), lights: vec![light], ..Scene::default() };
        scene.check_lights().expect_err("bad").to_string()
    }

    #[test]
    fn lights_that_cannot_be_are_refused_by_their_index() {
        let point = |intensity: Vec3, range: f32| Light::Point { position: Vec3::ZERO, intensity, range };
        for bad in [f32::NAN, f32::INFINITY, -1e-9] {
            let what = error(point(Vec3::new(1.0, bad, 1.0), 2.0));
            assert_eq!(what, "room: light 0: its power is negative or not finite");
        }
        assert!(error(point(Vec3::ONE, 0.0)).contains("range"));
        let sun = |direction: Vec3, size: f32| Light::Directional {
            direction,
            irradiance: Vec3::ONE,
            pattern: Some((TextureId(0), size)),
        };
        assert!(error(sun(Vec3::ZERO, 1.0)).contains("direction"));
        assert!(error(sun(Vec3::X, 0.0)).contains("pattern"));
        assert_eq!(error(sun(Vec3::X, 1.0)), "room: light 0: there is no texture 0");
        let lights = vec![point(Vec3::ONE, f32::INFINITY), sun(Vec3::X, 1.0)];
        let texture = Texture::new(1, 1, vec![[255; 4]], Encoding::Linear, [Wrap::Clamp; 2]);
        let sound = Scene { lights, textures: vec![texture.into()], ..Scene::default() };
        assert!(sound.check_lights().is_ok());
    }

    #[test]
    fn spots_that_cannot_be_are_refused() {
        let spot = |cos_inner: f32, cos_outer: f32, slide: Option<TextureId>| Light::Spot {
            position: Vec3::ZERO,
            direction: Vec3::X,
            intensity: Vec3::ONE,
            range: 2.0,
            cos_inner,
            cos_outer,
            slide,
        };
        for [inner, outer] in
            [[0.5, 0.5], [0.4, 0.5], [1.1, 0.5], [0.5, -1.1], [f32::NAN, 0.5], [0.5, f32::NAN]]
        {
            assert!(error(spot(inner, outer, None)).contains("outer cone"), "{inner} and {outer}");
        }
        assert_eq!(error(spot(0.9, 0.8, Some(TextureId(3)))), "room: light 0: there is no texture 3");
        let sound = Scene { lights: vec![spot(1.0, -1.0, None)], ..Scene::default() };
        assert!(sound.check_lights().is_ok());
    }

    #[test]
    fn materials_that_emit_no_light_are_refused_by_name() {
        let lamp = Material { name: "lamp".to_owned(), emission: Vec3::NEG_ONE, ..Material::default() };
        let scene = Scene { name: "room".to_owned(), materials: vec![lamp], ..Scene::default() };
        let what = scene.check_lights().expect_err("bad").to_string();
        assert!(what.starts_with("room: material `lamp` emits"), "{what}");
    }
}
