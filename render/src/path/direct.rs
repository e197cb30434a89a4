//! Direct light from lights without an extent, with shadows: the attributes `L` and `Ldiff` (thesis 7.3.1).

use crate::bvh::TracedScene;
use crate::intersection::SurfacePoint;
use crate::scene::Light;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// Light reflected towards the viewer, radiance, RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectLight {
    /// By the diffuse colour.
    pub diffuse: Vec3,
    /// By the specular colour.
    pub specular: Vec3,
}

/// Light that reaches a point without a detour, reflected by the energy-normalised Phong model.
pub fn direct_light(scene: &TracedScene, point: &SurfacePoint, to_camera: Vec3) -> DirectLight {
    let mut sum = DirectLight::default();
    for light in &scene.scene().lights {
        let Arrival { direction, distance, irradiance } = arrival(light, point.position);
        let cosine = point.normal.dot(direction);
        let lit = cosine > 0.0 && point.geometric_normal.dot(direction) > 0.0 && irradiance != Vec3::ZERO;
        if !lit || scene.blocked(point.ray_origin(), direction, distance) {
            continue;
        }
        let received = irradiance * cosine;
        sum.diffuse += received * point.surface.diffuse * FRAC_1_PI;
        sum.specular += received * point.surface.specular * phong_lobe(point, direction, to_camera);
    }
    sum
}

/// What a light sends to a point if nothing is in between.
struct Arrival {
    /// Unit direction to the light.
    direction: Vec3,
    /// How far away it is.
    distance: f32,
    /// On a surface that faces the light.
    irradiance: Vec3,
}

fn arrival(light: &Light, point: Vec3) -> Arrival {
    match *light {
        Light::Point { position, intensity, range } => from_position(position, intensity, range, point),
        Light::Spot { position, direction, intensity, range, cos_inner, cos_outer, .. } => {
            let arrival = from_position(position, intensity, range, point);
            // KHR_lights_punctual: linear in the cosine between the cones, then squared.
            let cosine = -arrival.direction.dot(direction);
            let inside = ((cosine - cos_outer) / (cos_inner - cos_outer).max(1e-4)).clamp(0.0, 1.0);
            Arrival { irradiance: arrival.irradiance * inside * inside, ..arrival }
        }
        Light::Directional { direction, irradiance, .. } => {
            Arrival { direction: -direction, distance: f32::INFINITY, irradiance }
        }
    }
}

/// The inverse square, faded out towards the light's range as KHR_lights_punctual recommends.
fn from_position(position: Vec3, intensity: Vec3, range: f32, point: Vec3) -> Arrival {
    let to_light = position - point;
    let distance = to_light.length().max(1e-6);
    let fade = (1.0 - (distance / range).powi(4)).clamp(0.0, 1.0);
    Arrival { direction: to_light / distance, distance, irradiance: intensity * fade / (distance * distance) }
}

/// The energy-normalised Phong lobe, `(n + 2) / (2 pi) cos^n`, whose exponent has the width of a GGX lobe of the
/// same roughness (`n = 2 / alpha^2 - 2`, alpha the squared roughness).
fn phong_lobe(point: &SurfacePoint, to_light: Vec3, to_camera: Vec3) -> f32 {
    const NARROWEST_ALPHA: f32 = 0.02;
    let alpha = (point.surface.roughness * point.surface.roughness).max(NARROWEST_ALPHA);
    let exponent = (2.0 / (alpha * alpha) - 2.0).max(0.0);
    let mirrored = point.normal * (2.0 * point.normal.dot(to_light)) - to_light;
    let cosine = mirrored.dot(to_camera).max(0.0);
    (exponent + 2.0) / (2.0 * PI) * cosine.powf(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Scene};

    /// A floor of albedo 0.5 at y = 0 under a point light, with a roof that shades the half x > 0.
    fn floor_and_roof(light: Light) -> TracedScene {
        let square = |y: f32, x0: f32, x1: f32| Mesh {
            positions: [(x0, -9.), (x0, 9.), (x1, 9.), (x1, -9.)].map(|(x, z)| Vec3::new(x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        TracedScene::new(Scene {
            meshes: vec![square(0.0, -9.0, 9.0), square(1.0, 0.0, 9.0)],
            materials: vec![Material::matte("grey", Vec3::splat(0.5))],
            lights: vec![light],
            ..Scene::default()
        })
        .expect("two squares")
    }

    fn lamp(range: f32) -> Light {
        Light::Point { position: Vec3::new(-3.0, 4.0, 0.0), intensity: Vec3::splat(100.0), range }
    }

    fn floor_light(scene: &TracedScene, x: f32) -> DirectLight {
        let direction = Vec3::NEG_Y;
        let hit = scene.hit(Vec3::new(x, 0.9, 0.0), direction, f32::INFINITY).expect("the floor");
        direct_light(scene, &SurfacePoint::new(scene, &hit, direction), -direction)
    }

    #[test]
    fn a_point_light_follows_the_inverse_square_and_the_cosine() {
        let scene = floor_and_roof(lamp(f32::INFINITY));
        let under = floor_light(&scene, -3.0).diffuse.x;
        assert!((under - 100.0 / 16.0 * 0.5 / PI).abs() < 1e-4);
        let aside = floor_light(&scene, -6.0).diffuse.x;
        assert!((aside - 100.0 / 25.0 * 0.8 * 0.5 / PI).abs() < 1e-4);
    }

    #[test]
    fn a_light_fades_out_towards_its_range() {
        // The floor is 4 m below the lamp, and 5 m away from it at x = -6.
        let endless = floor_light(&floor_and_roof(lamp(f32::INFINITY)), -3.0).diffuse.x;
        let faded = floor_and_roof(lamp(5.0));
        let under = floor_light(&faded, -3.0).diffuse.x;
        assert!((under - endless * (1.0 - 0.8f32.powi(4))).abs() < 1e-4, "{under} of {endless}");
        assert_eq!(floor_light(&faded, -6.5), DirectLight::default());
    }

    #[test]
    fn a_roof_casts_a_shadow() {
        let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        let scene = floor_and_roof(light);
        assert!(floor_light(&scene, -1.0).diffuse.x > 0.1);
        assert_eq!(floor_light(&scene, 1.0), DirectLight::default());
    }

    #[test]
    fn a_spot_is_dark_outside_its_cone() {
        let light = Light::Spot {
            position: Vec3::new(-3.0, 4.0, 0.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::splat(100.0),
            range: f32::INFINITY,
            cos_inner: 0.95,
            cos_outer: 0.9,
            slide: None,
        };
        let scene = floor_and_roof(light);
        assert!((floor_light(&scene, -3.0).diffuse.x - 100.0 / 16.0 * 0.5 / PI).abs() < 1e-4);
        assert_eq!(floor_light(&scene, -6.0), DirectLight::default());
    }
}
