//! The view of a scene that is one object alone: from outside, so far away that all of it is seen. Views that are sampled for datasets
//! stand in the object's box, where it fills the image and more.

use deepshade_dataset::views::front_share_around;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use glam::Vec3;

/// From where it is seen: from the front, a little from the right and from above.
const FROM: Vec3 = Vec3::new(0.5, 0.4, 1.0);
/// Share of directions in which a room's walls are seen from its middle; an object is seen from its inside there, or not at all.
const ENCLOSED: f32 = 0.75;

/// The view, for images of `[height, width]`; none of what is no lone object: of several meshes, or of one that encloses a room.
pub fn from_outside(scene: &TracedScene, [height, width]: [usize; 2]) -> Option<Camera> {
    let (bounds, centre) = (scene.bounds(), scene.bounds().centre());
    if scene.scene().meshes.len() != 1 || front_share_around(scene, centre) >= ENCLOSED {
        return None;
    }
    let camera = Camera::look_at(centre + FROM, centre);
    let upwards = 0.5 * camera.vertical_fov;
    let sideways = (upwards.tan() * width as f32 / height as f32).atan();
    let distance = 0.5 * bounds.diagonal() / upwards.min(sideways).sin();
    Some(Camera { position: centre + distance * FROM.normalize(), ..camera })
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::procedural::Family;
    use deepshade_render::scene::{Bounds, Material, Mesh, Scene};

    /// Boxes from a corner to the one opposite, whose triangles face outwards, or inwards.
    fn boxes(all: &[(Vec3, Vec3, bool)]) -> TracedScene {
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let meshes = all.iter().map(|(min, max, outwards)| {
            let halves =
                faces.iter().flat_map(|face| [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]);
            let turned = halves.map(|[a, b, c]| if *outwards { [a, b, c] } else { [a, c, b] });
            let positions = Bounds { min: *min, max: *max }.corners().to_vec();
            Mesh { positions, triangles: turned.collect(), ..Mesh::default() }
        });
        let meshes = meshes.collect();
        let materials = vec![Material::default()];
        TracedScene::new(Scene { meshes, materials, ..Scene::default() }).expect("boxes")
    }

    #[test]
    fn all_of_a_lone_object_is_seen_from_above() {
        let scene = boxes(&[(Vec3::new(3.0, 0.0, 3.0), Vec3::new(3.1, 0.3, 3.2), true)]);
        for [height, width] in [[64, 64], [48, 96], [96, 48]] {
            let camera = from_outside(&scene, [height, width]).expect("a view");
            let most = (0.5 * camera.vertical_fov).tan() * Vec3::new(width as f32 / height as f32, 1.0, 0.0);
            for corner in scene.bounds().corners() {
                let seen = camera.to_camera(corner);
                let at = (seen / -seen.z).abs();
                assert!(seen.z < 0.0 && at.x < most.x && at.y < most.y, "{height} x {width}: {seen}");
            }
            let from = camera.position - scene.bounds().centre();
            assert!(from.y > 0.0 && from.length() < 1.5, "{from}");
        }
    }

    #[test]
    fn rooms_and_what_has_several_parts_are_sampled_as_ever() {
        let (low, high) = (Vec3::ZERO, Vec3::new(4.0, 2.0, 4.0));
        let view = |all: &[(Vec3, Vec3, bool)]| from_outside(&boxes(all), [64, 64]);
        assert!(view(&[(low, high, true)]).is_some());
        assert!(view(&[(low, high, false)]).is_none(), "a room");
        assert!(view(&[(low, high, true), (high, high + Vec3::ONE, true)]).is_none());
        for family in Family::ALL {
            assert!(family.scene(1).meshes.len() > 1, "{}", family.name());
        }
    }
}
