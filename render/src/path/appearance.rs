//! What the blurs of a camera blur: the picture by direct light, sharp, along any ray at any moment.
//!
//! It is the attribute `L` plus emission, by the same Phong model and with the same shadows, and the
//! environment's radiance where nothing is seen; without an environment that is black. A medium does not dim
//! it.

use super::direct::direct_light;
use crate::bvh::scene_at_time::SceneAtTime;
use crate::intersection::SurfacePoint;
use crate::scene::Scene;
use glam::Vec3;

/// Radiance from a unit direction by direct light alone.
pub fn appearance<'a>(scene: impl Into<SceneAtTime<'a>>, origin: Vec3, direction: Vec3) -> Vec3 {
    let scene = scene.into();
    match seen(scene, origin, direction) {
        Some(point) => reflected(scene, &point, direction) + point.surface.emission,
        None => sky(scene.scene(), direction),
    }
}

/// The surface in a direction.
pub(super) fn seen<'a>(
    scene: impl Into<SceneAtTime<'a>>,
    origin: Vec3,
    direction: Vec3,
) -> Option<SurfacePoint> {
    let scene = scene.into();
    let hit = scene.hit(origin, direction, f32::INFINITY)?;
    Some(SurfacePoint::new(scene, &hit, direction))
}

/// The attribute `L` of a point seen along a direction.
pub(super) fn reflected<'a>(
    scene: impl Into<SceneAtTime<'a>>,
    point: &SurfacePoint,
    direction: Vec3,
) -> Vec3 {
    let direct = direct_light(scene, point, -direction);
    direct.diffuse + direct.specular
}

/// Radiance of the environment from a direction.
pub(super) fn sky(scene: &Scene, direction: Vec3) -> Vec3 {
    scene.environment.as_ref().map_or(Vec3::ZERO, |environment| environment.radiance(direction))
}
