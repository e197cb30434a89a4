//! Moments against the scene built anew as it is then.

use super::*;
use crate::bvh::tests::{clutter, random};
use crate::intersection::SurfacePoint;

/// A cube full of triangles and two panes of glass, each vertex on a way of its own; the panes turn.
fn moving() -> TracedScene {
    let still = clutter();
    let way = |i: usize| {
        let at = 3 * i as u32;
        Vec3::new(random(at), random(at + 1), random(at + 2)) - 0.5
    };
    let ways = |mesh: &Mesh| (0..mesh.positions.len()).map(way).collect();
    still.with_motion(still.scene().meshes.iter().map(ways).collect()).expect("finite ways")
}

/// What a moving scene is at a moment, built anew.
fn stopped(scene: &TracedScene, time: f32) -> TracedScene {
    let mut scene = scene.scene().clone();
    for mesh in &mut scene.meshes {
        for (position, displacement) in mesh.positions.iter_mut().zip(&mesh.displacements) {
            *position += *displacement * time;
        }
        mesh.displacements.clear();
    }
    TracedScene::new(scene).expect("triangles")
}

fn ray_into(i: u32) -> (Vec3, Vec3) {
    let origin = Vec3::new(random(7 * i), random(7 * i + 1), random(7 * i + 2)) * 14.0 - 2.0;
    let aside = Vec3::new(random(7 * i + 3), random(7 * i + 4), random(7 * i + 5)) - 0.5;
    (origin, (Vec3::splat(5.0) - origin + 6.0 * aside).normalize())
}

#[test]
fn a_moment_is_the_scene_stopped_there() {
    let moving = moving();
    let (mut met, mut differs) = (0, 0);
    for time in [-0.5, -0.17, 0.0, 0.31, 0.5] {
        let (moment, stopped) = (moving.at(time), stopped(&moving, time));
        for i in 0..400 {
            let (origin, direction) = ray_into(i);
            let hit = moment.hit(origin, direction, f32::INFINITY);
            let alone = stopped.hit(origin, direction, f32::INFINITY);
            let what = |hit: Option<Hit>| hit.map(|hit| (hit.mesh, hit.triangle));
            assert_eq!(what(hit), what(alone), "ray {i} at {time}");
            let distances = hit.zip(alone).map_or([0.0; 2], |(hit, alone)| [hit.distance, alone.distance]);
            assert!((distances[0] - distances[1]).abs() < 1e-4, "{distances:?}");
            differs += usize::from(hit != moving.hit(origin, direction, f32::INFINITY));
            if let Some(hit) = hit {
                met += 1;
                let point = SurfacePoint::new(moment, &hit, direction);
                let expected = SurfacePoint::new(&stopped, &hit, direction);
                assert_eq!(point.position, expected.position);
                assert_eq!(point.geometric_normal, expected.geometric_normal);
                assert!((point.normal - expected.normal).length() < 1e-5);
            }
        }
    }
    assert!(met > 1_000 && differs > 400, "{met} met something, {differs} something else than in the middle");
}

#[test]
fn what_blocks_is_where_it_is() {
    let moving = moving();
    let mut blocked = 0;
    for time in [-0.4, 0.5] {
        let stopped = stopped(&moving, time);
        for i in 0..400 {
            let (origin, direction) = ray_into(i);
            let reach = 1.0 + 4.0 * random(i);
            let now = moving.at(time).blocked(origin, direction, reach);
            assert_eq!(now, stopped.blocked(origin, direction, reach), "ray {i} at {time}");
            blocked += usize::from(now);
        }
    }
    assert!((100..700).contains(&blocked), "{blocked} are blocked");
}

#[test]
fn times_out_of_the_exposure_are_its_ends() {
    let moving = moving();
    assert_eq!(moving.at(7.0).time(), 0.5);
    assert_eq!(moving.at(-7.0).time(), -0.5);
    assert_eq!(SceneAtTime::from(&moving).time(), 0.0);
}

#[test]
fn a_scene_that_stays_has_no_ways() {
    let still = clutter();
    assert!(still.swept.is_none());
    let nowhere = still.scene().meshes.iter().map(|mesh| vec![Vec3::ZERO; mesh.positions.len()]).collect();
    assert!(still.with_motion(nowhere).expect("finite").swept.is_none());
}

#[test]
fn normals_turn_with_their_triangles() {
    // A square in the plane z = 0 whose right edge moves back and whose left comes forward: it turns about y.
    let positions: Vec<Vec3> =
        [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0)).into();
    let mesh = Mesh {
        displacements: positions.iter().map(|p| Vec3::new(0.0, 0.0, -2.0 * p.x)).collect(),
        normals: vec![Vec3::new(0.6, 0.0, 0.8); 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        positions,
        ..Mesh::default()
    };
    let materials = vec![crate::scene::Material::default()];
    let scene = TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() })
        .expect("a square");
    let normal = |time: f32| {
        let moment = scene.at(time);
        let hit = moment.hit(Vec3::new(0.2, 0.1, 9.0), Vec3::NEG_Z, 99.0).expect("the square");
        SurfacePoint::new(moment, &hit, Vec3::NEG_Z).normal
    };
    assert!((normal(0.0) - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
    // By 45 degrees at the end, towards +x.
    let angle = 0.6f32.asin() + 45f32.to_radians();
    assert!(
        (normal(0.5) - Vec3::new(angle.sin(), 0.0, angle.cos()).normalize()).length() < 2e-3,
        "{}",
        normal(0.5)
    );
}

#[test]
fn ways_that_cannot_be_are_refused_by_name() {
    let still = clutter();
    let vertices = still.scene().meshes[0].positions.len();
    let error = |first: Vec<Vec3>| {
        still.with_motion(vec![first, vec![]]).expect_err("a way that cannot be").to_string()
    };
    assert!(error(vec![Vec3::X; 3]).contains("has 3 displacements for"));
    assert!(error(vec![Vec3::NAN; vertices]).contains("a displacement that is not finite"));
    assert!(error(vec![Vec3::splat(2e9); vertices]).contains("more than 1e9 m"));
    let lists = still.with_motion(vec![vec![]]).expect_err("one list for two meshes").to_string();
    assert!(lists.contains("displacements for 1"), "{lists}");
}
