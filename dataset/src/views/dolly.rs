//! Views of other fields of view that show nearly the same: a dolly zoom (thesis 7.5.1, Figure 7.13).
//!
//! As the field of view changes, the camera goes along its axis, so that what is in the middle of the image
//! stays as large as it was. A view is taken if it can be had at every field of view, so that a scene has the
//! same views at all.

use super::back_share_around;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use std::ops::RangeInclusive;

/// Vertical fields of view that a recipe may ask for, degrees.
pub const FIELDS_OF_VIEW: RangeInclusive<f32> = 20.0..=90.0;
/// What the ray from the farthest camera must reach of the way to the middle; rays round.
const CLEAR: f32 = 0.999;

/// The camera with another vertical field of view, in degrees, from where the surface in the middle of its
/// image looks as large as before. `None` if no surface is there, or not all of [`FIELDS_OF_VIEW`] can be
/// had: something stands in the way of the narrowest, or it or the widest is inside of geometry.
pub fn dolly_zoom(scene: &TracedScene, camera: &Camera, degrees: f32) -> Option<Camera> {
    let forward = -camera.rotation.z_axis;
    let distance = scene.hit(camera.position, forward, f32::INFINITY)?.distance;
    let middle = camera.position + distance * forward;
    let half_height = distance * (0.5 * camera.vertical_fov).tan();
    let away = |degrees: f32| half_height / (0.5 * degrees.to_radians()).tan();
    let position = |degrees: f32| middle - away(degrees) * forward;
    let (narrowest, widest) = (*FIELDS_OF_VIEW.start(), *FIELDS_OF_VIEW.end());
    let met = scene.hit(position(narrowest), forward, f32::INFINITY)?.distance;
    let is_clear = met >= CLEAR * away(narrowest);
    let is_open = |degrees| back_share_around(scene, position(degrees)) <= 0.5;
    let is_fit = is_clear && is_open(narrowest) && is_open(widest);
    is_fit.then(|| Camera { position: position(degrees), vertical_fov: degrees.to_radians(), ..*camera })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recipe;
    use crate::recipe::FieldOfView;
    use crate::views::recipe_view;
    use deepshade_render::scene::{Material, Mesh, Scene};
    use glam::{Vec2, Vec3};

    /// Squares across the z axis, each 8 m wide and facing +z, at these distances along it.
    fn squares(at: &[f32]) -> TracedScene {
        let corners = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)];
        let square = |z: &f32| Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, *z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let meshes: Vec<Mesh> = at.iter().map(square).collect();
        let materials = vec![Material::default()];
        let scene = Scene { name: "squares".into(), meshes: meshes.into(), materials, ..Scene::default() };
        TracedScene::new(scene).expect("squares")
    }

    fn camera() -> Camera {
        Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO)
    }

    #[test]
    fn what_is_in_the_middle_keeps_its_size_and_what_is_behind_does_not() {
        let scene = squares(&[0.0]);
        let pixel = |degrees: f32, point: Vec3| -> Vec2 {
            let camera = dolly_zoom(&scene, &camera(), degrees).expect("nothing is in the way");
            camera.project(camera.to_camera(point), 100, 100).expect("in front of it")
        };
        let (near, far) = (Vec3::new(1.0, -0.5, 0.0), Vec3::new(1.0, -0.5, -3.0));
        for degrees in [20.0, 35.0, 50.0, 90.0] {
            assert!(pixel(degrees, near).distance(pixel(50.0, near)) < 1e-3, "{degrees}");
        }
        assert!(pixel(20.0, far).distance(pixel(90.0, far)) > 5.0);
        let same = dolly_zoom(&scene, &camera(), 50.0).expect("a view");
        assert!(same.position.distance(camera().position) < 1e-5);
    }

    #[test]
    fn a_recipe_has_the_same_views_at_all_fields_of_view() {
        let recipe = crate::shipped::shrunk("ao-test.toml");
        let planned = &recipe.plan().expect("scenes")[0];
        let scene = planned.scene.load(&recipe.folder).expect("a scene");
        let view = |degrees: f32| {
            let recipe = Recipe { field_of_view: Some(FieldOfView::Fixed(degrees)), ..recipe.clone() };
            recipe_view(&recipe, &scene, planned.key, 0).expect("a view")
        };
        let [narrow, usual, wide] = [20.0, 50.0, 90.0].map(view);
        assert_eq!((narrow.rotation, wide.rotation), (usual.rotation, usual.rotation));
        assert!((wide.vertical_fov.to_degrees() - 90.0).abs() < 1e-3);
        let apart = narrow.position - wide.position;
        assert!(apart.dot(usual.rotation.z_axis) > 0.99 * apart.length(), "along the axis, and farther away");
        assert!(apart.length() > 0.01 * scene.diagonal());
    }

    #[test]
    fn a_view_is_had_at_all_fields_of_view_or_at_none() {
        let narrowest = 5.0 * 25f32.to_radians().tan() / 10f32.to_radians().tan();
        for (wall, fits) in [(narrowest - 0.1, false), (narrowest + 0.1, true)] {
            let scene = squares(&[0.0, wall]);
            for degrees in [20.0, 50.0, 90.0] {
                assert_eq!(dolly_zoom(&scene, &camera(), degrees).is_some(), fits, "{wall} m, {degrees}");
            }
        }
        let behind = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, 9.0));
        assert_eq!(dolly_zoom(&squares(&[0.0]), &behind, 50.0), None, "nothing in the middle");
    }
}
