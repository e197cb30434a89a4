//! Whether a scene is a place, in which people stand, or something that they look at from outside.
//!
//! That is asked of the scene as a whole: of places all over the box that views are sampled in, of which
//! those inside of geometry do not count. A scene is a place if it surrounds whoever stands there, as a room
//! does, or has ground below him nearly everywhere and is no smaller than a table with its room: things lie
//! on cloths and plates, too.

use super::{BALL, ball, fitted_box};
use crate::random::uniform;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Bounds;
use glam::Vec3;

/// Places that are looked from.
const PLACES: u64 = 128;
/// Mean share of directions that end on a front where a scene surrounds its viewer.
const SURROUNDED: f32 = 0.7;
/// Share of places above a front where there is ground.
const GROUND: f32 = 0.75;
/// Diagonal of the smallest place that is not closed, metres.
const SMALLEST: f32 = 2.0;

/// Whether people stand in a scene; else it is looked at from outside.
pub fn is_place(scene: &TracedScene) -> bool {
    let Around { surrounded, ground } = Around::of(scene);
    surrounded >= SURROUNDED || (ground >= GROUND && scene.diagonal() >= SMALLEST)
}

/// What is around the places of a scene's box that are not inside of geometry; 0 where all are.
#[derive(Clone, Copy, Debug, Default)]
struct Around {
    /// Mean share of directions that end on the front of a triangle.
    surrounded: f32,
    /// Share of the places below which one is.
    ground: f32,
}

impl Around {
    fn of(scene: &TracedScene) -> Self {
        let bounds = fitted_box(scene);
        let (mut open, mut fronts, mut above) = (0usize, 0usize, 0usize);
        for place in (0..PLACES).map(|index| drawn(&bounds, index)) {
            let seen: Vec<bool> = ball(scene, place).map(|probe| probe.back).collect();
            let backs = seen.iter().filter(|back| **back).count();
            if 2 * backs > BALL {
                continue;
            }
            open += 1;
            fronts += seen.len() - backs;
            above += usize::from(stands_above_a_front(scene, place));
        }
        let open = open.max(1) as f32;
        Self { surrounded: fronts as f32 / (open * BALL as f32), ground: above as f32 / open }
    }
}

fn stands_above_a_front(scene: &TracedScene, place: Vec3) -> bool {
    super::Probe::new(scene, place, Vec3::NEG_Y).is_some_and(|probe| !probe.back)
}

/// A place in a box.
fn drawn(bounds: &Bounds, index: u64) -> Vec3 {
    let share = |axis| uniform(&[index, axis]);
    bounds.min + bounds.size() * Vec3::new(share(0), share(1), share(2))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{block, traced};
    use super::*;
    use deepshade_render::scene::procedural::Family;
    use deepshade_render::scene::{Mesh, Scene};

    #[test]
    fn people_stand_in_rooms_streets_and_landscapes() {
        for name in ["room", "city", "terrain"] {
            let family = Family::by_name(name).expect("a family");
            for seed in 0..3 {
                let scene = TracedScene::new(family.scene(seed)).expect("a scene");
                assert!(
                    is_place(&scene),
                    "{name}:{seed}, {:.1} m: {:?}",
                    scene.diagonal(),
                    Around::of(&scene)
                );
            }
        }
    }

    #[test]
    fn a_room_is_a_place_with_or_without_its_front_and_a_box_is_none() {
        let (low, high) = (Vec3::ZERO, Vec3::new(6.0, 3.0, 5.0));
        let furniture = block(Vec3::new(1.0, 0.0, 1.0), Vec3::new(3.0, 1.5, 2.5), true);
        let room = block(low, high, false);
        assert!(is_place(&traced(vec![room.clone(), furniture])));
        // The face of x = 6 m.
        let open = Mesh { triangles: [&room.triangles[..2], &room.triangles[4..]].concat(), ..room };
        assert!(is_place(&traced(vec![open])));
        assert!(!is_place(&traced(vec![block(low, high, true)])));
    }

    #[test]
    fn things_of_several_parts_are_looked_at_and_landscapes_stood_in() {
        let at = |x: f32, y: f32, size: f32| {
            block(Vec3::new(x, y, 0.0), Vec3::new(x + size, y + size, size), true)
        };
        assert!(!is_place(&traced(vec![at(0.0, 0.0, 1.0), at(0.2, 1.0, 0.6), at(1.5, 0.0, 0.5)])), "parts");
        let ground =
            |size: f32| block(Vec3::new(-size, -0.1 * size, -size), Vec3::new(size, 0.0, size), true);
        assert!(is_place(&traced(vec![ground(20.0), at(1.0, 0.0, 2.0), at(-4.0, 0.0, 3.0)])), "houses");
        assert!(!is_place(&traced(vec![ground(0.2), at(0.0, 0.0, 0.05)])), "a thing on its plate");
        let panel = block(Vec3::new(-9.0, 0.0, -0.1), Vec3::new(9.0, 9.0, 0.0), true);
        assert!(!is_place(&traced(vec![panel])), "an upright panel");
    }

    #[test]
    fn a_scene_of_one_flat_triangle_is_judged() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let scene =
            Scene { meshes: vec![mesh].into(), materials: vec![Default::default()], ..Scene::default() };
        assert!(!is_place(&TracedScene::new(scene).expect("a triangle")));
    }
}
