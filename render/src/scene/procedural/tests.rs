//! What every family promises.

use super::*;
use crate::bvh::TracedScene;
use crate::scene::Mesh;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashSet;

/// Digest of all that a renderer sees of a scene's shape (FNV-1a).
fn digest(scene: &Scene) -> u64 {
    let mut state = 0xcbf2_9ce4_8422_2325u64;
    let mut feed = |word: u32| state = (state ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    for mesh in &scene.meshes {
        let vectors = mesh.positions.iter().chain(&mesh.normals);
        vectors.flat_map(|vector| vector.to_array()).for_each(|value| feed(value.to_bits()));
        mesh.uvs[0].iter().flat_map(|uv| uv.to_array()).for_each(|value| feed(value.to_bits()));
        mesh.triangles.iter().flatten().for_each(|vertex| feed(*vertex));
    }
    state
}

/// Digest of a scene's colours at a few texture coordinates.
fn colours(scene: &Scene) -> Vec<u32> {
    let uvs = [0.1f32, 0.37, 0.83].map(|value| [Vec2::new(value, 1.3 * value); 2]);
    let surfaces = scene.materials.iter().flat_map(|material| {
        uvs.map(|uv| material.surface(&scene.textures, uv, Vec4::ONE)).map(|surface| surface.diffuse)
    });
    surfaces.flat_map(|colour| colour.to_array()).map(f32::to_bits).collect()
}

#[test]
fn twelve_families_train_and_five_others_test() {
    let count = |split| Family::ALL.iter().filter(|family| family.split() == split).count();
    assert_eq!((count(Split::Train), count(Split::Test)), (12, 5));
    let names: HashSet<&str> = Family::ALL.iter().map(|family| family.name()).collect();
    assert_eq!(names.len(), 17);
    for family in Family::ALL {
        assert_eq!(Family::by_name(family.name()).expect("its own name is known"), family);
    }
}

#[test]
fn unknown_names_are_answered_with_the_known_ones() {
    let message = Family::by_name("swamp").expect_err("there are no swamps").to_string();
    assert!(
        message.contains("`swamp`") && Family::ALL.iter().all(|family| message.contains(family.name())),
        "{message}"
    );
}

#[test]
fn a_seed_gives_the_same_scene_and_another_seed_another() {
    for family in Family::ALL {
        let [first, again, other] = [7, 7, 8].map(|seed| family.scene(seed));
        assert_eq!(digest(&first), digest(&again), "{}", first.name);
        assert_eq!(colours(&first), colours(&again), "{}", first.name);
        assert_ne!(digest(&first), digest(&other), "{}", first.name);
        assert_ne!(colours(&first), colours(&other), "{}", first.name);
    }
}

#[test]
fn scenes_are_whole_and_of_the_promised_size() {
    for family in Family::ALL {
        for seed in [0, 1, u64::MAX] {
            let scene = family.scene(seed);
            let (name, triangles) = (&scene.name, scene.triangle_count());
            let on_table = matches!(family, Family::Tabletop | Family::Workbench);
            let least = if on_table { 8_000 } else { 20_000 };
            assert!((least..=300_000).contains(&triangles), "{name}: {triangles} triangles");
            let diagonal = scene.bounds().diagonal();
            assert!((2.0..500.0).contains(&diagonal), "{name}: {diagonal} m");
            assert!(!scene.is_dark() && scene.materials.len() >= 4, "{name}");
            scene.meshes.iter().for_each(|mesh| check_mesh(&scene, mesh));
            let agreeing = agreeing_share(&scene);
            assert!(agreeing > 0.99, "{name}: {agreeing} of the normals on the triangles' side");
        }
    }
}

/// Attributes of equal length, indices and values in range, no triangle without an area.
fn check_mesh(scene: &Scene, mesh: &Mesh) {
    let what = format!("{}: {}", scene.name, mesh.name);
    let count = mesh.positions.len();
    assert!(mesh.normals.len() == count && mesh.uvs[0].len() == count, "{what}");
    assert!(mesh.tangents.is_empty() || mesh.tangents.len() == count, "{what}");
    assert!((mesh.material.0 as usize) < scene.materials.len(), "{what}");
    assert!(mesh.triangles.iter().flatten().all(|vertex| (*vertex as usize) < count), "{what}");
    assert!(mesh.positions.iter().all(|position| position.is_finite()), "{what}");
    assert!(mesh.uvs[0].iter().all(|uv| uv.is_finite()), "{what}");
    assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-3), "{what}");
    assert!(mesh.tangents.iter().all(|tangent| (tangent.truncate().length() - 1.0).abs() < 1e-3), "{what}");
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        assert!((b - a).cross(c - a).length() > 0.0, "{what}: triangle {triangle}");
    }
}

/// The share of all triangles' corners whose shading normal is on the side from which the triangle is
/// counter-clockwise.
fn agreeing_share(scene: &Scene) -> f32 {
    let (mut agreeing, mut corners) = (0, 0);
    for mesh in &scene.meshes {
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(index);
            let flat = (b - a).cross(c - a);
            corners += 3;
            agreeing +=
                triangle.iter().filter(|vertex| flat.dot(mesh.normals[**vertex as usize]) > 0.0).count();
        }
    }
    agreeing as f32 / corners as f32
}

#[test]
fn captures_differ_in_nothing_but_the_things_on_the_table() {
    let tables = [Family::Tabletop, Family::Workbench].map(|family| {
        let scene = family.scene(5);
        let fixed = |name: &str| {
            scene.meshes.iter().find(|mesh| mesh.name == name).expect("it is there").positions.clone()
        };
        assert!(
            scene.materials.iter().all(|material| material.base_colour.x == material.base_colour.z),
            "greys"
        );
        [fixed("table"), fixed("wall"), fixed("panel")]
    });
    assert_eq!(tables[0], tables[1]);
}

#[test]
fn turned_normals_are_noticed() {
    let mut scene = Family::Bridge.scene(0);
    scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.normals).for_each(|normal| *normal = -*normal);
    assert!(agreeing_share(&scene) < 0.01);
}

#[test]
fn there_is_ground_below() {
    for family in Family::ALL {
        let scene = TracedScene::new(family.scene(3)).expect("the scene is sound");
        let bounds = scene.bounds();
        let lands = |index: &usize| {
            let share = Vec2::new((index % 16) as f32, (index / 16) as f32) / 15.0 * 0.7 + 0.15;
            let from = bounds.min + bounds.size() * Vec3::new(share.x, 1.1, share.y);
            scene.hit(from, Vec3::NEG_Y, f32::INFINITY).is_some()
        };
        let landed = (0..256).filter(lands).count();
        // A cave is solid rock without an outside beside its chambers.
        let least = if family == Family::Cave { 128 } else { 250 };
        assert!(landed >= least, "{}: {landed} of 256 lines meet the ground", family.name());
    }
}
