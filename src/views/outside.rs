//! The view of a scene from outside, so far away that all of it is seen. Views that are sampled for datasets
//! stand in the scene's box, where a thing fills the image and more.

use deepshade_dataset::views::median_depth;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use glam::Vec3;

/// From where it is seen: from the front, a little from the right and from above.
const FROM: Vec3 = Vec3::new(0.5, 0.4, 1.0);

/// The view, for images of `[height, width]`; none where nothing would be seen.
pub fn from_outside(scene: &TracedScene, [height, width]: [usize; 2]) -> Option<Camera> {
    let (bounds, centre) = (scene.bounds(), scene.bounds().centre());
    let camera = Camera::look_at(centre + FROM, centre);
    let upwards = 0.5 * camera.vertical_fov;
    let sideways = (upwards.tan() * width as f32 / height as f32).atan();
    let distance = 0.5 * bounds.diagonal() / upwards.min(sideways).sin();
    let camera = Camera { position: centre + distance * FROM.normalize(), ..camera };
    median_depth(scene, &camera, [height, width]).map(|_| camera)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::{Bounds, Material, Mesh, Scene};

    /// A box from a corner to the one opposite.
    fn solid(min: Vec3, max: Vec3) -> Mesh {
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh { positions: Bounds { min, max }.corners().to_vec(), triangles, ..Mesh::default() }
    }

    #[test]
    fn all_of_a_scene_of_several_parts_is_seen_from_above() {
        let parts = [(3.0, 0.3), (3.05, 0.1), (3.4, 0.2)];
        let meshes = parts.map(|(x, height)| solid(Vec3::new(x, 0.0, 3.0), Vec3::new(x + 0.1, height, 3.2)));
        let scene = Scene {
            meshes: meshes.to_vec().into(),
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let scene = TracedScene::new(scene).expect("boxes");
        for [height, width] in [[64, 64], [48, 96], [96, 48]] {
            let camera = from_outside(&scene, [height, width]).expect("a view");
            let most = (0.5 * camera.vertical_fov).tan() * Vec3::new(width as f32 / height as f32, 1.0, 0.0);
            for corner in scene.bounds().corners() {
                let seen = camera.to_camera(corner);
                let at = (seen / -seen.z).abs();
                assert!(seen.z < 0.0 && at.x < most.x && at.y < most.y, "{height} x {width}: {seen}");
            }
            let from = camera.position - scene.bounds().centre();
            assert!(from.y > 0.0 && from.length() < 3.0 * scene.diagonal(), "{from}");
        }
    }
}
