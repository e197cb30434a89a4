//! What a light without an extent sends to a point: intensity over squared distance, cones, ranges, and the
//! pictures that lights project.
//!
//! A picture's up is the world's y, or z where the light travels along y to 0.999; its right is to the right
//! for somebody who stands at the light and looks along its direction, as through a camera. A spot's slide is
//! projected in perspective, and the outer cone is the circle in its square; cones wider than 89 degrees to a
//! side take what fills that one. A directional light's pattern is projected in parallel, its top left corner
//! at the world's origin. Slides end at their edges and patterns begin again, whatever their textures do
//! elsewhere.

use crate::scene::{Light, Scene, TextureId, Wrap};
use glam::{Vec2, Vec3};

/// Light that reaches a point if nothing is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// How far away it is, metres, or just before, so that a ray of that length does not meet what the light
    /// hangs on; infinite for directional lights.
    pub distance: f32,
    /// On a surface that faces the light, W/m^2, RGB.
    pub irradiance: Vec3,
}

/// Nearer lights than this, metres, count as that far away.
const LEAST_DISTANCE: f32 = 1e-6;

/// Where rays to a light end, in parts of their way: 67 roundings of 6e-8 before it, of which the ray's
/// direction and the distance at which it meets a triangle make fewer than 20.
const JUST_BEFORE: f32 = 1.0 - 4e-6;

/// Cosine of the widest half angle that a slide is spread over: 89 degrees.
const WIDEST_SLIDE: f32 = 0.017_452_4;

impl Arrival {
    /// From one of a scene's lights.
    pub fn new(scene: &Scene, light: &Light, point: Vec3) -> Self {
        match *light {
            Light::Point { position, intensity, range } => {
                Self::from_position(position, intensity, range, point)
            }
            Light::Spot { position, direction, intensity, range, cos_inner, cos_outer, slide } => {
                let arrival = Self::from_position(position, intensity, range, point);
                let cone = cone(-arrival.direction.dot(direction), cos_inner, cos_outer);
                let tint = match slide {
                    Some(slide) if cone > 0.0 => {
                        projected(scene, slide, direction, cos_outer, -arrival.direction)
                    }
                    _ => Vec3::ONE,
                };
                Self { irradiance: arrival.irradiance * cone * tint, ..arrival }
            }
            Light::Directional { direction, irradiance, pattern } => {
                let tint = pattern.map_or(Vec3::ONE, |(texture, size)| {
                    let [right, up] = axes(direction);
                    let uv = Vec2::new(right.dot(point), -up.dot(point)) / size;
                    picture(scene, texture, uv, Wrap::Repeat)
                });
                Self { direction: -direction, distance: f32::INFINITY, irradiance: irradiance * tint }
            }
        }
    }

    /// The inverse square, faded out towards the light's range as KHR_lights_punctual recommends.
    fn from_position(position: Vec3, intensity: Vec3, range: f32, point: Vec3) -> Self {
        let to_light = position - point;
        let distance = to_light.length().max(LEAST_DISTANCE);
        let fade = (1.0 - (distance / range).powi(4)).clamp(0.0, 1.0);
        let irradiance = intensity * fade / (distance * distance);
        Self { direction: to_light / distance, distance: distance * JUST_BEFORE, irradiance }
    }
}

/// How much of a spot's intensity goes in a direction, by its cosine to the axis. KHR_lights_punctual: linear
/// in the cosine between the cones, of which the outer one is the wider ([`Scene::check_lights`]), then
/// squared.
fn cone(cosine: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let inside = ((cosine - cos_outer) / (cos_inner - cos_outer)).clamp(0.0, 1.0);
    inside * inside
}

/// The colour of a slide in a direction away from the light.
fn projected(scene: &Scene, slide: TextureId, axis: Vec3, cos_outer: f32, direction: Vec3) -> Vec3 {
    let cosine = cos_outer.max(WIDEST_SLIDE);
    let rim = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
    let [right, up] = axes(axis);
    let forward = direction.dot(axis).max(WIDEST_SLIDE);
    let at = Vec2::new(right.dot(direction), -up.dot(direction)) / (forward * rim.max(f32::MIN_POSITIVE));
    picture(scene, slide, 0.5 + 0.5 * at, Wrap::Clamp)
}

