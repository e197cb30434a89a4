//! Direct light from lights without an extent, with shadows: the attributes `L` and `Ldiff` (thesis 7.3.1).
//! It is the exact sum over those lights, without noise, also behind blended surfaces, which let their share
//! through; a medium dims it on its way to the surface, but not from there to the eye. Light of emissive
//! triangles and of the environment is no part of it.

use super::bsdf::Phong;
use super::lights::Arrival;
use crate::bvh::scene_at_time::SceneAtTime;
use crate::intersection::SurfacePoint;
use crate::scene::medium::POINTS;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Light reflected towards the viewer, radiance, RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectLight {
    /// By the diffuse colour.
    pub diffuse: Vec3,
    /// By the specular colour.
    pub specular: Vec3,
}

/// Light that reaches a point without a detour, reflected by the energy-normalised Phong model: in a scene,
/// or in it at the point's moment.
pub fn direct_light<'a>(
    scene: impl Into<SceneAtTime<'a>>,
    point: &SurfacePoint,
    to_camera: Vec3,
) -> DirectLight {
    let scene: SceneAtTime<'_> = scene.into();
    let lobe = Phong::new(point.surface.roughness);
    let mirrored = point.normal * (2.0 * point.normal.dot(to_camera)) - to_camera;
    let mut sum = DirectLight::default();
    let (origin, medium) = (point.ray_origin(), scene.scene().medium.as_deref());
    for light in &scene.scene().lights {
        let Arrival { direction, distance, irradiance } = Arrival::new(scene.scene(), light, origin);
        let cosine = point.normal.dot(direction);
        let lit = cosine > 0.0 && point.geometric_normal.dot(direction) > 0.0 && irradiance != Vec3::ZERO;
        if !lit {
            continue;
        }
        let passed = medium.map_or(Vec3::ONE, |of| of.passed_share(origin, direction, distance, POINTS));
        let received = irradiance * passed * cosine * scene.let_through(origin, direction, distance);
        sum.diffuse += received * point.surface.diffuse * FRAC_1_PI;
        sum.specular += received * point.surface.specular * lobe.reflectance(mirrored.dot(direction));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::scene::{AlphaMode, Light, Material, MaterialId, Mesh, Scene};
    use std::f32::consts::PI;

    /// A floor of albedo 0.5 at y = 0 under a point light, with a roof that shades the half x > 0.
    fn floor_and_roof(light: Light) -> TracedScene {
        floor_and_roof_of(light, Material::default())
    }

    fn floor_and_roof_of(light: Light, roof: Material) -> TracedScene {
        let square = |y: f32, x0: f32, x1: f32| Mesh {
            positions: [(x0, -9.), (x0, 9.), (x1, 9.), (x1, -9.)].map(|(x, z)| Vec3::new(x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        TracedScene::new(Scene {
            meshes: vec![square(0.0, -9.0, 9.0), Mesh { material: MaterialId(1), ..square(1.0, 0.0, 9.0) }]
                .into(),
            materials: vec![Material::matte("grey", Vec3::splat(0.5)), roof],
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
    fn a_pane_lets_its_share_through_at_every_moment() {
        let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        let mut pane = Material { alpha: AlphaMode::Blend, ..Material::default() };
        pane.base_colour.w = 0.3;
        let still = floor_and_roof_of(light, pane);
        let moving = still.with_motion(vec![vec![], vec![Vec3::X * 0.1; 4]]).expect("a way");
        for x in [0.5, 1.7, 4.2] {
            let through = floor_light(&still, x).diffuse.x / floor_light(&still, -x).diffuse.x;
            assert!((through - 0.7).abs() < 1e-6, "{through} of the light at {x}");
            let moment = moving.at(0.4);
            let hit = moment.hit(Vec3::new(x, 0.9, 0.0), Vec3::NEG_Y, 9.0).expect("the floor");
            let point = SurfacePoint::new(moment, &hit, Vec3::NEG_Y);
            let now = direct_light(moment, &point, Vec3::Y).diffuse.x;
            assert!((now - 0.7 * 0.5 / PI).abs() < 1e-6, "{now} at {x} while the pane moves");
        }
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
