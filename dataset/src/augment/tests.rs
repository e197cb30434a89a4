use super::*;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::scene::procedural::Family;
use deepshade_render::scene::{Camera, Scene};
use deepshade_shaders::Effect;
use glam::{Mat3, Vec3};

/// Some colours, positions and movements that no symmetry leaves as they are.
fn asymmetric(height: usize, width: usize) -> GBuffer {
    let attributes = vec![Attribute::Diffuse, Attribute::Position, Attribute::Motion];
    let planes = Planes::from_fn(8, height, width, |c, y, x| {
        let value = ((c * 31 + y * 17 + x * 7) % 23) as f32;
        if c == 6 { (value + 0.5) / 24.0 * PI } else { value - 9.0 }
    });
    GBuffer::new(attributes, planes)
}

fn nearly_equal(a: &GBuffer, b: &GBuffer) -> bool {
    let close = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-4;
    a.planes().same_shape(b.planes()) && a.planes().data().iter().zip(b.planes().data()).all(close)
}

/// The symmetry that does what two do one after the other, by their matrices.
fn after_each_other(first: Symmetry, second: Symmetry) -> Symmetry {
    let [[a, b], [c, d]] = first.matrix();
    let product = second.matrix().map(|[x, y]| [x * a + y * c, x * b + y * d]);
    Symmetry::ALL.into_iter().find(|both| both.matrix() == product).expect("a group")
}

/// The g-buffer's movements as vectors at twice their angles.
fn doubled(gbuffer: &GBuffer) -> GBuffer {
    let motion = gbuffer.select(&[Attribute::Motion]).expect("it is there");
    let value = |c: usize, y: usize, x: usize| {
        let (sine, cosine) = (2.0 * motion.at(0, y, x)).sin_cos();
        motion.at(1, y, x) * [cosine, sine][c]
    };
    let planes = Planes::from_fn(2, motion.height(), motion.width(), value);
    GBuffer::new(vec![Attribute::Movement], planes)
}

#[test]
fn a_movement_turns_as_the_motion_that_it_is_of() {
    let gbuffer = asymmetric(5, 8);
    for symmetry in Symmetry::ALL {
        let (turned, of_turned) = (symmetry.apply(&doubled(&gbuffer)), doubled(&symmetry.apply(&gbuffer)));
        assert!(nearly_equal(&turned, &of_turned), "{symmetry:?}");
    }
    assert!(!nearly_equal(&doubled(&gbuffer), &Symmetry::new(true, 0).apply(&doubled(&gbuffer))));
}

#[test]
fn the_eight_are_a_group() {
    let gbuffer = asymmetric(5, 8);
    for first in Symmetry::ALL {
        for second in Symmetry::ALL {
            let both = after_each_other(first, second).apply(&gbuffer);
            assert!(nearly_equal(&second.apply(&first.apply(&gbuffer)), &both), "{first:?} {second:?}");
        }
    }
}

#[test]
fn mirrorings_undo_themselves_and_all_eight_differ() {
    let gbuffer = asymmetric(6, 6);
    for (index, symmetry) in Symmetry::ALL.into_iter().enumerate() {
        let image = symmetry.apply(&gbuffer);
        let undone = nearly_equal(&symmetry.apply(&image), &gbuffer);
        assert_eq!(undone, symmetry.mirrored || symmetry.quarter_turns % 2 == 0, "{symmetry:?}");
        assert!(Symmetry::ALL[..index].iter().all(|other| !nearly_equal(&other.apply(&gbuffer), &image)));
    }
}