/// A picture's right and up for a light that travels along `direction`.
pub(crate) fn axes(direction: Vec3) -> [Vec3; 2] {
    let vertical = if direction.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
    let right = direction.cross(vertical).normalize();
    [right, right.cross(direction)]
}

fn picture(scene: &Scene, texture: TextureId, uv: Vec2, wrap: Wrap) -> Vec3 {
    scene.textures[texture.0 as usize].sample_wrapped(uv, [wrap; 2]).truncate()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Encoding, Texture};

    /// Red, green over blue, white.
    fn four_colours() -> Scene {
        let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
        let texture = Texture::new(2, 2, texels, Encoding::Linear, [Wrap::Repeat; 2]);
        Scene { textures: vec![texture.into()], ..Scene::default() }
    }

    fn irradiance(light: &Light, point: Vec3) -> Vec3 {
        Arrival::new(&four_colours(), light, point).irradiance
    }

    /// A spot at the origin that projects the four colours along -z, 45 degrees to each side.
    fn projector() -> Light {
        Light::Spot {
            position: Vec3::ZERO,
            direction: Vec3::NEG_Z,
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            cos_inner: 0.75,
            cos_outer: 0.5f32.sqrt(),
            slide: Some(TextureId(0)),
        }
    }

    #[test]
    fn a_slide_is_seen_upright_from_the_light() {
        // The square of half a metre around the axis one metre away is half the slide.
        let light = projector();
        // Texel middles of the square [-1, 1]^2 at distance 1 are at +-0.5; cos there is sqrt(2/3) >
        // cos_inner.
        let at = |x: f32, y: f32| irradiance(&light, Vec3::new(x, y, -1.0)) * 1.5;
        let colours = [at(-0.5, 0.5), at(0.5, 0.5), at(-0.5, -0.5), at(0.5, -0.5)];
        for (colour, expected) in colours.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]) {
            assert!((colour - expected).length() < 1e-4, "{colour} is not {expected}");
        }
    }

    #[test]
    fn a_slide_ends_at_its_edges() {
        // Almost at the left edge, where the texture would go over to the green of the right one.
        let light = projector();
        let colour = irradiance(&light, Vec3::new(-0.99, 0.1, -1.0));
        assert!(colour.x > 0.0 && colour.y < 1e-3 * colour.x, "{colour}");
    }

    #[test]
    fn a_narrow_cone_is_full_on_its_axis() {
        let light = Light::Spot {
            position: Vec3::ZERO,
            direction: Vec3::NEG_Z,
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            cos_inner: 1.0,
            cos_outer: 0.01f32.cos(),
            slide: None,
        };
        assert_eq!(irradiance(&light, Vec3::NEG_Z), Vec3::ONE);
        assert_eq!(irradiance(&light, Vec3::new(0.011, 0.0, -1.0)), Vec3::ZERO);
        // Linear in the cosine, squared, half way to the rim.
        let half = irradiance(&light, Vec3::new(0.005, 0.0, -1.0)).x;
        assert!((half - 0.75f32.powi(2)).abs() < 0.01, "{half}");
    }

    #[test]
    fn a_pattern_repeats_across_the_direction_and_not_along_it() {
        let light = Light::Directional {
            direction: Vec3::NEG_Z,
            irradiance: Vec3::splat(2.0),
            pattern: Some((TextureId(0), 4.0)),
        };
        for repeat in [-4.0, 0.0, 8.0] {
            for z in [-3.0, 7.0] {
                let at = |x: f32, y: f32| irradiance(&light, Vec3::new(x + repeat, y - repeat, z));
                assert!((at(1.0, -1.0) - 2.0 * Vec3::X).length() < 1e-4);
                assert!((at(3.0, -1.0) - 2.0 * Vec3::Y).length() < 1e-4);
                assert!((at(1.0, -3.0) - 2.0 * Vec3::Z).length() < 1e-4);
            }
        }
    }

    #[test]
    fn a_point_at_the_light_receives_a_finite_amount() {
        let light = Light::Point { position: Vec3::ONE, intensity: Vec3::ONE, range: f32::INFINITY };
        assert!(irradiance(&light, Vec3::ONE).is_finite());
    }
}
