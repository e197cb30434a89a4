//! G-buffers against geometry worked out by hand and against single rays.

use super::*;
use crate::scene::{Material, Mesh, Scene};

/// A square of 2 x 2 m in the plane z = 0 that faces +z.
fn square() -> TracedScene {
    let mesh = Mesh {
        positions: [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let materials = vec![Material::matte("red", Vec3::new(0.8, 0.1, 0.2))];
    TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() }).expect("a square")
}

#[test]
fn a_square_seen_aslant_has_the_plane_it_lies_in() {
    let scene = square();
    let camera = Camera::look_at(Vec3::new(1.0, 0.5, 2.0), Vec3::ZERO);
    let gbuffer = render(&scene, &camera, 33, 47, &Attribute::ALL);
    let all = gbuffer.select(&[Attribute::Position, Attribute::Normal, Attribute::Depth, Attribute::Valid]);
    let all = all.expect("all rendered");
    let plane_normal = camera.direction_to_camera(Vec3::Z);
    let origin = camera.to_camera(Vec3::ZERO);
    let mut seen = 0;
    for y in 0..33 {
        for x in 0..47 {
            let at = |first| Vec3::from_array(std::array::from_fn(|c| all.at(first + c, y, x)));
            if all.at(7, y, x) == 0.0 {
                assert!(all.at(6, y, x) == 0.0 && at(0) == Vec3::ZERO);
                continue;
            }
            seen += 1;
            assert!((at(3) - plane_normal).length() < 1e-5);
            assert!((at(0) - origin).dot(plane_normal).abs() < 1e-5);
            assert!((all.at(6, y, x) + at(0).z).abs() < 1e-6);
            let towards = at(0).normalize();
            let world = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 33, 47);
            assert!((towards - camera.direction_to_camera(world)).length() < 1e-5);
        }
    }
    assert!(seen > 300 && seen < 33 * 47, "{seen} pixels see the square");
}

#[test]
fn every_pixel_shows_what_its_own_ray_meets() {
    let scene = crate::scene::procedural::Family::Room.scene(1);
    let scene = TracedScene::new(scene).expect("a room");
    let camera = Camera::look_at(scene.bounds().centre(), scene.bounds().min);
    let (height, width) = (37, 51);
    let gbuffer = render(&scene, &camera, height, width, &[Attribute::Depth]);
    for y in 0..height {
        for x in 0..width {
            let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
            let hit = scene.hit(camera.position, direction, f32::INFINITY);
            let depth =
                hit.map_or(0.0, |hit| -camera.to_camera(camera.position + direction * hit.distance).z);
            let found = gbuffer.planes().at(0, y, x);
            assert!((found - depth).abs() < 1e-4 * depth.max(1.0), "({x}, {y}): {found} is not {depth}");
        }
    }
}

#[test]
fn material_channels_are_the_materials() {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO);
    let gbuffer = render(&square(), &camera, 8, 8, &[Attribute::Diffuse, Attribute::Glossiness]);
    let values: Vec<f32> = (0..4).map(|c| gbuffer.planes().at(c, 4, 4)).collect();
    assert_eq!(values, vec![0.8, 0.1, 0.2, 0.0]);
}

/// A square of 2 x 2 m in the plane z = 0 on its way.
fn square_on_its_way(displacement: Vec3) -> TracedScene {
    let still = square();
    let vertices = still.scene().meshes[0].positions.len();
    still.with_motion(vec![vec![displacement; vertices]]).expect("a way")
}

/// Direction and length of the movement at a pixel.
fn motion_at(scene: &TracedScene, camera: &Camera, [y, x]: [usize; 2]) -> [f32; 2] {
    let gbuffer = render(scene, camera, 32, 48, &[Attribute::Motion]);
    [0, 1].map(|c| gbuffer.planes().at(c, y, x))
}