#[test]
fn a_quarter_turn_goes_counter_clockwise() {
    let image = Planes::from_data(1, 2, 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let turned = Symmetry::new(false, 1).move_pixels(&image);
    assert_eq!((turned.height(), turned.data()), (3, [3.0, 6.0, 2.0, 5.0, 1.0, 4.0].as_slice()));
    let mirrored = Symmetry::new(true, 0).move_pixels(&image);
    assert_eq!(mirrored.data(), &[3.0, 2.0, 1.0, 6.0, 5.0, 4.0]);
}

#[test]
fn a_movement_turns_with_the_image() {
    let right = GBuffer::new(vec![Attribute::Motion], Planes::from_data(2, 1, 1, vec![0.25, 3.0]));
    let value = |symmetry: Symmetry| symmetry.apply(&right).planes().data().to_vec();
    assert!((value(Symmetry::new(false, 1))[0] - (0.25 + PI / 2.0)).abs() < 1e-6);
    assert!((value(Symmetry::new(true, 0))[0] - (PI - 0.25)).abs() < 1e-6);
    assert!((value(Symmetry::new(false, 2))[0] - 0.25).abs() < 1e-6);
    assert_eq!(value(Symmetry::new(true, 3))[1], 3.0);
}

/// A procedural scene and a view of it that sees something.
fn scene_and_camera() -> (TracedScene, Camera) {
    let scene: Scene = Family::ALL[0].scene(3);
    let scene = TracedScene::new(scene).expect("a scene");
    let camera = crate::views::sample_view(&scene, [40, 56], 1, 2, 0).expect("a view");
    (scene, camera)
}

const RENDERED: [Attribute; 4] =
    [Attribute::Position, Attribute::Normal, Attribute::WorldNormal, Attribute::Depth];

/// The camera that sees what `camera` sees, turned or mirrored.
fn turned(camera: &Camera, symmetry: Symmetry, height: usize, width: usize) -> Camera {
    let [[a, b], [c, d]] = symmetry.matrix().map(|row| row.map(|entry| entry as f32));
    let matrix = Mat3::from_cols(Vec3::new(a, c, 0.0), Vec3::new(b, d, 0.0), Vec3::Z);
    let new_height = if symmetry.swaps_axes() { width } else { height };
    let vertical_fov = 2.0 * (0.5 * new_height as f32 / camera.focal_length(height)).atan();
    Camera {
        position: camera.position,
        rotation: camera.rotation * matrix.transpose(),
        vertical_fov,
        lens: None,
    }
}

/// Share of pixels in which two g-buffers differ: rays that graze an edge may fall on either side of it.
fn share_of_different_pixels(a: &GBuffer, b: &GBuffer) -> f32 {
    assert!(a.planes().same_shape(b.planes()));
    let differs = |pixel: &usize| {
        (0..a.planes().channels())
            .any(|c| (a.planes().plane(c)[*pixel] - b.planes().plane(c)[*pixel]).abs() > 2e-3)
    };
    (0..a.planes().pixels()).filter(differs).count() as f32 / a.planes().pixels() as f32
}

#[test]
fn augmenting_is_rendering_with_a_turned_camera() {
    let (scene, camera) = scene_and_camera();
    let (height, width) = (40, 56);
    let straight = gbuffer::render(&scene, &camera, height, width, &RENDERED);
    for symmetry in Symmetry::ALL {
        let augmented = symmetry.apply(&straight);
        let camera = turned(&camera, symmetry, height, width);
        let rendered = gbuffer::render(&scene, &camera, augmented.height(), augmented.width(), &RENDERED);
        let different = share_of_different_pixels(&augmented, &rendered);
        assert!(different < 0.005, "{symmetry:?}: {different} of the pixels differ");
        if symmetry != Symmetry::IDENTITY {
            // Pixels moved, vectors left as they were: must be told apart.
            let planes = symmetry.move_pixels(straight.planes());
            let moved = GBuffer::new(RENDERED.to_vec(), planes);
            let different = share_of_different_pixels(&moved, &rendered);
            assert!(different > 0.5, "{symmetry:?}: only {different} of the pixels tell");
        }
    }
}

#[test]
fn light_that_is_fixed_to_the_camera_is_not_turned_with_the_image() {
    assert_eq!(Symmetry::of(Effect::Real), [Symmetry::IDENTITY]);
    let others = Effect::ALL.into_iter().filter(|effect| *effect != Effect::Real);
    assert!(others.into_iter().all(|effect| Symmetry::of(effect) == Symmetry::ALL));
}

#[test]
fn the_variance_moves_with_the_target() {
    let target = Planes::from_fn(1, 2, 3, |_, y, x| (3 * y + x) as f32);
    let gbuffer = GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 2, 3, 1.0));
    let pair = Pair { gbuffer, variance: Some(target.map(|value| 0.1 * value)), target, radius: 1.0 };
    for symmetry in Symmetry::ALL {
        let turned = augment(&pair, symmetry);
        assert_eq!(turned.variance, Some(turned.target.map(|value| 0.1 * value)), "{symmetry:?}");
    }
}
