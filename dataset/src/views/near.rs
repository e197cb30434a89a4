//! Views as people stand: near to something, and looking at it.
//!
//! A view from anywhere to anywhere sees most of its scene from afar. Half of the views of a recipe with
//! [`Views::NearAndFar`](crate::recipe::Views) are of this kind instead: a point that a ray from anywhere to
//! anywhere meets; a distance from it, log-uniform within [`DISTANCES`]; a direction, uniform on the half of
//! the sphere that the point's surface faces. The camera stands there, sees the point, and looks about at it.
//! Views are refused as others are, but what is seen may be nearer.

use super::{Limits, candidate_from, first_fit, fitted_box, refusal};
use crate::DatasetError;
use crate::random::uniform;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use glam::Vec3;
use std::f32::consts::TAU;

/// How far the point may be that is looked at, as shares of the diagonal of the box that views are sampled
/// in.
pub const DISTANCES: [f32; 2] = [0.015, 0.6];
/// How far from the point the camera looks at most along each axis, as a share of the distance.
const JITTER: f32 = 0.25;
/// What the ray from the camera must reach of the way to the point; rays round.
const CLEAR: f32 = 0.999;
/// What is fit of these views.
const LIMITS: Limits = Limits { nearest: 0.002, least_median: 0.008, plane: 2e-4 };

/// Whether the view of an index of a scene is of this kind: every other one.
pub(super) const fn is_near(scene_key: u64, view: usize) -> bool {
    scene_key.wrapping_add(view as u64) % 2 == 1
}

/// The first fit view of a stream of random numbers, with this vertical field of view in degrees.
pub(super) fn sample(
    scene: &TracedScene,
    [height, width]: [usize; 2],
    stream: u64,
    degrees: f32,
) -> Result<Camera, DatasetError> {
    let bounds = fitted_box(scene);
    let diagonal = bounds.diagonal();
    let aspect = width as f32 / height as f32;
    let camera = |attempt: u32| {
        let draw = |number: u64| uniform(&[stream, u64::from(attempt), number]);
        let (origin, towards) = candidate_from(&bounds, stream, attempt)?;
        let (point, normal) = met(scene, origin, (towards - origin).normalize())?;
        let [nearest, farthest] = DISTANCES;
        let distance = diagonal * nearest * (farthest / nearest).powf(draw(6));
        let position = point + distance * about(normal, draw(7), draw(8));
        let seen = scene.hit(position, (point - position) / distance, f32::INFINITY)?.distance;
        let jitter = JITTER * distance * (2.0 * Vec3::new(draw(9), draw(10), draw(11)) - 1.0);
        let camera = Camera::look_at(position, point + jitter);
        (seen >= CLEAR * distance).then_some(Camera { vertical_fov: degrees.to_radians(), ..camera })
    };
    first_fit(scene, camera, |camera| match refusal(scene, &camera, aspect, diagonal, LIMITS) {
        Some(reason) => Err(reason),
        None => Ok(camera),
    })
}

/// Where a ray meets the front of a triangle, and the triangle's unit normal.
fn met(scene: &TracedScene, origin: Vec3, direction: Vec3) -> Option<(Vec3, Vec3)> {
    let hit = scene.hit(origin, direction, f32::INFINITY)?;
    let [a, b, c] = scene.scene().meshes[hit.mesh as usize].corners(hit.triangle as usize);
    let normal = (b - a).cross(c - a).try_normalize()?;
    (normal.dot(direction) < 0.0).then_some((origin + hit.distance * direction, normal))
}

/// A direction for two numbers in [0, 1), uniform on the half sphere about a normal.
fn about(normal: Vec3, height: f32, turn: f32) -> Vec3 {
    let (x, y) = normal.any_orthonormal_pair();
    let (ring, angle) = ((1.0 - height * height).max(0.0).sqrt(), TAU * turn);
    ring * (angle.cos() * x + angle.sin() * y) + height * normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recipe;
    use crate::recipe::{FieldOfView, Views};
    use crate::views::{median_depth, recipe_view};

    fn cameras(views: Views, count: usize) -> (f32, u64, Vec<(Camera, f32)>) {
        let mut recipe: Recipe = crate::shipped::shrunk("ao-tiny.toml");
        (recipe.views, recipe.field_of_view) = (views, Some(FieldOfView::Drawn([35.0, 90.0])));
        let planned = &recipe.plan().expect("scenes")[0];
        let scene = planned.scene.load(&recipe.folder).expect("a scene");
        let view = |index| {
            let camera = recipe_view(&recipe, &scene, planned.key, index).expect("a view");
            (camera, median_depth(&scene, &camera, [64, 64]).expect("something is seen"))
        };
        (scene.diagonal(), planned.key, (0..count).map(view).collect())
    }

    #[test]
    fn half_of_the_views_are_nearer_to_what_they_see_and_the_others_as_before() {
        let (diagonal, key, mixed) = cameras(Views::NearAndFar, 40);
        let (_, _, far) = cameras(Views::Anywhere, 40);
        let median = |near: bool| {
            let kind = |index: &usize| is_near(key, *index) == near;
            let mut depths: Vec<f32> = (0..40).filter(kind).map(|index| mixed[index].1).collect();
            assert_eq!(depths.len(), 20);
            depths.sort_by(f32::total_cmp);
            depths[10] / diagonal
        };
        assert!(median(true) < 0.7 * median(false), "{} {}", median(true), median(false));
        for (index, (camera, _)) in mixed.iter().enumerate() {
            assert_eq!(camera == &far[index].0, !is_near(key, index), "view {index}");
            assert!((34.9..90.1).contains(&camera.vertical_fov.to_degrees()));
        }
    }

    #[test]
    fn directions_about_a_normal_are_on_its_side() {
        let normal = Vec3::new(0.6, -0.8, 0.0);
        let mut mean = Vec3::ZERO;
        for i in 0..1000 {
            let direction = about(normal, (i as f32 + 0.5) / 1000.0, (0.618 * i as f32).fract());
            assert!((direction.length() - 1.0).abs() < 1e-4 && direction.dot(normal) > 0.0);
            mean += direction / 1000.0;
        }
        // Of a uniform half sphere the mean lies half way up.
        assert!((mean - 0.5 * normal).length() < 0.02, "{mean}");
    }
}