#[test]
fn motion_is_that_of_the_projection() {
    let camera = Camera::look_at(Vec3::new(0.4, -0.3, 2.5), Vec3::ZERO);
    for displacement in [Vec3::X, Vec3::NEG_X, Vec3::new(0.3, 0.2, 0.0), Vec3::new(-0.1, 0.4, 0.7)] {
        let scene = square_on_its_way(displacement);
        let [y, x] = [13, 29];
        let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 32, 48);
        let hit = scene.hit(camera.position, direction, f32::INFINITY).expect("the square");
        let point = camera.position + direction * hit.distance;
        let seen = |part: f32| {
            let point = camera.to_camera(point + displacement * part);
            camera.project(point, 32, 48).expect("in front")
        };
        let across = seen(0.5) - seen(-0.5);
        let [angle, length] = motion_at(&scene, &camera, [y, x]);
        assert!((length - across.length()).abs() < 1e-3 && length > 1.0, "{length} is not {across}");
        assert!((0.0..PI).contains(&angle));
        // The same line, whichever way along it; y is up in the channel and down in the image.
        let found = Vec2::new(angle.cos(), -angle.sin()) * length;
        let off = (found - across).length().min((found + across).length());
        assert!(off < 1e-3, "{displacement}: {found} is not {across}");
        assert!(
            found.perp_dot(across * Vec2::new(1.0, -1.0)).abs() > 0.1 || across.y.abs() < 0.1,
            "y turned is noticed"
        );
    }
}

#[test]
fn what_stays_has_no_motion() {
    let camera = Camera::look_at(Vec3::new(0.4, -0.3, 2.5), Vec3::ZERO);
    assert_eq!(motion_at(&square(), &camera, [13, 29]), [0.0, 0.0]);
    assert_eq!(motion_at(&square_on_its_way(Vec3::ZERO), &camera, [13, 29]), [0.0, 0.0]);
}

#[test]
fn an_end_behind_the_camera_is_that_of_the_movement_in_the_middle() {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 2.5), Vec3::ZERO);
    let along = square_on_its_way(Vec3::new(0.0, 0.0, 6.0));
    let [_, length] = motion_at(&along, &camera, [13, 29]);
    // Towards the camera, points leave the image's middle at their distance from it times 6 m / 2.5 m.
    let from_middle = Vec2::new(29.5 - 24.0, 13.5 - 16.0).length();
    assert!((length - from_middle * 6.0 / 2.5).abs() < 1e-3, "{length}");
}

#[test]
fn lens_channels_belong_together() {
    let lens = crate::scene::Lens::new(0.05, 2.0).expect("a lens");
    let camera = Camera { lens: Some(lens), ..Camera::look_at(Vec3::new(1.0, 0.5, 2.0), Vec3::ZERO) };
    let attributes =
        [Attribute::Depth, Attribute::FocalDistance, Attribute::CircleOfConfusion, Attribute::Blurriness];
    let gbuffer = render(&square(), &camera, 33, 47, &attributes);
    let (mut near, mut far) = (0, 0);
    for pixel in 0..33 * 47 {
        let [depth, distance, circle, blurriness] = [0, 1, 2, 3].map(|c| gbuffer.planes().plane(c)[pixel]);
        if depth == 0.0 {
            assert_eq!([distance, circle, blurriness], [0.0; 3]);
            continue;
        }
        (near, far) = (near + i32::from(distance < 0.0), far + i32::from(distance > 0.0));
        assert!((distance - (depth - 2.0)).abs() < 1e-6);
        assert!((circle - camera.circle_of_confusion(depth, 33)).abs() < 1e-6);
        assert!((blurriness.abs() - circle * depth).abs() < 1e-5 && blurriness * distance >= 0.0);
    }
    assert!(near > 50 && far > 50, "{near} pixels nearer than the plane in focus, {far} farther");
    let pinhole = render(&square(), &Camera { lens: None, ..camera }, 33, 47, &attributes[1..]);
    assert!(pinhole.planes().data().iter().all(|value| *value == 0.0));
}

#[test]
fn the_mean_free_path_is_the_material_s() {
    let mut scene = square().scene().clone();
    scene.materials[0].mean_free_path = Vec3::new(0.03, 0.02, 0.01);
    let scene = TracedScene::new(scene).expect("a square");
    let camera = Camera::look_at(Vec3::Z, Vec3::ZERO);
    let gbuffer = render(&scene, &camera, 8, 8, &[Attribute::MeanFreePath]);
    assert_eq!([0, 1, 2].map(|c| gbuffer.planes().at(c, 4, 4)), [0.03, 0.02, 0.01]);
}
